/* test_server_accounts.c: several tokens, and what each of them may have at once. */
#include "server_fixture.h"
#include "accounts_file.h"
#include "check.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { ERROR_TEXT = 512 };

/* ---- the file ---------------------------------------------------------------------------------------------------- */

static bool parse(const char *text, account_list *out, char error[ERROR_TEXT])
{
    char copy[8192];
    snprintf(copy, sizeof copy, "%s", text);
    error[0] = '\0';
    return accounts_file_parse(copy, "accounts", out, error, ERROR_TEXT);
}

TEST(server_accounts_are_read_with_their_bounds)
{
    account_list list;
    char error[ERROR_TEXT];
    CHECK(parse("# who comes in\n"
                "\n"
                "studio 00112233445566778899aabbccddeeff connections=8 forests=20 points=2000000 # by day\n"
                "\twall\tffeeddccbbaa99887766554433221100  views-only messages-per-s=200\r\n"
                "x_1.y-2 0123456789abcdef0123456789ABCDEF hair-mb=500 upload-mb=64",
                &list, error));
    CHECK_TEXT(error, "");
    CHECK_INT(list.count, 3);
    const account_def *a = list.items;
    CHECK_TEXT(a[0].name, "studio");
    CHECK_INT(a[0].token[1], 0x11);
    CHECK_U64(a[0].caps.connections, 8);
    CHECK_U64(a[0].caps.forests, 20);
    CHECK_U64(a[0].caps.points, 2000000);
    CHECK_U64(a[0].caps.hair_bytes, UINT64_MAX);
    CHECK(!a[0].caps.views_only);
    CHECK_TEXT(a[1].name, "wall");
    CHECK(a[1].caps.views_only);
    CHECK_U64(a[1].caps.messages_per_s, 200);
    CHECK_U64(a[2].caps.hair_bytes, 500000000);
    CHECK_U64(a[2].caps.upload_bytes, 64000000);
}

#define TOKEN "00112233445566778899aabbccddeeff"

