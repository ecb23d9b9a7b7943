/* options.c: see options.h. */
#include "base/options.h"
#include "base/version.h"

#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

const option *options_find(const option_program *program, const char *name, size_t length)
{
    for (size_t i = 0; i < program->option_count; i++) {
        const option *o = &program->options[i];
        if (strlen(o->name) == length && memcmp(o->name, name, length) == 0) {
            return o;
        }
    }
    return NULL;
}

static bool option_take_number(const option *o, const char *text, char *error, size_t error_size)
{
    char *end = NULL;
    errno = 0;
    double number = 0;
    if (o->kind == OPTION_INTEGER) {
        long long integer = strtoll(text, &end, 10);
        number = (double)integer;
        if (errno == 0 && end != text && *end == '\0' && number >= o->least && number <= o->greatest) {
            *(long long *)o->value = integer;
            return true;
        }
    } else {
        number = strtod(text, &end);
        if (errno == 0 && end != text && *end == '\0' && isfinite(number) && number >= o->least &&
            number <= o->greatest) {
            *(double *)o->value = number;
            return true;
        }
    }
    snprintf(error, error_size, "--%s takes %s from %.15g to %.15g, not \"%s\"", o->name,
             o->kind == OPTION_INTEGER ? "a whole number" : "a number", o->least, o->greatest, text);
    return false;
}

static bool take_flag(const option *o, const char *text, char *error, size_t error_size)
{
    const bool yes = strcmp(text, "yes") == 0;
    if (!yes && strcmp(text, "no") != 0) {
        snprintf(error, error_size, "--%s takes yes or no, not \"%.64s\"", o->name, text);
        return false;
    }
    *(bool *)o->value = yes;
    return true;
}

bool options_take(const option *o, const char *text, char *error, size_t error_size)
{
    switch (o->kind) {
    case OPTION_FLAG:
        return take_flag(o, text, error, error_size);
    case OPTION_TEXT:
    case OPTION_OPTIONAL_TEXT:
        *(const char **)o->value = text;
        return true;
    case OPTION_INTEGER:
    case OPTION_REAL:
        return option_take_number(o, text, error, error_size);
    case OPTION_LIST: {
        option_list *list = o->value;
        if (list->count == OPTION_LIST_MAX) {
            snprintf(error, error_size, "--%s may be given %d times at most", o->name, OPTION_LIST_MAX);
            return false;
        }
        list->items[list->count++] = text;
        return true;
    }
    }
    return false;
}

option_result options_parse(const option_program *program, int count, char *const *arguments, const char **operands,
                            size_t operand_max, size_t *operand_count, char *error, size_t error_size)
{
    *operand_count = 0;
    for (int i = 0; i < count; i++) {
        const char *argument = arguments[i];
        if (strncmp(argument, "--", 2) != 0) {
            if (*operand_count == operand_max) {
                snprintf(error, error_size, "\"%s\" is one argument too many", argument);
                return OPTIONS_WRONG;
            }
            operands[(*operand_count)++] = argument;
            continue;
        }
        const char *name = argument + 2;
        size_t length = strcspn(name, "=");
        const char *inlined = name[length] == '=' ? name + length + 1 : NULL;
        if (strcmp(name, "help") == 0) {
            return OPTIONS_HELP;
        }
        if (strcmp(name, "version") == 0) {
            return OPTIONS_VERSION;
        }
        const option *o = options_find(program, name, length);
        if (!o) {
            snprintf(error, error_size, "there is no option --%.*s; %s --help lists them", (int)length, name,
                     program->name);
            return OPTIONS_WRONG;
        }
        const char *text = inlined;
        bool next_is_value = i + 1 < count && strncmp(arguments[i + 1], "--", 2) != 0;
        if (o->kind == OPTION_FLAG && !inlined) {
            text = "yes";
        } else if (o->kind == OPTION_OPTIONAL_TEXT && !inlined) {
            text = next_is_value ? arguments[++i] : "-";
        } else if (!inlined) {
            if (!next_is_value) {
                snprintf(error, error_size, "--%s wants %s after it", o->name, o->argument);
                return OPTIONS_WRONG;
            }
            text = arguments[++i];
        }
        if (!options_take(o, text, error, error_size)) {
            return OPTIONS_WRONG;
        }
    }
    return OPTIONS_RUN;
}

static void option_help_line(const option *o, FILE *file)
{
    char left[64];
    const char *form = o->kind == OPTION_FLAG ? "--%s%s" : o->kind == OPTION_OPTIONAL_TEXT ? "--%s [%s]" : "--%s %s";
    snprintf(left, sizeof left, form, o->name, o->argument ? o->argument : "");
    fprintf(file, "  %-26s %s", left, o->help);
    if (o->kind == OPTION_INTEGER) {
        fprintf(file, " [%lld]", *(const long long *)o->value);
    } else if (o->kind == OPTION_REAL) {
        fprintf(file, " [%g]", *(const double *)o->value);
    } else if (o->kind == OPTION_TEXT && *(const char *const *)o->value) {
        fprintf(file, " [%s]", *(const char *const *)o->value);
    }
    fputc('\n', file);
}

void options_help(const option_program *program, FILE *file)
{
    fprintf(file, "usage: %s [options]%s%s\n%s\n\n", program->name, program->operands ? " " : "",
            program->operands ? program->operands : "", program->summary);
    for (size_t i = 0; i < program->option_count; i++) {
        option_help_line(&program->options[i], file);
    }
    fprintf(file, "  %-26s %s\n  %-26s %s\n", "--help", "this text", "--version", "the version");
}

bool options_begin(const option_program *program, int count, char *const *arguments, const char **operands,
                   size_t operand_max, size_t *operand_count, int *code)
{
    char error[160];
    *code = 0;
    switch (options_parse(program, count, arguments, operands, operand_max, operand_count, error, sizeof error)) {
    case OPTIONS_RUN:
        return true;
    case OPTIONS_HELP:
        options_help(program, stdout);
        break;
    case OPTIONS_VERSION: /* of the program, not of its subcommand */
        printf("%.*s %s\n", (int)strcspn(program->name, " "), program->name, AWTD_VERSION);
        break;
    case OPTIONS_WRONG:
        fprintf(stderr, "%s: %s\n", program->name, error);
        *code = 2;
        break;
    }
    return false;
}

bool options_split_assignment(const char *text, char *name, size_t name_size, double *value)
{
    size_t length = strcspn(text, "=");
    if (length == 0 || length >= name_size || text[length] != '=' || text[length + 1] == '\0') {
        return false;
    }
    char *end;
    *value = strtod(text + length + 1, &end);
    if (*end != '\0' || !isfinite(*value)) {
        return false;
    }
    memcpy(name, text, length);
    name[length] = '\0';
    return true;
}

bool options_split_address(const char *text, char *host, size_t host_size, char *port, size_t port_size)
{
    const char *colon = strrchr(text, ':');
    if (!colon || colon[1] == '\0') {
        return false;
    }
    const char *begin = text;
    size_t length = (size_t)(colon - text);
    if (length >= 2 && begin[0] == '[' && begin[length - 1] == ']') {
        begin++;
        length -= 2;
    } else if (memchr(text, ':', length)) {
        return false; /* an IPv6 address wants its brackets */
    }
    if (length >= host_size || strlen(colon + 1) >= port_size) {
        return false;
    }
    for (const char *c = colon + 1; *c; c++) {
        if (!isdigit((unsigned char)*c)) {
            return false;
        }
    }
    memcpy(host, begin, length);
    host[length] = '\0';
    memcpy(port, colon + 1, strlen(colon + 1) + 1);
    return true;
}
