/* test_server_state.c: a forest's state to clients and to the disk, and back: it goes on as if nothing had happened. */
#include "server_fixture.h"
#include "base/crc32c.h"
#include "check.h"
#include "folder_fixture.h"
#include "log.h"
#include "restore.h"
#include "upkeep.h"

#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { KEEP_US = 1000000, STEP_US = 10000 };

/* ---- a daemon with a state directory ----------------------------------------------------------------------------- */

typedef struct kept_service {
    service shared;
    keeper *keeper;
    vault place;
} kept_service;

static int64_t some_time_us(void)
{
    return 1;
}

/* Begins as the daemon does: what the directory holds is made again. */
static void begin(kept_service *k, const char *state)
{
    char error[256] = "";
    CHECK(vault_open(&k->place, state, error, sizeof error));
    k->keeper = keeper_create(&k->place, some_time_us);
    CHECK(k->keeper && fake_service_init(&k->shared, 0, 8, false));
    k->shared.forests.keeper = k->keeper;
    k->shared.options.keep_us = KEEP_US;
    k->shared.keep_due_us = fake_now_us + KEEP_US;
    CHECK(restore_all(&k->shared, &k->place));
}

static void end(kept_service *k)
{
    service_fini(&k->shared);
    keeper_destroy(k->keeper);
}

/* The next round is due, and done. */
static void keep_round(kept_service *k)
{
    fake_now_us += KEEP_US;
    upkeep_do(&k->shared, fake_now_us);
    fake_work(&k->shared, NULL);
    CHECK(upkeep_kept_all(&k->shared));
    CHECK(keeper_drain(k->keeper));
}

/* ---- clients ----------------------------------------------------------------------------------------------------- */

/* Moves the head and steps, from one time to another; a sum of all the hair that came. */
static uint32_t drive(service *shared, fake_client *client, uint64_t forest, uint32_t from, uint32_t to)
{
    uint32_t sum = 0;
    for (uint32_t n = from; n <= to; n++) {
        proto_message motion = fake_motion(forest, n, (int64_t)n * STEP_US);
        proto_message query = fake_query(forest, (int64_t)n * STEP_US);
        fake_send(client, &motion);
        fake_send(client, &query);
        fake_work(shared, client);
        const proto_blob glb = fake_expect(client, PROTO_FRAME)->as.frame.glb;
        sum = crc32c_more(sum, glb.bytes, glb.length);
    }
    return sum;
}

static void attach(fake_client *client, const struct proto_create_reply *made, const uint8_t *token)
{
    proto_message message = {.type = PROTO_ATTACH, .request = 40};
    message.as.attach.forest = made->forest;
    memcpy(message.as.attach.token, token, sizeof message.as.attach.token);
    fake_send(client, &message);
    fake_expect(client, PROTO_ATTACH_REPLY);
}

static const struct proto_snapshot_reply *snapshot(service *shared, fake_client *client, uint64_t forest)
{
    proto_message message = {.type = PROTO_SNAPSHOT, .request = 41};
    message.as.snapshot.forest = forest;
    fake_send(client, &message);
    fake_work(shared, client);
    return &fake_expect(client, PROTO_SNAPSHOT_REPLY)->as.snapshot_reply;
}

static void upload_bytes(fake_client *client, uint32_t number, proto_blob bytes)
{
    enum { PIECE = 1 << 20 };
    proto_message message = {.type = PROTO_UPLOAD, .request = 42};
    struct proto_upload *up = &message.as.upload;
    auth_sha256 hash;
    auth_sha256_init(&hash);
    auth_sha256_add(&hash, bytes.bytes, bytes.length);
    *up = (struct proto_upload){.upload = number, .total = bytes.length};
    auth_sha256_done(&hash, up->sha256);
    for (; up->offset < up->total; up->offset += up->piece.length) {
        const uint64_t left = up->total - up->offset;
        up->piece = (proto_blob){bytes.bytes + up->offset, (uint32_t)(left < PIECE ? left : PIECE)};
        fake_send(client, &message);
        fake_expect(client, PROTO_UPLOAD_REPLY);
    }
}

