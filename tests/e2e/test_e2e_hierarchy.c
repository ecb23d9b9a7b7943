/* test_e2e_hierarchy.c: a strand file and its hierarchy, through the daemon and through awtctl. */
#include "check.h"
#include "e2e/daemon.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include "awt.h"
#include "base/assert.h"
#include "base/bytes.h"

/* Every tenth strand of the file has no length: the hierarchy has its line all the same. */
enum {
    STRANDS = 600,
    GROWN = STRANDS - STRANDS / 10,
    POINTS = 8,
    HEADER = 160,
    STRANDS_UPLOAD = 5,
    HIERARCHY_UPLOAD = 6
};

typedef struct files {
    unsigned char *strands; /* TressFX 4.0 */
    size_t strands_size;
    char *hierarchy; /* 2 levels: 7 wisps, 35 locks */
    size_t hierarchy_size;
} files;

static files files_make(void)
{
    awt_style style = *awt_style_find("short");
    style.points_per_strand = POINTS;
    awt_strands grown = {0};
    files f = {.strands_size = HEADER + STRANDS * POINTS * 16};
    f.strands = calloc(1, f.strands_size);
    f.hierarchy = calloc(STRANDS, 32);
    ASSERT(f.strands && f.hierarchy && awt_style_grow(&style, GROWN, 1, &grown, NULL) == AWT_OK);
    store_f32(f.strands, 4.0f);
    store_u32(f.strands + 4, STRANDS);
    store_u32(f.strands + 8, POINTS);
    store_u32(f.strands + 12, HEADER);
    uint32_t kept = 0;
    for (uint32_t s = 0; s < STRANDS; s++) {
        const bool flat = s % 10 == 3;
        for (uint32_t i = 0; i < POINTS * 3 && !flat; i++) {
            store_f32(f.strands + HEADER + (s * POINTS + i / 3) * 16 + 4 * (i % 3),
                      grown.positions[kept * POINTS * 3 + i]);
        }
        kept += flat ? 0 : 1;
        int lock = flat ? 999999 : (int)(kept % 35);
        f.hierarchy_size +=
            (size_t)snprintf(f.hierarchy + f.hierarchy_size, 32, "%d, %d\n", flat ? 888888 : 70 + lock % 7, lock);
    }
    awt_strands_fini(&grown);
    return f;
}

static void files_fini(files *f)
{
    free(f->strands);
    free(f->hierarchy);
}

static bool upload(awtclient *client, uint32_t number, const void *bytes, size_t size)
{
    awtclient_error error = {0};
    bool sent = awtclient_upload(client, number, bytes, size, NULL, NULL, &error);
    CHECK_TEXT(error.text, "");
    return sent;
}

static proto_message create_request(void)
{
    proto_message request = {.type = PROTO_CREATE};
    struct proto_create *create = &request.as.create;
    create->source = 1;
    create->upload = STRANDS_UPLOAD;
    create->own_hierarchy = 1;
    create->hierarchy = HIERARCHY_UPLOAD;
    create->scale = 1;
    create->up = 1;
    create->head_radius = AWT_HEAD_RADIUS_M;
    create->head.orientation[3] = create->body.orientation[3] = 1;
    return request;
}

TEST(e2e_a_strand_file_brings_its_own_hierarchy)
{
    daemon_process daemon;
    CHECK(daemon_start(&daemon, 1, NULL));
    awtclient *client = daemon_client(&daemon);
    files f = files_make();
    CHECK(upload(client, STRANDS_UPLOAD, f.strands, f.strands_size));
    CHECK(upload(client, HIERARCHY_UPLOAD, f.hierarchy, f.hierarchy_size));
    proto_message request = create_request(), answer;
    awtclient_error error = {0};
    CHECK(awtclient_call(client, &request, &answer, &error));
    CHECK_TEXT(error.text, "");
    const struct proto_create_reply reply = answer.as.create_reply;
    CHECK_INT(reply.strands, GROWN);
    CHECK_INT(reply.skipped_strands, STRANDS - GROWN);
    CHECK_INT(reply.levels, 2);
    CHECK_INT(reply.wisp_levels.count, 2);
    CHECK_INT(reply.wisp_levels.items[0].wisps, 7);
    CHECK_INT(reply.wisp_levels.items[1].wisps, 35);
    CHECK_INT(reply.top_wisps, 7);
    CHECK_INT(reply.finest_wisps, 35);
    CHECK(reply.wisp_levels.items[0].mean_radius_m > reply.wisp_levels.items[1].mean_radius_m);
    CHECK(reply.wisp_levels.items[1].mean_radius_m > 0.001f);
    CHECK(reply.rebuilt_max_m > 0 && reply.rebuilt_max_m < 1e-4f);
    CHECK(reply.rebuilt_mean_m > 0 && reply.rebuilt_mean_m < reply.rebuilt_max_m);

    proto_message query = {.type = PROTO_QUERY};
    query.as.query.forest = reply.forest;
    query.as.query.time_us = 20000;
    CHECK(awtclient_call(client, &query, &answer, &error));
    CHECK(answer.as.frame.glb.length > 1000);

    request = create_request(); /* the same strands, of which the daemon makes wisps itself */
    request.as.create.own_hierarchy = 0;
    CHECK(awtclient_call(client, &request, &answer, &error));
    CHECK_INT(answer.as.create_reply.wisp_levels.count, 3);
    files_fini(&f);
    awtclient_close(client);
    CHECK_INT(daemon_stop(&daemon), 0);
}

