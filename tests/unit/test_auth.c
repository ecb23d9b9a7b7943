/* test_auth.c: the door: hashes against the standards' own vectors, proofs, token texts, where tokens lie. */
#include "auth.h"
#include "check.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *hex(const uint8_t hash[AUTH_HASH_SIZE])
{
    static char text[2 * AUTH_HASH_SIZE + 1];
    for (size_t i = 0; i < AUTH_HASH_SIZE; i++) {
        snprintf(text + 2 * i, 3, "%02x", hash[i]);
    }
    return text;
}

static const char *sha256_hex(const void *bytes, size_t size, size_t piece)
{
    auth_sha256 hash;
    uint8_t out[AUTH_HASH_SIZE];
    auth_sha256_init(&hash);
    for (size_t at = 0; at < size; at += piece) {
        auth_sha256_add(&hash, (const char *)bytes + at, size - at < piece ? size - at : piece);
    }
    auth_sha256_done(&hash, out);
    return hex(out);
}

TEST(auth_sha256_gives_the_published_digests)
{
    static const char two_blocks[] = "abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq";
    CHECK_TEXT(sha256_hex("", 0, 1), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
    CHECK_TEXT(sha256_hex("abc", 3, 3), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
    CHECK_TEXT(sha256_hex(two_blocks, 56, 56), "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
    char *million = malloc(1000000);
    if (million) {
        memset(million, 'a', 1000000);
        CHECK_TEXT(sha256_hex(million, 1000000, 777),
                   "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
    }
    free(million);
}

TEST(auth_sha256_does_not_depend_on_how_the_bytes_are_cut)
{
    char bytes[200], whole[65];
    for (size_t i = 0; i < sizeof bytes; i++) {
        bytes[i] = (char)(7 * i);
    }
    for (size_t size = 0; size <= sizeof bytes; size++) {
        snprintf(whole, sizeof whole, "%s", sha256_hex(bytes, size, sizeof bytes));
        CHECK_TEXT(sha256_hex(bytes, size, 1), whole);
        CHECK_TEXT(sha256_hex(bytes, size, 63), whole);
    }
}

static const char *hmac_hex(const void *key, size_t key_size, const void *bytes, size_t size)
{
    uint8_t out[AUTH_HASH_SIZE];
    auth_hmac(key, key_size, bytes, size, out);
    return hex(out);
}

TEST(auth_hmac_gives_the_digests_of_rfc_4231)
{
    unsigned char key[131], data[50];
    memset(key, 0x0b, 20);
    CHECK_TEXT(hmac_hex(key, 20, "Hi There", 8), "b0344c61d8db38535ca8afceaf0bf12b881dc200c9833da726e9376c2e32cff7");
    CHECK_TEXT(hmac_hex("Jefe", 4, "what do ya want for nothing?", 28),
               "5bdcc146bf60754e6a042426089575c75a003f089d2739839dec58b964ec3843");
    memset(key, 0xaa, 20);
    memset(data, 0xdd, 50);
    CHECK_TEXT(hmac_hex(key, 20, data, 50), "773ea91e36800e46854db8ebd09181a72959098b3ef8c122d9635514ced565fe");
    for (unsigned char i = 0; i < 25; i++) {
        key[i] = (unsigned char)(i + 1);
    }
    memset(data, 0xcd, 50);
    CHECK_TEXT(hmac_hex(key, 25, data, 50), "82558a389a443c0ea4cc819899f2083a85f0faa3e578f8077a2e3ff46729665b");
    memset(key, 0xaa, sizeof key);
    CHECK_TEXT(hmac_hex(key, 131, "Test Using Larger Than Block-Size Key - Hash Key First", 54),
               "60e431591ee0b67f0d8a26aacbf5b77f8e0bc6213728c5140546040f0ee37f54");
    CHECK_TEXT(hmac_hex(key, 131,
                        "This is a test using a larger than block-size key and a larger than block-size data. The key "
                        "needs to be hashed before being used by the HMAC algorithm.",
                        152),
               "9b09ffa71b942fcb27635fbcd5b0e944bfdc63644f0713938a7f51535c3a35e2");
}

TEST(auth_proofs_differ_by_token_nonce_side_and_order)
{
    uint8_t token[AUTH_TOKEN_SIZE] = {1}, other[AUTH_TOKEN_SIZE] = {2};
    uint8_t server[AUTH_NONCE_SIZE] = {3}, client[AUTH_NONCE_SIZE] = {4};
    uint8_t proofs[5][AUTH_HASH_SIZE];
    auth_client_proof(token, server, client, proofs[0]);
    auth_server_proof(token, server, client, proofs[1]);
    auth_client_proof(other, server, client, proofs[2]);
    auth_client_proof(token, client, server, proofs[3]);
    auth_server_proof(token, client, server, proofs[4]);
    for (size_t i = 0; i < 5; i++) {
        for (size_t k = 0; k < i; k++) {
            CHECK(!auth_equal(proofs[i], proofs[k], AUTH_HASH_SIZE));
        }
    }
    uint8_t text[11 + 2 * AUTH_NONCE_SIZE], by_hand[AUTH_HASH_SIZE];
    memcpy(text, "awtd auth 1", 11);
    memcpy(text + 11, server, AUTH_NONCE_SIZE);
    memcpy(text + 11 + AUTH_NONCE_SIZE, client, AUTH_NONCE_SIZE);
    auth_hmac(token, sizeof token, text, sizeof text, by_hand);
    CHECK_BYTES(proofs[0], by_hand, AUTH_HASH_SIZE);
}

TEST(auth_equal_sees_a_difference_in_any_byte)
{
    uint8_t a[32] = {0}, b[32] = {0};
    CHECK(auth_equal(a, b, 32));
    for (size_t i = 0; i < 32; i++) {
        b[i] = 0x40;
        CHECK(!auth_equal(a, b, 32));
        b[i] = 0;
    }
}

TEST(auth_token_text_goes_there_and_back)
{
    uint8_t token[AUTH_TOKEN_SIZE] = {0x00, 0x9f, 0xAB, 0xff}, back[AUTH_TOKEN_SIZE];
    char text[AUTH_TOKEN_TEXT], spaced[64];
    auth_token_format(token, text);
    CHECK_TEXT(text, "009fabff000000000000000000000000");
    snprintf(spaced, sizeof spaced, " \t%s\r\n", text);
    CHECK(auth_token_parse(spaced, back));
    CHECK_BYTES(back, token, sizeof token);
    CHECK(auth_token_parse("009FABFF000000000000000000000000", back));
    CHECK_BYTES(back, token, sizeof token);
}

TEST(auth_token_text_that_is_no_token_is_refused)
{
    static const char *const wrong[] = {"",
                                        "009fabff00000000000000000000000",
                                        "009fabff0000000000000000000000000",
                                        "009fabff 000000000000000000000000",
                                        "009fabfg000000000000000000000000",
                                        "009fabff000000000000000000000000 x"};
    uint8_t token[AUTH_TOKEN_SIZE] = {7}, before[AUTH_TOKEN_SIZE] = {7};
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        CHECK(!auth_token_parse(wrong[i], token));
        CHECK_BYTES(token, before, sizeof token);
    }
}

static void set_places(const char *state, const char *xdg, const char *home)
{
    setenv("AWTD_STATE_DIR", state, 1);
    setenv("XDG_STATE_HOME", xdg, 1);
    setenv("HOME", home, 1);
}

TEST(auth_state_directory_is_the_first_place_that_is_set)
{
    static const char *const names[] = {"AWTD_STATE_DIR", "XDG_STATE_HOME", "HOME"};
    char *saved[3], path[64];
    for (size_t i = 0; i < 3; i++) {
        const char *value = getenv(names[i]);
        saved[i] = value ? strdup(value) : NULL;
    }
    set_places("/a", "/b", "/c");
    CHECK(auth_state_directory(path, sizeof path));
    CHECK_TEXT(path, "/a");
    CHECK(auth_token_path(NULL, path, sizeof path));
    CHECK_TEXT(path, "/a/token");
    CHECK(auth_token_path("/given", path, sizeof path));
    CHECK_TEXT(path, "/given/token");
    set_places("", "/b", "/c");
    CHECK(auth_state_directory(path, sizeof path));
    CHECK_TEXT(path, "/b/awtd");
    set_places("", "", "/c");
    CHECK(auth_state_directory(path, sizeof path));
    CHECK_TEXT(path, "/c/.local/state/awtd");
    CHECK(!auth_state_directory(path, 20));
    CHECK(!auth_token_path("/given", path, 12));
    set_places("", "", "");
    CHECK(!auth_state_directory(path, sizeof path));
    CHECK(!auth_token_path(NULL, path, sizeof path));
    for (size_t i = 0; i < 3; i++) {
        saved[i] ? setenv(names[i], saved[i], 1) : unsetenv(names[i]);
        free(saved[i]);
    }
}