/* ---- over the wire ----------------------------------------------------------------------------------------------- */

TEST(server_snapshot_restored_goes_on_to_the_bit)
{
    service shared;
    CHECK(fake_service_init(&shared, 0, 4, false));
    fake_client *client = fake_client_open(&shared);
    const struct proto_create_reply made = fake_make_forest(&shared, client, 5);
    drive(&shared, client, made.forest, 1, 8);
    const struct proto_snapshot_reply *taken = snapshot(&shared, client, made.forest);
    CHECK_INT(taken->time_us, 8 * STEP_US);
    upload_bytes(client, 1, taken->state);
    proto_message restore = {.type = PROTO_RESTORE, .request = 43};
    restore.as.restore = (struct proto_restore){.upload = 1, .name = proto_str_of("again")};
    fake_send(client, &restore);
    fake_work(&shared, client);
    const struct proto_create_reply again = fake_expect(client, PROTO_CREATE_REPLY)->as.create_reply;
    CHECK(again.forest != made.forest);
    CHECK_INT(again.strands, made.strands);
    CHECK_INT(again.colliders.count, made.colliders.count);
    CHECK_NEAR(again.head_radius_m, made.head_radius_m, 1e-9);
    CHECK_U64(snapshot(&shared, client, again.forest)->hash, taken->hash);
    CHECK_U64(drive(&shared, client, again.forest, 9, 20), drive(&shared, client, made.forest, 9, 20));
    fake_client_destroy(client);
    service_fini(&shared);
}

TEST(server_restore_refuses_what_is_no_snapshot)
{
    service shared;
    CHECK(fake_service_init(&shared, 0, 4, false));
    fake_client *client = fake_client_open(&shared);
    proto_message restore = {.type = PROTO_RESTORE, .request = 43};
    restore.as.restore.upload = 1;
    fake_send(client, &restore);
    fake_expect_error(client, PROTO_ERROR_NO_UPLOAD);
    upload_bytes(client, 1, (proto_blob){(const unsigned char *)"no snapshot at all, but whole", 29});
    fake_send(client, &restore);
    fake_work(&shared, client);
    fake_expect_error(client, PROTO_ERROR_BAD_STRANDS);
    CHECK_INT(client->talk.pending, 0);
    CHECK_INT(registry_ready_count(&shared.forests), 0);
    fake_client_destroy(client);
    service_fini(&shared);
}

TEST(server_makes_no_forest_of_whatever_source_where_the_workers_cannot_keep_up)
{
    service shared;
    CHECK(fake_service_init(&shared, 0, 4, false));
    fake_client *client = fake_client_open(&shared);
    const struct proto_create_reply made = fake_make_forest(&shared, client, 5);
    const proto_message create = fake_create(6);
    proto_message restore = {.type = PROTO_RESTORE, .request = 43};
    restore.as.restore.upload = 1;
    upload_bytes(client, 1, snapshot(&shared, client, made.forest)->state);
    shared.load.full = true;
    shared.load_looked_us = fake_now_us; /* until somebody looks again */
    fake_send(client, &create);
    fake_expect_error(client, PROTO_ERROR_BUSY);
    fake_send(client, &restore);
    fake_expect_error(client, PROTO_ERROR_BUSY);
    CHECK_INT(client->talk.pending, 0);
    shared.load.full = false;
    fake_send(client, &restore);
    fake_work(&shared, client);
    fake_expect(client, PROTO_CREATE_REPLY);
    fake_client_destroy(client);
    service_fini(&shared);
}

TEST(server_snapshot_is_for_who_may_drive)
{
    service shared;
    CHECK(fake_service_init(&shared, 0, 4, false));
    fake_client *maker = fake_client_open(&shared), *viewer = fake_client_open(&shared);
    const struct proto_create_reply made = fake_make_forest(&shared, maker, 5);
    attach(viewer, &made, made.view_token);
    proto_message message = {.type = PROTO_SNAPSHOT, .request = 41};
    message.as.snapshot.forest = made.forest;
    fake_send(viewer, &message);
    fake_expect_error(viewer, PROTO_ERROR_NOT_ALLOWED);
    fake_client_destroy(viewer);
    fake_client_destroy(maker);
    service_fini(&shared);
}

