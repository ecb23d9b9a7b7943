/* test_groom_cache.c: forests of the same hair stand on one groom. */
#include "server_fixture.h"
#include "check.h"
#include "groom_cache.h"

static made_groom make(uint64_t seed)
{
    awt_strands strands = {0};
    awt_groom_def def = awt_groom_def_of_style(awt_style_find("short"));
    awt_groom_info info;
    made_groom made = {0};
    CHECK_INT(awt_style_grow(awt_style_find("short"), 100, seed, &strands, NULL), AWT_OK);
    CHECK_INT(awt_groom_build(&strands, &def, NULL, NULL, &made.groom, NULL), AWT_OK);
    awt_groom_get_info(made.groom, &info);
    awt_strands_fini(&strands);
    made.bytes = info.bytes;
    return made;
}

TEST(groom_cache_keeps_within_its_bound_what_nobody_uses)
{
    const made_groom a = make(1), b = make(2), twin = make(1);
    groom_cache *cache = groom_cache_create(a.bytes + b.bytes / 2); /* room for one of them */
    CHECK(groom_cache_find(cache, "a") == NULL);
    const made_groom *first = groom_cache_add(cache, "a", &a), *second = groom_cache_add(cache, "b", &b);
    CHECK(first && first->groom == a.groom && second && second->groom == b.groom);
    CHECK(groom_cache_find(cache, "a") == first);
    CHECK(groom_cache_add(cache, "a", &twin) == first); /* made twice at once: the twin is freed */
    CHECK_U64(groom_cache_bytes(cache), a.bytes + b.bytes);
    for (int users = 3; users > 0; users--) {
        groom_cache_release(cache, first);
    }
    CHECK(groom_cache_find(cache, "a") == first); /* nobody used it, and it was kept */
    groom_cache_release(cache, first);
    groom_cache_release(cache, second);
    CHECK_U64(groom_cache_bytes(cache), a.bytes); /* there was room for one: the one taken last */
    CHECK(groom_cache_find(cache, "b") == NULL);
    groom_cache_destroy(cache);
}

TEST(server_forests_of_the_same_hair_share_their_groom)
{
    service shared;
    CHECK(fake_service_init(&shared, 0, 4, false));
    fake_client *client = fake_client_open(&shared);
    const struct proto_create_reply one = fake_make_forest(&shared, client, 1);
    const uint64_t bytes = registry_bytes(&shared.forests);
    const struct proto_create_reply same = fake_make_forest(&shared, client, 1);
    const uint64_t more = registry_bytes(&shared.forests) - bytes;
    const struct proto_create_reply other = fake_make_forest(&shared, client, 2);
    const resident *a = registry_find(&shared.forests, one.forest), *b = registry_find(&shared.forests, same.forest),
                   *c = registry_find(&shared.forests, other.forest);
    CHECK(a && b && c && a->work.groom == b->work.groom && a->work.groom != c->work.groom);
    CHECK_U64(more, b->bytes); /* without the groom */
    CHECK_INT(same.build_us, 0);
    CHECK_INT(same.strands, one.strands);
    CHECK(same.rebuilt_max_m == one.rebuilt_max_m && same.head_radius_m == one.head_radius_m);
    proto_message create = fake_create(1); /* another figure, another groom */
    create.as.create.sections = 7;
    CHECK(fake_send(client, &create));
    fake_work(&shared, client);
    const resident *d = registry_find(&shared.forests, fake_expect(client, PROTO_CREATE_REPLY)->as.create_reply.forest);
    CHECK(d && d->work.groom != a->work.groom);
    proto_message destroy = {.type = PROTO_DESTROY, .as.destroy.forest = one.forest};
    CHECK(fake_send(client, &destroy)); /* the other still stands on it */
    fake_expect(client, PROTO_DESTROY_REPLY);
    proto_message query = fake_query(same.forest, 10000);
    CHECK(fake_send(client, &query));
    fake_work(&shared, client);
    fake_expect(client, PROTO_FRAME);
    fake_client_destroy(client);
    service_fini(&shared);
}
