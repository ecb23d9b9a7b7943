/* test_server_upload.c: strand files in pieces, and pieces that do not fit. */
#include "server_fixture.h"
#include "check.h"

#include <string.h>

static const char file[] = "not a strand file, but whole";
enum { FILE_SIZE = sizeof file - 1 };

static proto_message piece(uint32_t number, uint64_t offset, uint32_t size)
{
    proto_message message = {.type = PROTO_UPLOAD, .request = 20};
    struct proto_upload *up = &message.as.upload;
    up->upload = number;
    up->total = FILE_SIZE;
    up->offset = offset;
    up->piece = (proto_blob){(const unsigned char *)file + offset, size};
    auth_sha256 hash;
    auth_sha256_init(&hash);
    auth_sha256_add(&hash, file, FILE_SIZE);
    auth_sha256_done(&hash, up->sha256);
    return message;
}

static void send_piece(fake_client *client, proto_message message, uint64_t received)
{
    fake_send(client, &message);
    const proto_message *reply = fake_expect(client, PROTO_UPLOAD_REPLY);
    CHECK_U64(reply->as.upload_reply.received, received);
    CHECK_INT(reply->as.upload_reply.upload, message.as.upload.upload);
}

static void send_bad(fake_client *client, proto_message message, int code)
{
    fake_send(client, &message);
    fake_expect_error(client, code);
}

static proto_message create_from(uint32_t number)
{
    proto_message message = fake_create(1);
    message.as.create.source = RECIPE_FROM_UPLOAD;
    message.as.create.upload = number;
    return message;
}

TEST(server_upload_comes_in_order_and_is_read)
{
    service shared;
    CHECK(fake_service_init(&shared, 0, 4, false));
    fake_client *client = fake_client_open(&shared);
    proto_message create = create_from(3);
    send_bad(client, create, PROTO_ERROR_NO_UPLOAD);
    send_piece(client, piece(3, 0, 10), 10);
    send_bad(client, create, PROTO_ERROR_NO_UPLOAD); /* begun, but not complete */
    send_piece(client, piece(3, 10, 0), 10);
    send_piece(client, piece(3, 10, FILE_SIZE - 10), FILE_SIZE);
    for (int i = 0; i < 2; i++) { /* it may be used again */
        fake_send(client, &create);
        CHECK_INT(client->talk.pending, 1);
        fake_work(&shared, client);
        CHECK_INT(client->talk.pending, 0);
        fake_expect_error(client, PROTO_ERROR_BAD_STRANDS);
    }
    CHECK_INT(shared.forests.alive, 0);
    fake_client_destroy(client);
    CHECK_U64(shared.uploads.used, 0);
    service_fini(&shared);
}

TEST(server_upload_refuses_pieces_that_do_not_fit)
{
    service shared;
    CHECK(fake_service_init(&shared, 0, 4, false));
    fake_client *client = fake_client_open(&shared);
    send_bad(client, piece(1, 5, 5), PROTO_ERROR_BAD_UPLOAD); /* not begun */
    send_piece(client, piece(1, 0, 5), 5);
    send_bad(client, piece(1, 6, 5), PROTO_ERROR_BAD_UPLOAD); /* a gap */
    send_bad(client, piece(1, 5, 5), PROTO_ERROR_BAD_UPLOAD); /* and then it is gone */

    proto_message longer = piece(1, 0, FILE_SIZE);
    longer.as.upload.total = FILE_SIZE - 1;
    send_bad(client, longer, PROTO_ERROR_BAD_UPLOAD);

    send_piece(client, piece(1, 0, 5), 5);
    proto_message other = piece(1, 5, 5);
    other.as.upload.total++;
    send_bad(client, other, PROTO_ERROR_BAD_UPLOAD);

    proto_message forged = piece(1, 0, FILE_SIZE);
    forged.as.upload.sha256[31] ^= 1;
    send_piece(client, forged, FILE_SIZE);
    proto_message create = create_from(1);
    fake_send(client, &create);
    fake_work(&shared, client);
    const proto_message *refused = fake_expect(client, PROTO_ERROR);
    CHECK_INT(refused->as.error.code, PROTO_ERROR_BAD_STRANDS);
    CHECK(strstr(refused->as.error.text.text, "SHA-256") != NULL);
    CHECK_INT(client->talk.state, SESSION_OPEN);
    CHECK_U64(shared.uploads.used, FILE_SIZE);
    fake_client_destroy(client);
    service_fini(&shared);
}

TEST(server_upload_has_limits)
{
    service shared;
    CHECK(fake_service_init(&shared, 0, 4, false));
    fake_client *client = fake_client_open(&shared);
    proto_message huge = piece(0, 0, 1);
    huge.as.upload.total = LIMIT_UPLOAD_BYTES + 1;
    send_bad(client, huge, PROTO_ERROR_LIMIT);
    huge.as.upload.total = UINT64_MAX;
    send_bad(client, huge, PROTO_ERROR_LIMIT);

    huge.as.upload.total = LIMIT_UPLOAD_BYTES; /* announced is not taken */
    send_piece(client, huge, 1);
    CHECK(shared.uploads.used <= 64 * 1024);

    for (uint32_t i = 1; i < LIMIT_SESSION_UPLOADS; i++) {
        send_piece(client, piece(i, 0, 1), 1);
    }
    send_bad(client, piece(LIMIT_SESSION_UPLOADS, 0, 1), PROTO_ERROR_LIMIT);
    proto_message cancel = piece(1, 0, 0);
    cancel.as.upload.total = 0;
    send_piece(client, cancel, 0);
    send_piece(client, piece(LIMIT_SESSION_UPLOADS, 0, 1), 1);

    shared.uploads.greatest = shared.uploads.used;
    send_piece(client, cancel, 0);
    cancel.as.upload.upload = 2;
    send_piece(client, cancel, 0);
    shared.uploads.greatest = shared.uploads.used;
    send_bad(client, piece(2, 0, 1), PROTO_ERROR_BUSY);
    fake_client_destroy(client);
    CHECK_U64(shared.uploads.used, 0);
    service_fini(&shared);
}