/* ---- to the disk and back ---------------------------------------------------------------------------------------- */

TEST(server_started_anew_has_its_forests_and_they_go_on_to_the_bit)
{
    char state[FOLDER_PATH];
    kept_service first = {0}, second = {0};
    folder_make(state);
    begin(&first, state);
    fake_client *client = fake_client_open(&first.shared);
    const struct proto_create_reply made = fake_make_forest(&first.shared, client, 5);
    drive(&first.shared, client, made.forest, 1, 8);
    keep_round(&first);
    const uint64_t hash = snapshot(&first.shared, client, made.forest)->hash;
    const uint32_t went_on = drive(&first.shared, client, made.forest, 9, 20); /* is lost */
    fake_client_destroy(client);
    end(&first);

    begin(&second, state);
    CHECK_INT(registry_ready_count(&second.shared.forests), 1);
    client = fake_client_open(&second.shared);
    attach(client, &made, made.drive_token);
    CHECK_U64(snapshot(&second.shared, client, made.forest)->hash, hash);
    CHECK_U64(drive(&second.shared, client, made.forest, 9, 20), went_on);
    const struct proto_create_reply other = fake_make_forest(&second.shared, client, 6);
    CHECK(other.forest != made.forest);
    fake_client_destroy(client);
    end(&second);
    folder_remove(state);
}

TEST(server_started_anew_has_forests_whose_time_goes_as_before_and_whose_they_were)
{
    char state[FOLDER_PATH];
    kept_service k = {0};
    folder_make(state);
    begin(&k, state);
    const account_list accounts = {.count = 1,
                                   .items = {{.name = "studio", .token = {7}, .caps = account_caps_none()}}};
    CHECK(accounts_set(&k.shared.accounts, &accounts));
    fake_client *client = fake_client_open(&k.shared);
    const uint64_t runs = fake_make_forest(&k.shared, client, 5).forest,
                   rests = fake_make_forest(&k.shared, client, 6).forest;
    client->talk.who->forests--; /* the studio's, from now on */
    registry_find(&k.shared.forests, rests)->account = accounts_find(&k.shared.accounts, "studio");
    accounts_find(&k.shared.accounts, "studio")->forests++;
    keep_round(&k);
    proto_message set = {.type = PROTO_SET_CLOCK, .request = 9};
    set.as.set_clock = (struct proto_set_clock){.forest = runs, .mode = CLOCK_FREE, .rate = 0.5f, .importance = 4};
    fake_send(client, &set);
    fake_expect(client, PROTO_SET_CLOCK_REPLY);
    set.as.set_clock = (struct proto_set_clock){.forest = rests, .mode = CLOCK_PAUSED};
    fake_send(client, &set);
    fake_expect(client, PROTO_SET_CLOCK_REPLY);
    keep_round(&k); /* though nothing has moved since the last one */
    fake_client_destroy(client);
    CHECK(keeper_drain(k.keeper));
    end(&k);

    begin(&k, state);
    const resident *again = registry_find(&k.shared.forests, runs), *still = registry_find(&k.shared.forests, rests);
    CHECK(again && still);
    CHECK_INT(again->clock.mode, CLOCK_FREE);
    CHECK_NEAR(again->clock.rate, 0.5, 0);
    CHECK_NEAR(again->importance, 4, 0);
    CHECK_INT(still->clock.mode, CLOCK_PAUSED);
    CHECK_NEAR(still->importance, 1, 0);
    CHECK_TEXT(again->account->is.name, "owner");
    CHECK_TEXT(still->account->is.name, "owner"); /* the studio is struck off */
    CHECK_INT(accounts_owner(&k.shared.accounts)->forests, 2);
    end(&k);
    folder_remove(state);
}

