/* accounts_file.c: see accounts_file.h. */
#include "accounts_file.h"
#include "text_file.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define BLANKS " \t\r"
#define NAME_LETTERS "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789._-"
#define VIEWS_ONLY "views-only"

/* Where one is in the file, for errors. */
typedef struct place {
    const char *path;
    unsigned long line;
    char *error;
    size_t error_size;
} place;

#if defined(__GNUC__)
__attribute__((format(printf, 2, 3)))
#endif
static bool
refuse(const place *at, const char *format, ...)
{
    va_list arguments;
    const int used = snprintf(at->error, at->error_size, "%s:%lu: ", at->path, at->line);
    va_start(arguments, format);
    if (used >= 0 && (size_t)used < at->error_size) {
        vsnprintf(at->error + used, at->error_size - (size_t)used, format, arguments);
    }
    va_end(arguments);
    return false;
}

/* Cuts off the next word; NULL: there is none. */
static char *next_word(char **rest)
{
    char *word = *rest + strspn(*rest, BLANKS);
    const size_t length = strcspn(word, BLANKS);
    *rest = word + length + (word[length] != '\0');
    word[length] = '\0';
    return length > 0 ? word : NULL;
}

/* Bounds that are numbers: what a word of that name gives. */
static const struct bound {
    const char *name;
    size_t offset; /* in account_caps */
    uint64_t unit, greatest;
} bounds[] = {
    {"connections", offsetof(account_caps, connections), 1, LIMIT_CONNECTIONS_GREATEST},
    {"forests", offsetof(account_caps, forests), 1, LIMIT_FORESTS_GREATEST},
    {"points", offsetof(account_caps, points), 1, UINT32_MAX},
    {"hair-mb", offsetof(account_caps, hair_bytes), 1000000, UINT32_MAX},
    {"upload-mb", offsetof(account_caps, upload_bytes), 1000000, UINT32_MAX},
    {"messages-per-s", offsetof(account_caps, messages_per_s), 1, 1000000},
};

/* Digits alone, from 1. 0: it is no such number, or greater. */
static uint64_t read_number(const char *digits, uint64_t greatest)
{
    uint64_t value = 0;
    for (; *digits >= '0' && *digits <= '9' && value <= greatest; digits++) {
        value = 10 * value + (uint64_t)(*digits - '0');
    }
    return *digits == '\0' && value <= greatest ? value : 0;
}

static bool take_bound(const place *at, char *word, account_caps *caps)
{
    const size_t length = strcspn(word, "=");
    if (strcmp(word, VIEWS_ONLY) == 0) {
        caps->views_only = true;
        return true;
    }
    for (size_t i = 0; i < sizeof bounds / sizeof bounds[0]; i++) {
        const struct bound *b = &bounds[i];
        if (strlen(b->name) != length || memcmp(b->name, word, length) != 0 || word[length] != '=') {
            continue;
        }
        const uint64_t value = read_number(word + length + 1, b->greatest) * b->unit;
        if (value == 0) {
            return refuse(at, "%s takes a whole number from 1 to %llu, not \"%.40s\"", b->name,
                          (unsigned long long)b->greatest, word + length + 1);
        }
        memcpy((unsigned char *)caps + b->offset, &value, sizeof value);
        return true;
    }
    return refuse(at,
                  "\"%.40s\" is no bound; there are connections=N, forests=N, points=N, hair-mb=N, upload-mb=N, "
                  "messages-per-s=N and " VIEWS_ONLY,
                  word);
}

static bool check_new(const place *at, const account_list *list, const account_def *a)
{
    for (uint32_t i = 0; i < list->count; i++) {
        if (strcmp(list->items[i].name, a->name) == 0) {
            return refuse(at, "there is an account %s already", a->name);
        }
        if (memcmp(list->items[i].token, a->token, sizeof a->token) == 0) {
            return refuse(at, "the account %s has this token already", list->items[i].name);
        }
    }
    return list->count < LIMIT_ACCOUNTS || refuse(at, "there are %d accounts at most", LIMIT_ACCOUNTS);
}

static bool take_line(const place *at, char *line, account_list *out)
{
    account_def a = {.caps = account_caps_none()};
    line[strcspn(line, "#")] = '\0';
    const char *name = next_word(&line);
    if (!name) {
        return true;
    }
    const size_t length = strlen(name);
    if (length >= sizeof a.name || strspn(name, NAME_LETTERS) != length || strcmp(name, "owner") == 0) {
        return refuse(at, "a name has 1 to %d of the letters a-z, A-Z, 0-9, \".\", \"_\", \"-\", and is not \"owner\"",
                      ACCOUNT_NAME - 1);
    }
    memcpy(a.name, name, length + 1);
    const char *token = next_word(&line);
    if (!token || !auth_token_parse(token, a.token)) {
        return refuse(at, "behind the name comes a token of 32 hexadecimal digits; openssl rand -hex 16 makes one");
    }
    for (char *word = next_word(&line); word; word = next_word(&line)) {
        if (!take_bound(at, word, &a.caps)) {
            return false;
        }
    }
    if (!check_new(at, out, &a)) {
        return false;
    }
    out->items[out->count++] = a;
    return true;
}

bool accounts_file_parse(char *text, const char *path, account_list *out, char *error, size_t error_size)
{
    place at = {.path = path, .error = error, .error_size = error_size};
    *out = (account_list){0};
    while (*text) {
        const size_t length = strcspn(text, "\n");
        char *next = text + length + (text[length] == '\n');
        text[length] = '\0';
        at.line++;
        if (!take_line(&at, text, out)) {
            return false;
        }
        text = next;
    }
    return true;
}

bool accounts_file_read(const char *path, account_list *out, char *error, size_t error_size)
{
    static const text_file kind = {.what = "accounts file", .greatest = LIMIT_CONFIG_FILE, .secret = true};
    char *text = text_file_read(&kind, path, error, error_size);
    const bool good = text && accounts_file_parse(text, path, out, error, error_size);
    free(text);
    return good;
}
