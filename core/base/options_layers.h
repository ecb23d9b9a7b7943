/* options_layers.h: the other places that a program's options may be set in: its environment and a text of
 * "name = value" lines. Whoever uses both calls, from the weakest to the strongest: options_take_text,
 * options_take_environment, options_parse (the command line); each sets what it names and leaves the rest. */
#ifndef BASE_OPTIONS_LAYERS_H
#define BASE_OPTIONS_LAYERS_H

#include "base/options.h"

/* Lines "name = value" with the options' names; empty lines, and "#" at a line's begin or after a blank begins a
 * comment. Flags take yes or no. No name may come twice, but of lists. `text` is changed, and values point into it.
 * False: `error` says what is wrong, as "SOURCE:LINE: why". */
bool options_take_text(const option_program *program, char *text, const char *source, char *error, size_t error_size);

/* For every option the variable PREFIX_NAME, in capitals, with _ for -, by `get` (getenv, or a test's). An empty one
 * counts as not set. Values point into the environment. False: `error` says what is wrong. */
bool options_take_environment(const option_program *program, const char *prefix, char *(*get)(const char *name),
                              char *error, size_t error_size);

/* Writes the options as they stand, as options_take_text reads them. What has no value is a comment. */
void options_print(const option_program *program, FILE *file);

#endif
