/* options.h: the one way in which awtd's programs take their command lines: --name VALUE or --name=VALUE from a
 * table, checked, with a --help that is made from the same table. (getopt_long is not POSIX.) The other places that
 * options may be set in: options_layers.h. */
#ifndef BASE_OPTIONS_H
#define BASE_OPTIONS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

enum { OPTION_LIST_MAX = 64 };

typedef enum option_kind {
    OPTION_FLAG,          /* bool: given or not; --name=no takes it back */
    OPTION_TEXT,          /* const char *: the argument */
    OPTION_OPTIONAL_TEXT, /* const char *: the argument, or "-" where none follows */
    OPTION_INTEGER,       /* long long within [least, greatest] */
    OPTION_REAL,          /* double within [least, greatest] */
    OPTION_LIST           /* option_list: may be given again */
} option_kind;

typedef struct option_list {
    const char *items[OPTION_LIST_MAX];
    size_t count;
} option_list;

typedef struct option {
    const char *name; /* without the dashes */
    option_kind kind;
    const char *argument; /* its name in the help; NULL for flags */
    void *value;          /* of the kind's type; keeps its default where the option is not given */
    double least, greatest;
    const char *help;
} option;

typedef struct option_program {
    const char *name;      /* "awtd", "awtctl play" */
    const char *summary;   /* one line */
    const char *operands;  /* shown in the usage line, e.g. "FILE.glb"; NULL: none are taken */
    const option *options; /* --help and --version are understood without being listed */
    size_t option_count;
} option_program;

typedef enum option_result { OPTIONS_RUN, OPTIONS_HELP, OPTIONS_VERSION, OPTIONS_WRONG } option_result;

/* Reads arguments[0 .. count-1] (without the program's name). Texts point into them. `operands` (room for
 * `operand_max`) receives what is no option. OPTIONS_WRONG: `error` (of `error_size` bytes) says what and why. */
option_result options_parse(const option_program *program, int count, char *const *arguments, const char **operands,
                            size_t operand_max, size_t *operand_count, char *error, size_t error_size);

/* What a program begins with: options_parse; --help and --version print to standard output what was asked, what is
 * wrong goes to standard error. False: the program ends with *code, 0 or 2. */
bool options_begin(const option_program *program, int count, char *const *arguments, const char **operands,
                   size_t operand_max, size_t *operand_count, int *code);

/* The option of that name (of `length` bytes); NULL: there is none. */
const option *options_find(const option_program *program, const char *name, size_t length);
/* Sets it from `text`, which a text's value points to then. False: `error` says why it cannot be that. */
bool options_take(const option *o, const char *text, char *error, size_t error_size);

/* The help text, with defaults as they stand in the values. */
void options_help(const option_program *program, FILE *file);

/* Splits "NAME=NUMBER". False: not of that form, the name longer than `name_size` - 1, or the number not finite. */
bool options_split_assignment(const char *text, char *name, size_t name_size, double *value);

/* Splits "HOST:PORT", "[IPV6]:PORT" or ":PORT" (host empty then). False: not of that form, or too long. */
bool options_split_address(const char *text, char *host, size_t host_size, char *port, size_t port_size);

#endif