/* The code with which a CREATE fails that has `text` for a hierarchy; the error says `says`. */
static int refusal(awtclient *client, const char *text, size_t size, const char *says)
{
    proto_message request = create_request(), answer;
    awtclient_error error = {0};
    bool made = upload(client, HIERARCHY_UPLOAD, text, size) && awtclient_call(client, &request, &answer, &error);
    CHECK(!made);
    CHECK_TEXT(strstr(error.text, says) ? says : error.text, says);
    return error.code;
}

TEST(e2e_a_hierarchy_that_does_not_fit_is_refused_and_the_connection_goes_on)
{
    daemon_process daemon;
    CHECK(daemon_start(&daemon, 1, NULL));
    awtclient *client = daemon_client(&daemon);
    files f = files_make();
    CHECK(upload(client, STRANDS_UPLOAD, f.strands, f.strands_size));
    proto_message request = create_request(), answer;
    awtclient_error error = {0};
    CHECK(!awtclient_call(client, &request, &answer, &error));
    CHECK_INT(error.code, PROTO_ERROR_NO_UPLOAD);

    const size_t size = f.hierarchy_size, last_line = (size_t)(strrchr(f.hierarchy, ',') - f.hierarchy) - 4;
    char *lines = malloc(size + 64);
    ASSERT(lines);
    memcpy(lines, f.hierarchy, size);
    CHECK_INT(refusal(client, lines, last_line, "but there are 600"), PROTO_ERROR_BAD_VALUE);
    CHECK_INT(refusal(client, lines, size - 4, "line 600 of the hierarchy"), PROTO_ERROR_BAD_VALUE);
    memcpy(lines, "79", 2); /* the first strand's wisp, but not its lock's */
    CHECK_INT(refusal(client, lines, size, "strand 39 is in wisp 1 of level 2"), PROTO_ERROR_BAD_VALUE);
    CHECK_INT(refusal(client, "1 2 3 4 5\n", 10, "line 1"), PROTO_ERROR_LIMIT);
    CHECK_INT(refusal(client, (const char *)f.strands, f.strands_size, "line 1"), PROTO_ERROR_BAD_VALUE);
    CHECK_INT(refusal(client, "\n", 1, "no line"), PROTO_ERROR_BAD_VALUE);

    CHECK(upload(client, HIERARCHY_UPLOAD, f.hierarchy, size));
    request = create_request();
    request.as.create.levels = 2;
    CHECK(!awtclient_call(client, &request, &answer, &error));
    CHECK_INT(error.code, PROTO_ERROR_BAD_VALUE);
    request = create_request();
    CHECK(awtclient_call(client, &request, &answer, &error));
    free(lines);
    files_fini(&f);
    awtclient_close(client);
    CHECK_INT(daemon_stop(&daemon), 0);
}

static bool write_file(const char *path, const void *bytes, size_t size)
{
    FILE *file = fopen(path, "wb");
    bool written = file && fwrite(bytes, 1, size, file) == size;
    return file && fclose(file) == 0 && written;
}

static void check_holds(const char *text, const char *what)
{
    CHECK_TEXT(text && strstr(text, what) ? what : text ? text : "(nothing)", what);
}

TEST(e2e_awtctl_takes_a_hierarchy_and_reports_what_became_of_it)
{
    daemon_process daemon;
    CHECK(daemon_start(&daemon, 1, NULL));
    files f = files_make();
    char strands[128], hierarchy[128], text[128], json[128], command[2048];
    snprintf(strands, sizeof strands, "%s/hair.tfx", daemon.state_directory);
    snprintf(hierarchy, sizeof hierarchy, "%s/hair.csv", daemon.state_directory);
    snprintf(text, sizeof text, "%s/text", daemon.state_directory);
    snprintf(json, sizeof json, "%s/json", daemon.state_directory);
    CHECK(write_file(strands, f.strands, f.strands_size) && write_file(hierarchy, f.hierarchy, f.hierarchy_size));
    snprintf(command, sizeof command,
             "%s/awtctl play --connect %s --token-file %s --groom %s --hierarchy %s --head 0,0,0,0.095 --scale 1 "
             "--up y --frames 1 --quiet --json %s > %s",
             check_build_directory(), daemon.address, daemon.token_file, strands, hierarchy, json, text);
    CHECK_INT(system(command), 0);
    size_t size = 0;
    unsigned char *out = check_read_file(text, &size);
    char *report = calloc(1, size + 1);
    ASSERT(report);
    memcpy(report, out ? out : (unsigned char *)"", out ? size : 0);
    check_holds(report, "wisps   7 of radius ");
    check_holds(report, " mm > 35 of radius ");
    check_holds(report, "rebuilt at rest within ");
    free(report), free(out);
    out = check_read_file(json, &size);
    report = calloc(1, size + 1);
    ASSERT(report);
    memcpy(report, out ? out : (unsigned char *)"", out ? size : 0);
    check_holds(report, "\"wisp_levels\"");
    check_holds(report, "\"wisps\": 35");
    check_holds(report, "\"rebuilt_max_m\"");
    free(report), free(out);
    unlink(strands), unlink(hierarchy), unlink(text), unlink(json);
    files_fini(&f);
    CHECK_INT(daemon_stop(&daemon), 0);
}
