/* auth.h: the door: tokens, SHA-256 (FIPS 180-4), HMAC-SHA-256 (RFC 2104) and the two proofs of AUTH. */
#ifndef PROTO_AUTH_H
#define PROTO_AUTH_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { AUTH_TOKEN_SIZE = 16, AUTH_NONCE_SIZE = 32, AUTH_HASH_SIZE = 32, AUTH_TOKEN_TEXT = 33 };

typedef struct auth_sha256 {
    uint32_t state[8];
    uint64_t length;
    uint8_t block[64];
} auth_sha256;

void auth_sha256_init(auth_sha256 *hash);
void auth_sha256_add(auth_sha256 *hash, const void *bytes, size_t size);
void auth_sha256_done(auth_sha256 *hash, uint8_t out[AUTH_HASH_SIZE]);

void auth_hmac(const void *key, size_t key_size, const void *bytes, size_t size, uint8_t out[AUTH_HASH_SIZE]);

/* The proofs that AUTH and AUTH_REPLY carry (messages.def). */
void auth_client_proof(const uint8_t token[AUTH_TOKEN_SIZE], const uint8_t server_nonce[AUTH_NONCE_SIZE],
                       const uint8_t client_nonce[AUTH_NONCE_SIZE], uint8_t out[AUTH_HASH_SIZE]);
void auth_server_proof(const uint8_t token[AUTH_TOKEN_SIZE], const uint8_t server_nonce[AUTH_NONCE_SIZE],
                       const uint8_t client_nonce[AUTH_NONCE_SIZE], uint8_t out[AUTH_HASH_SIZE]);

/* In time that does not depend on where they differ. */
bool auth_equal(const void *a, const void *b, size_t size);

/* A token as 32 hexadecimal digits and back (surrounding white space allowed). */
void auth_token_format(const uint8_t token[AUTH_TOKEN_SIZE], char out[AUTH_TOKEN_TEXT]);
bool auth_token_parse(const char *text, uint8_t out[AUTH_TOKEN_SIZE]);

/* Where daemon and local clients look for the token file when nothing is said: $AWTD_STATE_DIR, else
 * $XDG_STATE_HOME/awtd, else $HOME/.local/state/awtd, with "/token" behind. False: none of them is set, or the path is
 * too long. */
bool auth_state_directory(char *path, size_t size);
bool auth_token_path(const char *state_directory, char *path, size_t size);

#ifdef __cplusplus
}
#endif

#endif