TEST(server_brings_to_the_disk_what_changed_and_removes_what_ended)
{
    char state[FOLDER_PATH];
    kept_service k = {0};
    size_t size = 0;
    folder_make(state);
    begin(&k, state);
    fake_client *client = fake_client_open(&k.shared);
    const uint64_t moved = fake_make_forest(&k.shared, client, 5).forest,
                   still = fake_make_forest(&k.shared, client, 6).forest;
    keep_round(&k);
    CHECK_U64(keeper_count(k.keeper).written, 2);
    drive(&k.shared, client, moved, 1, 2);
    keep_round(&k);
    CHECK_U64(keeper_count(k.keeper).written, 3);
    keep_round(&k);
    CHECK_U64(keeper_count(k.keeper).written, 3);
    proto_message destroy = {.type = PROTO_DESTROY, .request = 9};
    destroy.as.destroy.forest = still;
    fake_send(client, &destroy);
    fake_expect(client, PROTO_DESTROY_REPLY);
    CHECK(keeper_drain(k.keeper));
    CHECK(!vault_read(&k.place, still, &size));
    fake_client_destroy(client);
    end(&k);
    begin(&k, state);
    CHECK_INT(registry_ready_count(&k.shared.forests), 1);
    keep_round(&k); /* nothing has changed since it was read */
    CHECK_U64(keeper_count(k.keeper).written, 0);
    end(&k);
    folder_remove(state);
}

TEST(server_brings_to_the_disk_in_the_next_round_what_it_could_not_in_this)
{
    char state[FOLDER_PATH], away[FOLDER_PATH + 8];
    kept_service k = {0};
    folder_make(state);
    snprintf(away, sizeof away, "%s/away", state);
    log_set_level(LOG_ERROR);
    begin(&k, state);
    fake_client *client = fake_client_open(&k.shared);
    const uint64_t stays = fake_make_forest(&k.shared, client, 5).forest;
    keep_round(&k);
    drive(&k.shared, client, stays, 1, 2);
    CHECK_INT(rename(k.place.folder, away), 0);
    close(open(k.place.folder, O_WRONLY | O_CREAT, 0600)); /* a file stands in the way */
    fake_now_us += KEEP_US;
    upkeep_do(&k.shared, fake_now_us);
    fake_work(&k.shared, NULL);
    CHECK(!keeper_drain(k.keeper));
    CHECK_INT(keeper_count(k.keeper).lost, 1);
    CHECK_INT(unlink(k.place.folder), 0);
    CHECK_INT(rename(away, k.place.folder), 0);
    const uint64_t written = keeper_count(k.keeper).written;
    keep_round(&k); /* nothing has changed since */
    CHECK_U64(keeper_count(k.keeper).written, written + 1);
    CHECK_INT(keeper_count(k.keeper).lost, 0);
    keep_round(&k);
    CHECK_U64(keeper_count(k.keeper).written, written + 1);
    fake_client_destroy(client);
    end(&k);
    folder_remove(state);
}

TEST(server_starts_without_the_forests_whose_files_are_damaged)
{
    char state[FOLDER_PATH];
    kept_service k = {0};
    size_t size = 0;
    folder_make(state);
    begin(&k, state);
    fake_client *client = fake_client_open(&k.shared);
    const uint64_t good = fake_make_forest(&k.shared, client, 5).forest,
                   bad = fake_make_forest(&k.shared, client, 6).forest;
    keep_round(&k);
    fake_client_destroy(client);
    unsigned char *bytes = vault_read(&k.place, bad, &size);
    bytes[size / 2] ^= 1;
    CHECK(vault_write(&k.place, bad, bytes, size));
    CHECK(vault_write(&k.place, UINT64_C(0x100000007), "cut", 3));
    bytes[size / 2] ^= 1;
    CHECK(vault_write(&k.place, UINT64_C(0x900000003), bytes, size)); /* whole, but of another name */
    free(bytes);
    end(&k);
    begin(&k, state);
    CHECK_INT(registry_ready_count(&k.shared.forests), 1);
    CHECK(registry_find(&k.shared.forests, good) != NULL);
    CHECK(!vault_read(&k.place, bad, &size)); /* set aside, for people */
    end(&k);
    folder_remove(state);
}