TEST(server_accounts_that_cannot_be_are_refused_with_their_line)
{
    static const struct {
        const char *text, *why;
    } bad[] = {
        {"studio", "accounts:1: behind the name comes a token"},
        {"studio 0011", "accounts:1: behind the name comes a token"},
        {"\n\nowner " TOKEN, "accounts:3: a name has"},
        {"st/dio " TOKEN, "accounts:1: a name has"},
        {"a23456789012345678901234567890123 " TOKEN, "accounts:1: a name has"},
        {"a " TOKEN "\na 10112233445566778899aabbccddeeff", "accounts:2: there is an account a already"},
        {"a " TOKEN "\nb " TOKEN, "accounts:2: the account a has this token already"},
        {"a " TOKEN " forests=0", "accounts:1: forests takes a whole number"},
        {"a " TOKEN " forests=", "accounts:1: forests takes a whole number"},
        {"a " TOKEN " forests=1x", "accounts:1: forests takes a whole number"},
        {"a " TOKEN " forests=-1", "accounts:1: forests takes a whole number"},
        {"a " TOKEN " forests=99999999999999999999999", "accounts:1: forests takes a whole number"},
        {"a " TOKEN " forest=1", "accounts:1: \"forest=1\" is no bound"},
        {"a " TOKEN " forests", "accounts:1: \"forests\" is no bound"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        account_list list;
        char error[ERROR_TEXT];
        CHECK(!parse(bad[i].text, &list, error));
        error[strlen(bad[i].why)] = '\0';
        CHECK_TEXT(error, bad[i].why);
    }
}

TEST(server_accounts_are_bounded_in_number)
{
    char text[8192], error[ERROR_TEXT];
    size_t used = 0;
    account_list list;
    for (int i = 0; i < LIMIT_ACCOUNTS; i++) {
        used += (size_t)snprintf(text + used, sizeof text - used, "a%d %032x\n", i, i + 1);
    }
    CHECK(parse(text, &list, error));
    snprintf(text + used, sizeof text - used, "one-more " TOKEN "\n");
    CHECK(!parse(text, &list, error));
    CHECK(strstr(error, "at most") != NULL);
}

/* ---- who comes in ------------------------------------------------------------------------------------------------ */

/* Two of them: "one" and "two", without bounds. */
static account_list two_accounts(void)
{
    account_list list = {.count = 2};
    list.items[0] = (account_def){.name = "one", .token = {0x11}, .caps = account_caps_none()};
    list.items[1] = (account_def){.name = "two", .token = {0x22}, .caps = account_caps_none()};
    return list;
}

static fake_client *open_with(service *shared, const uint8_t *token)
{
    fake_client *client = fake_client_with_token(shared, token);
    fake_expect(client, PROTO_AUTH_REPLY);
    CHECK_INT(client->talk.state, SESSION_OPEN);
    return client;
}

TEST(server_knows_an_account_by_its_token_and_proves_that_it_does)
{
    const account_list list = two_accounts();
    service shared;
    CHECK(fake_service_init_with(&shared, 4, &list));
    static const char *const names[] = {"owner", "one", "two"};
    const uint8_t *const tokens[] = {fake_token, list.items[0].token, list.items[1].token};
    for (int i = 0; i < 3; i++) {
        fake_client *client = fake_client_with_token(&shared, tokens[i]);
        const proto_message *reply = fake_expect(client, PROTO_AUTH_REPLY);
        uint8_t nonce[AUTH_NONCE_SIZE], expected[AUTH_HASH_SIZE];
        memset(nonce, 0x5a, sizeof nonce);
        auth_server_proof(tokens[i], client->talk.nonce, nonce, expected);
        CHECK_BYTES(reply->as.auth_reply.proof, expected, sizeof expected);
        CHECK_TEXT(client->talk.who->is.name, names[i]);
        CHECK_INT(client->talk.who->connections, 1);
        fake_client_destroy(client);
        CHECK_INT(accounts_find(&shared.accounts, names[i])->connections, 0);
    }
    service_fini(&shared);
}

TEST(server_account_has_so_many_connections_and_others_are_not_kept_out_by_it)
{
    account_list list = two_accounts();
    list.items[0].caps.connections = 2;
    service shared;
    CHECK(fake_service_init_with(&shared, 4, &list));
    fake_client *first = open_with(&shared, list.items[0].token), *second = open_with(&shared, list.items[0].token);
    fake_client *third = fake_client_with_token(&shared, list.items[0].token);
    fake_expect_error(third, PROTO_ERROR_LIMIT);
    CHECK_INT(third->talk.state, SESSION_CLOSING);
    fake_client *other = open_with(&shared, list.items[1].token);
    fake_client_destroy(first);
    first = open_with(&shared, list.items[0].token);
    fake_client *const all[] = {first, second, third, other};
    for (int i = 0; i < 4; i++) {
        fake_client_destroy(all[i]);
    }
    service_fini(&shared);
}

/* ---- what they have ---------------------------------------------------------------------------------------------- */

static void refuse_create(service *shared, fake_client *client, proto_message create, const char *why)
{
    fake_send(client, &create);
    fake_work(shared, client);
    const proto_message *refused = fake_expect(client, PROTO_ERROR);
    CHECK_INT(refused->as.error.code, PROTO_ERROR_LIMIT);
    CHECK(refused->as.error.text.text && strstr(refused->as.error.text.text, why) != NULL);
    CHECK_INT(client->talk.pending, 0);
}

static void destroy(fake_client *client, uint64_t forest)
{
    proto_message message = {.type = PROTO_DESTROY, .request = 9};
    message.as.destroy.forest = forest;
    fake_send(client, &message);
    fake_expect(client, PROTO_DESTROY_REPLY);
}

TEST(server_account_has_so_many_forests_whoever_of_it_made_them)
{
    account_list list = two_accounts();
    list.items[0].caps.forests = 2;
    service shared;
    CHECK(fake_service_init_with(&shared, 8, &list));
    fake_client *client = open_with(&shared, list.items[0].token), *also = open_with(&shared, list.items[0].token);
    fake_client *other = open_with(&shared, list.items[1].token);
    const uint64_t first = fake_make_forest(&shared, client, 1).forest;
    fake_make_forest(&shared, also, 2);
    fake_client_destroy(also); /* its forest lives on */
    refuse_create(&shared, client, fake_create(3), "2 forests");
    fake_make_forest(&shared, other, 3);
    destroy(client, first);
    fake_make_forest(&shared, client, 4);
    refuse_create(&shared, client, fake_create(5), "2 forests");
    fake_client_destroy(other);
    fake_client_destroy(client);
    service_fini(&shared);
}

TEST(server_account_has_grooms_of_so_many_points_even_where_others_have_larger_ones)
{
    account_list list = two_accounts();
    list.items[0].caps.points = 1500;
    service shared;
    CHECK(fake_service_init_with(&shared, 8, &list));
    fake_client *client = open_with(&shared, list.items[0].token), *other = open_with(&shared, list.items[1].token);
    refuse_create(&shared, client, fake_create(1), "1500 points"); /* 200 strands of 8 points: built for nobody */
    CHECK_INT(shared.forests.alive, 0);
    fake_make_forest(&shared, other, 1);
    refuse_create(&shared, client, fake_create(1), "1500 points"); /* now it lies in the cache */
    proto_message smaller = fake_create(1);
    smaller.as.create.points_per_strand = 7;
    fake_send(client, &smaller);
    fake_work(&shared, client);
    fake_expect(client, PROTO_CREATE_REPLY);
    fake_client_destroy(other);
    fake_client_destroy(client);
    CHECK_INT(accounts_find(&shared.accounts, "one")->forests, 1);
    service_fini(&shared);
}

TEST(server_account_makes_no_further_forest_once_its_memory_is_full)
{
    account_list list = two_accounts();
    list.items[0].caps.hair_bytes = 1;
    service shared;
    CHECK(fake_service_init_with(&shared, 8, &list));
    fake_client *client = open_with(&shared, list.items[0].token), *other = open_with(&shared, list.items[1].token);
    const uint64_t first = fake_make_forest(&shared, client, 1).forest;
    CHECK(client->talk.who->hair_bytes > 0);
    refuse_create(&shared, client, fake_create(2), "MB set aside");
    fake_make_forest(&shared, other, 2);
    destroy(client, first);
    CHECK_U64(client->talk.who->hair_bytes, 0);
    fake_make_forest(&shared, client, 3);
    fake_client_destroy(other);
    fake_client_destroy(client);
    service_fini(&shared);
}

static proto_message upload_piece(uint32_t number, uint32_t size)
{
    static const unsigned char bytes[200000];
    proto_message message = {.type = PROTO_UPLOAD, .request = 42};
    message.as.upload.upload = number;
    message.as.upload.total = size;
    message.as.upload.piece = (proto_blob){bytes, size};
    return message;
}

TEST(server_account_uploads_come_out_of_its_own_memory_and_that_of_all)
{
    account_list list = two_accounts();
    list.items[0].caps.upload_bytes = 250000;
    service shared;
    CHECK(fake_service_init_with(&shared, 8, &list));
    fake_client *client = open_with(&shared, list.items[0].token), *other = open_with(&shared, list.items[1].token);
    const proto_message first = upload_piece(1, 200000), second = upload_piece(2, 100000);
    fake_send(client, &first);
    fake_expect(client, PROTO_UPLOAD_REPLY);
    fake_send(client, &second);
    fake_expect_error(client, PROTO_ERROR_BUSY);
    fake_send(other, &second);
    fake_expect(other, PROTO_UPLOAD_REPLY);
    CHECK_U64(shared.uploads.used, 300000);
    fake_client_destroy(client);
    CHECK_U64(shared.uploads.used, 100000);
    CHECK_U64(accounts_find(&shared.accounts, "one")->uploads.used, 0);
    fake_client_destroy(other);
    CHECK_U64(shared.uploads.used, 0);
    service_fini(&shared);
}

TEST(server_account_that_only_views_makes_and_moves_nothing)
{
    account_list list = two_accounts();
    list.items[0].caps.views_only = true;
    service shared;
    CHECK(fake_service_init_with(&shared, 8, &list));
    fake_client *viewer = open_with(&shared, list.items[0].token), *maker = open_with(&shared, list.items[1].token);
    const struct proto_create_reply made = fake_make_forest(&shared, maker, 1);
    const proto_message create = fake_create(2), piece = upload_piece(1, 10);
    proto_message restore = {.type = PROTO_RESTORE, .request = 43};
    const proto_message *const refused[] = {&create, &piece, &restore};
    for (int i = 0; i < 3; i++) {
        fake_send(viewer, refused[i]);
        fake_expect_error(viewer, PROTO_ERROR_NOT_ALLOWED);
    }
    proto_message attach = {.type = PROTO_ATTACH, .request = 44};
    attach.as.attach.forest = made.forest;
    memcpy(attach.as.attach.token, made.drive_token, sizeof made.drive_token);
    fake_send(viewer, &attach);
    CHECK_INT(fake_expect(viewer, PROTO_ATTACH_REPLY)->as.attach_reply.may_drive, 0);
    const proto_message motion = fake_motion(made.forest, 1, 10000);
    fake_send(viewer, &motion);
    fake_expect_error(viewer, PROTO_ERROR_NOT_ALLOWED);
    proto_message look = fake_query(made.forest, 0);
    look.as.query.latest = 1;
    fake_send(viewer, &look);
    fake_work(&shared, viewer);
    fake_expect(viewer, PROTO_FRAME);
    fake_client_destroy(maker);
    fake_client_destroy(viewer);
    service_fini(&shared);
}

TEST(server_account_is_read_as_fast_as_its_rate_says_over_all_its_connections)
{
    account_list list = two_accounts();
    list.items[0].caps.messages_per_s = 10;
    service shared;
    CHECK(fake_service_init_with(&shared, 8, &list));
    fake_client *client = open_with(&shared, list.items[0].token), *also = open_with(&shared, list.items[0].token);
    fake_client *other = open_with(&shared, list.items[1].token);
    const proto_message ping = {.type = PROTO_PING, .request = 3};
    int taken = 0;
    while (taken < 100 && session_free_us(&client->talk) <= fake_now_us) {
        fake_send(taken % 2 ? client : also, &ping);
        taken++;
    }
    CHECK_INT(taken, 11); /* a second's at once; the last one may overdraw */
    CHECK(session_free_us(&also->talk) > fake_now_us);
    CHECK(session_free_us(&other->talk) <= fake_now_us);
    fake_now_us += 1000000;
    taken = 0;
    while (taken < 100 && session_free_us(&client->talk) <= fake_now_us) {
        fake_send(client, &ping);
        taken++;
    }
    CHECK_INT(taken, 10);
    fake_client_destroy(other);
    fake_client_destroy(also);
    fake_client_destroy(client);
    service_fini(&shared);
}

/* ---- accounts that come and go ----------------------------------------------------------------------------------- */

TEST(server_account_struck_off_is_sent_away_and_its_forests_live_on)
{
    account_list list = two_accounts();
    service shared;
    CHECK(fake_service_init_with(&shared, 8, &list));
    fake_client *gone = open_with(&shared, list.items[0].token), *stays = open_with(&shared, list.items[1].token);
    fake_make_forest(&shared, gone, 1);
    account_list fewer = {.count = 1, .items = {list.items[1]}};
    fewer.items[0].caps.forests = 1;
    CHECK(accounts_set(&shared.accounts, &fewer));
    sessions_end_closed(&shared);
    fake_expect(gone, PROTO_BYE);
    CHECK_INT(gone->talk.state, SESSION_CLOSING);
    CHECK_INT(stays->talk.state, SESSION_OPEN);
    CHECK_U64(stays->talk.who->is.caps.forests, 1);
    fake_client_destroy(gone);
    gone = fake_client_with_token(&shared, list.items[0].token);
    fake_expect_error(gone, PROTO_ERROR_WRONG_TOKEN);
    CHECK_INT(registry_ready_count(&shared.forests), 1);
    CHECK(accounts_set(&shared.accounts, &list)); /* given back: what it had is still its own */
    CHECK_INT(accounts_find(&shared.accounts, "one")->forests, 1);
    fake_client_destroy(gone);
    fake_client_destroy(stays);
    service_fini(&shared);
}

TEST(server_accounts_keep_their_places_while_they_hold_something)
{
    account_list full = {.count = LIMIT_ACCOUNTS}, others = {.count = LIMIT_ACCOUNTS};
    for (int i = 0; i < LIMIT_ACCOUNTS; i++) {
        full.items[i].caps = others.items[i].caps = account_caps_none();
        snprintf(full.items[i].name, ACCOUNT_NAME, "a%d", i);
        snprintf(others.items[i].name, ACCOUNT_NAME, "b%d", i);
        full.items[i].token[0] = (uint8_t)(i + 1);
        others.items[i].token[0] = (uint8_t)(i + 101);
    }
    service shared;
    CHECK(fake_service_init_with(&shared, 8, &full));
    fake_client *holder = open_with(&shared, full.items[7].token);
    CHECK(!accounts_set(&shared.accounts, &others));
    CHECK(accounts_find(&shared.accounts, "b0") == NULL);
    CHECK(holder->talk.who->open); /* nothing has changed */
    fake_client_destroy(holder);
    CHECK(accounts_set(&shared.accounts, &others));
    CHECK_TEXT(accounts_find(&shared.accounts, "b63")->is.name, "b63");
    CHECK(accounts_find(&shared.accounts, "a7") == NULL);
    service_fini(&shared);
}
