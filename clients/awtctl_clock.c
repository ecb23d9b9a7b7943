/* awtctl_clock.c: how a forest's time goes: in lock-step with its driver, by the daemon's clock, or not at all. */
#include "awtctl.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { CLOCK_TIMEOUT_MS = 10000, TOKEN_SIZE = 16, OPERANDS = 2 };

static const char *const MODES[] = {"lock", "free", "pause"}; /* by their numbers in SET_CLOCK */

typedef struct clock_request {
    uint64_t forest;
    uint8_t token[TOKEN_SIZE];
    uint8_t mode;
    double rate, importance;
} clock_request;

static bool read_token(const char *text, uint8_t token[TOKEN_SIZE])
{
    unsigned byte;
    if (!text || strlen(text) != 2 * TOKEN_SIZE || strspn(text, "0123456789abcdefABCDEF") != 2 * TOKEN_SIZE) {
        return false;
    }
    for (int i = 0; i < TOKEN_SIZE && sscanf(text + 2 * i, "%2x", &byte) == 1; i++) {
        token[i] = (uint8_t)byte;
    }
    return true;
}

static bool read_mode(const char *text, uint8_t *mode)
{
    for (uint8_t i = 0; i < sizeof MODES / sizeof MODES[0]; i++) {
        if (strcmp(text, MODES[i]) == 0) {
            *mode = i;
            return true;
        }
    }
    return false;
}

static bool read_forest(const char *text, uint64_t *forest)
{
    char *end;
    *forest = strtoull(text, &end, 0);
    return end != text && *end == '\0' && *forest != 0;
}

static bool set(awtclient *client, const clock_request *asked, proto_message *answer, awtclient_error *error)
{
    proto_message request = {.type = PROTO_ATTACH};
    request.as.attach.forest = asked->forest;
    memcpy(request.as.attach.token, asked->token, TOKEN_SIZE);
    if (!awtclient_call(client, &request, answer, error)) {
        return false;
    }
    request = (proto_message){.type = PROTO_SET_CLOCK};
    request.as.set_clock = (struct proto_set_clock){.forest = asked->forest,
                                                    .mode = asked->mode,
                                                    .rate = (float)asked->rate,
                                                    .importance = (float)asked->importance};
    return awtclient_call(client, &request, answer, error);
}

awtctl_exit awtctl_clock(int argc, char *const *argv)
{
    awtctl_connection connection = {.address = AWTCTL_ADDRESS};
    clock_request asked = {.rate = 1};
    const char *drive_token = NULL, *operands[OPERANDS];
    const option options[] = {
        AWTCTL_CONNECTION_OPTIONS(connection),
        {"drive-token", OPTION_TEXT, "HEX", &drive_token, 0, 0, "the forest's, from its CREATE_REPLY: 32 digits"},
        {"rate", OPTION_REAL, "R", &asked.rate, 0.01, 10, "free: simulated seconds per second"},
        {"importance", OPTION_REAL, "W", &asked.importance, 0, 1000, "when there is too much to do; 0: as it is"},
    };
    const option_program program = {"awtctl clock",
                                    "Lets a forest run by the daemon's clock, pauses it, or gives it to its driver.",
                                    "FOREST free|lock|pause", options, sizeof options / sizeof options[0]};
    size_t count;
    awtctl_exit code;
    if (!awtctl_options(&program, argc, argv, operands, OPERANDS, &count, &code)) {
        return code;
    }
    if (count != OPERANDS || !read_forest(operands[0], &asked.forest) || !read_mode(operands[1], &asked.mode)) {
        return awtctl_wrong_usage(&program, "give the forest's handle, and free, lock or pause");
    }
    if (!read_token(drive_token, asked.token)) {
        return awtctl_wrong_usage(&program, "give the forest's drive token: --drive-token, 32 hexadecimal digits");
    }
    awtclient *client = awtctl_connect(&connection, CLOCK_TIMEOUT_MS);
    awtclient_error error;
    proto_message answer;
    if (!client) {
        return AWTCTL_FAILED;
    }
    if (set(client, &asked, &answer, &error)) {
        printf("forest %" PRIu64 ": %s, at %.6f s\n", asked.forest, MODES[asked.mode],
               (double)answer.as.set_clock_reply.time_us * 1e-6);
    } else {
        code = awtctl_failed("%s", error.text);
    }
    awtclient_close(client);
    return code;
}
