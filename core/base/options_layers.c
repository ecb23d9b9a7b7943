/* options_layers.c: see options_layers.h. */
#include "base/options_layers.h"
#include "base/assert.h"

#include <ctype.h>
#include <string.h>

enum { LAYERS_OPTIONS = 64, LAYERS_REASON = 512 };

static char *trim(char *text)
{
    while (isspace((unsigned char)*text)) {
        text++;
    }
    size_t length = strlen(text);
    while (length > 0 && isspace((unsigned char)text[length - 1])) {
        length--;
    }
    text[length] = '\0';
    return text;
}

static void cut_comment(char *line)
{
    for (char *c = line; *c; c++) {
        if (*c == '#' && (c == line || isspace((unsigned char)c[-1]))) {
            *c = '\0';
            return;
        }
    }
}

/* One line, without its comment and not empty. */
static bool take_line(const option_program *program, char *line, bool seen[LAYERS_OPTIONS], char *why, size_t size)
{
    char *equals = strchr(line, '=');
    if (!equals) {
        snprintf(why, size, "a line is NAME = VALUE, or begins with #");
        return false;
    }
    *equals = '\0';
    const char *name = trim(line), *value = trim(equals + 1);
    const option *o = options_find(program, name, strlen(name));
    const size_t place = o ? (size_t)(o - program->options) : 0;
    ASSERT(place < LAYERS_OPTIONS);
    if (!o) {
        snprintf(why, size, "there is no setting \"%.64s\"; %s --help lists them", name, program->name);
    } else if (o->kind != OPTION_LIST && seen[place]) {
        snprintf(why, size, "%s is set twice: keep one of the lines", o->name);
    } else if (*value == '\0') {
        snprintf(why, size, "%s has no value: give one, or remove the line", o->name);
    } else {
        seen[place] = true;
        return options_take(o, value, why, size);
    }
    return false;
}

bool options_take_text(const option_program *program, char *text, const char *source, char *error, size_t error_size)
{
    bool seen[LAYERS_OPTIONS] = {false};
    char why[LAYERS_REASON];
    for (unsigned long number = 1; text; number++) {
        char *end = strchr(text, '\n'), *next = end ? end + 1 : NULL;
        if (end) {
            *end = '\0';
        }
        cut_comment(text);
        char *line = trim(text);
        if (*line && !take_line(program, line, seen, why, sizeof why)) {
            snprintf(error, error_size, "%s:%lu: %s", source, number, why);
            return false;
        }
        text = next;
    }
    return true;
}

/* "max-forests" to "AWTD_MAX_FORESTS". False: there is no room. */
static bool variable_name(const char *prefix, const char *name, char *out, size_t size)
{
    int length = snprintf(out, size, "%s_%s", prefix, name);
    for (char *c = out; *c; c++) {
        *c = *c == '-' ? '_' : (char)toupper((unsigned char)*c);
    }
    return length > 0 && (size_t)length < size;
}

bool options_take_environment(const option_program *program, const char *prefix, char *(*get)(const char *name),
                              char *error, size_t error_size)
{
    for (size_t i = 0; i < program->option_count; i++) {
        char variable[64], why[LAYERS_REASON];
        const option *o = &program->options[i];
        const char *value = variable_name(prefix, o->name, variable, sizeof variable) ? get(variable) : NULL;
        if (value && *value && !options_take(o, value, why, sizeof why)) {
            snprintf(error, error_size, "$%s: %s", variable, why);
            return false;
        }
    }
    return true;
}

static void print_option(const option *o, FILE *file)
{
    switch (o->kind) {
    case OPTION_FLAG:
        fprintf(file, "%s = %s\n", o->name, *(const bool *)o->value ? "yes" : "no");
        return;
    case OPTION_INTEGER:
        fprintf(file, "%s = %lld\n", o->name, *(const long long *)o->value);
        return;
    case OPTION_REAL:
        fprintf(file, "%s = %.17g\n", o->name, *(const double *)o->value);
        return;
    case OPTION_TEXT:
    case OPTION_OPTIONAL_TEXT: {
        const char *text = *(const char *const *)o->value;
        fprintf(file, text ? "%s = %s\n" : "# %s = %s\n", o->name, text ? text : o->argument);
        return;
    }
    case OPTION_LIST: {
        const option_list *list = o->value;
        for (size_t i = 0; i < list->count; i++) {
            fprintf(file, "%s = %s\n", o->name, list->items[i]);
        }
        return;
    }
    }
}

void options_print(const option_program *program, FILE *file)
{
    for (size_t i = 0; i < program->option_count; i++) {
        print_option(&program->options[i], file);
    }
}
