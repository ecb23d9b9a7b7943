/* auth.c: the proofs of AUTH, the token's text, and where the token file is looked for. */
#include "auth.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* HMAC over the purpose (without its NUL) and two nonces; another purpose or another order is another proof, so that
 * neither side can hand the other's proof back to it. */
static void proof(const uint8_t token[AUTH_TOKEN_SIZE], const char *purpose, const uint8_t first[AUTH_NONCE_SIZE],
                  const uint8_t second[AUTH_NONCE_SIZE], uint8_t out[AUTH_HASH_SIZE])
{
    uint8_t text[16 + 2 * AUTH_NONCE_SIZE];
    size_t length = strlen(purpose);
    memcpy(text, purpose, length);
    memcpy(text + length, first, AUTH_NONCE_SIZE);
    memcpy(text + length + AUTH_NONCE_SIZE, second, AUTH_NONCE_SIZE);
    auth_hmac(token, AUTH_TOKEN_SIZE, text, length + 2 * (size_t)AUTH_NONCE_SIZE, out);
}

void auth_client_proof(const uint8_t token[AUTH_TOKEN_SIZE], const uint8_t server_nonce[AUTH_NONCE_SIZE],
                       const uint8_t client_nonce[AUTH_NONCE_SIZE], uint8_t out[AUTH_HASH_SIZE])
{
    proof(token, "awtd auth 1", server_nonce, client_nonce, out);
}

void auth_server_proof(const uint8_t token[AUTH_TOKEN_SIZE], const uint8_t server_nonce[AUTH_NONCE_SIZE],
                       const uint8_t client_nonce[AUTH_NONCE_SIZE], uint8_t out[AUTH_HASH_SIZE])
{
    proof(token, "awtd server 1", client_nonce, server_nonce, out);
}

bool auth_equal(const void *a, const void *b, size_t size)
{
    const volatile uint8_t *left = a, *right = b; /* volatile: no early way out for the optimiser either */
    uint8_t difference = 0;
    for (size_t i = 0; i < size; i++) {
        difference |= (uint8_t)(left[i] ^ right[i]);
    }
    return difference == 0;
}

void auth_token_format(const uint8_t token[AUTH_TOKEN_SIZE], char out[AUTH_TOKEN_TEXT])
{
    static const char digits[] = "0123456789abcdef";
    for (size_t i = 0; i < AUTH_TOKEN_SIZE; i++) {
        out[2 * i] = digits[token[i] >> 4];
        out[2 * i + 1] = digits[token[i] & 15];
    }
    out[AUTH_TOKEN_TEXT - 1] = '\0';
}

/* The value of a hexadecimal digit; -1 if it is none (or the end of the text). */
static int digit_value(char c)
{
    static const char digits[] = "0123456789abcdef0123456789ABCDEF";
    const char *found = c ? strchr(digits, c) : NULL;
    return found ? (int)((found - digits) % 16) : -1;
}

bool auth_token_parse(const char *text, uint8_t out[AUTH_TOKEN_SIZE])
{
    static const char space[] = " \t\r\n";
    uint8_t token[AUTH_TOKEN_SIZE];
    text += strspn(text, space);
    for (size_t i = 0; i < AUTH_TOKEN_SIZE; i++) {
        int high = digit_value(text[0]);
        int low = high < 0 ? -1 : digit_value(text[1]);
        if (low < 0) {
            return false;
        }
        token[i] = (uint8_t)(16 * high + low);
        text += 2;
    }
    if (text[strspn(text, space)] != '\0') {
        return false;
    }
    memcpy(out, token, sizeof token);
    return true;
}

static bool join(char *path, size_t size, const char *directory, const char *rest)
{
    int length = snprintf(path, size, "%s%s", directory, rest);
    return length > 0 && (size_t)length < size;
}

bool auth_state_directory(char *path, size_t size)
{
    static const struct {
        const char *variable, *rest;
    } places[] = {{"AWTD_STATE_DIR", ""}, {"XDG_STATE_HOME", "/awtd"}, {"HOME", "/.local/state/awtd"}};
    for (size_t i = 0; i < sizeof places / sizeof places[0]; i++) {
        const char *value = getenv(places[i].variable);
        if (value && value[0] != '\0') {
            return join(path, size, value, places[i].rest);
        }
    }
    return false;
}

bool auth_token_path(const char *state_directory, char *path, size_t size)
{
    char found[4096];
    if (!state_directory && auth_state_directory(found, sizeof found)) {
        state_directory = found;
    }
    return state_directory && join(path, size, state_directory, "/token");
}
