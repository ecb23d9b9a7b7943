/* awtctl_common.c: see awtctl.h. */
#include "awtctl.h"

#include "base/version.h"
#include "files.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void say(const char *format, va_list arguments)
{
    fflush(stdout);
    fputs("awtctl: ", stderr);
    vfprintf(stderr, format, arguments);
    fputc('\n', stderr);
}

awtctl_exit awtctl_failed(const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    say(format, arguments);
    va_end(arguments);
    return AWTCTL_FAILED;
}

awtctl_exit awtctl_wrong_usage(const option_program *program, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    say(format, arguments);
    va_end(arguments);
    fprintf(stderr, "%s --help says how it is used\n", program->name);
    return AWTCTL_WRONG_USAGE;
}

bool awtctl_options(const option_program *program, int argc, char *const *argv, const char **operands,
                    size_t operand_max, size_t *operand_count, awtctl_exit *code)
{
    char error[256];
    *code = AWTCTL_FINE;
    switch (options_parse(program, argc, argv, operands, operand_max, operand_count, error, sizeof error)) {
    case OPTIONS_RUN:
        return true;
    case OPTIONS_HELP:
        options_help(program, stdout);
        break;
    case OPTIONS_VERSION:
        puts("awtctl " AWTD_VERSION);
        break;
    case OPTIONS_WRONG:
        *code = awtctl_wrong_usage(program, "%s", error);
        break;
    }
    return false;
}

awtclient *awtctl_connect(const awtctl_connection *connection, int timeout_ms)
{
    awtclient_error error = {0};
    awtclient_options options = {.address = connection->address,
                                 .token_file = connection->token_file,
                                 .name = "awtctl " AWTD_VERSION,
                                 .timeout_ms = timeout_ms};
    awtclient *client = awtclient_open(&options, &error);
    if (!client) {
        awtctl_failed("%s", error.text);
    }
    return client;
}

static bool write_json_to(FILE *file, void (*fill)(jsonout *json, const void *context), const void *context)
{
    jsonout json = jsonout_begin(file);
    fill(&json, context);
    return jsonout_done(&json) && fflush(file) == 0;
}

bool awtctl_write_json(const char *path, void (*fill)(jsonout *json, const void *context), const void *context)
{
    if (strcmp(path, "-") == 0) {
        return write_json_to(stdout, fill, context) || (awtctl_failed("standard output takes no more"), false);
    }
    char *text = NULL, error[512] = "not enough memory for the JSON text";
    size_t size = 0;
    FILE *memory = open_memstream(&text, &size);
    bool done = memory && write_json_to(memory, fill, context);
    if (memory && fclose(memory) != 0) {
        done = false;
    }
    done = done && files_write(path, text, size, error, sizeof error);
    if (!done) {
        awtctl_failed("%s", error);
    }
    free(text);
    return done;
}
