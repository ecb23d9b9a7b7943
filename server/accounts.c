/* accounts.c: see accounts.h. */
#include "accounts.h"
#include "base/error.h"

#include <string.h>

#define OWNER "owner"

enum { BURST_US = 1000000 /* what a second's rate allows may come at once */ };

account_caps account_caps_none(void)
{
    return (account_caps){.connections = UINT64_MAX,
                          .forests = UINT64_MAX,
                          .points = UINT64_MAX,
                          .hair_bytes = UINT64_MAX,
                          .upload_bytes = UINT64_MAX,
                          .messages_per_s = UINT64_MAX};
}

void accounts_init(account_book *all, const uint8_t token[AUTH_TOKEN_SIZE], upload_budget *uploads)
{
    *all = (account_book){.count = 1};
    account *owner = accounts_owner(all);
    owner->is = (account_def){.name = OWNER, .caps = account_caps_none()};
    memcpy(owner->is.token, token, sizeof owner->is.token);
    owner->open = true;
    for (uint32_t i = 0; i <= LIMIT_ACCOUNTS; i++) {
        all->items[i].uploads = (upload_budget){.greatest = UINT64_MAX, .above = uploads};
    }
}

static bool holds_something(const account *a)
{
    return a->connections > 0 || a->forests > 0 || a->uploads.used > 0;
}

static const account_def *find_def(const account_list *list, const char *name)
{
    for (uint32_t i = 0; i < list->count; i++) {
        if (strcmp(list->items[i].name, name) == 0) {
            return &list->items[i];
        }
    }
    return NULL;
}

/* Whether each of the new ones finds a place: its own, one that nobody needs any more, or one that was never taken. */
static bool have_room(account_book *all, const account_list *others)
{
    uint32_t free_places = LIMIT_ACCOUNTS + 1 - all->count, wanted = 0;
    for (uint32_t i = 1; i < all->count; i++) {
        free_places += !find_def(others, all->items[i].is.name) && !holds_something(&all->items[i]);
    }
    for (uint32_t i = 0; i < others->count; i++) {
        wanted += !accounts_find(all, others->items[i].name);
    }
    return wanted <= free_places;
}

/* The place of that name, else one that nobody needs. */
static account *place_for(account_book *all, const char *name)
{
    account *found = accounts_find(all, name);
    for (uint32_t i = 1; !found && i < all->count; i++) {
        found = !all->items[i].open && !holds_something(&all->items[i]) ? &all->items[i] : NULL;
    }
    return found ? found : &all->items[all->count++];
}

bool accounts_set(account_book *all, const account_list *others)
{
    if (!have_room(all, others)) {
        return false;
    }
    for (uint32_t i = 1; i < all->count; i++) {
        all->items[i].open = find_def(others, all->items[i].is.name) != NULL;
    }
    for (uint32_t i = 0; i < others->count; i++) {
        account *a = place_for(all, others->items[i].name);
        a->is = others->items[i];
        a->open = true;
        a->uploads.greatest = a->is.caps.upload_bytes;
    }
    return true;
}

account *accounts_owner(account_book *all)
{
    return &all->items[0];
}

account *accounts_find(account_book *all, const char *name)
{
    for (uint32_t i = 0; i < all->count; i++) {
        if (strcmp(all->items[i].is.name, name) == 0) {
            return &all->items[i];
        }
    }
    return NULL;
}

account *accounts_prove(account_book *all, const uint8_t server_nonce[AUTH_NONCE_SIZE], const struct proto_auth *auth)
{
    account *found = NULL;
    for (uint32_t i = 0; i < all->count; i++) {
        uint8_t expected[AUTH_HASH_SIZE];
        auth_client_proof(all->items[i].is.token, server_nonce, auth->nonce, expected);
        if (auth_equal(expected, auth->proof, sizeof expected) && all->items[i].open) {
            found = &all->items[i];
        }
    }
    return found;
}

void account_count_message(account *who, int64_t now_us)
{
    if (who->is.caps.messages_per_s != UINT64_MAX) {
        const int64_t from_us = who->paid_until_us > now_us ? who->paid_until_us : now_us;
        who->paid_until_us = from_us + (int64_t)(1000000 / who->is.caps.messages_per_s);
    }
}

int64_t account_free_us(const account *who)
{
    return who->is.caps.messages_per_s == UINT64_MAX ? INT64_MIN : who->paid_until_us - BURST_US;
}

bool account_may_make(const account *who, awt_error *error)
{
    const account_caps *caps = &who->is.caps;
    if (who->forests >= caps->forests) {
        error_set(error, AWT_LIMIT, "this token has %lu forests, and that is its limit: DESTROY one first",
                  (unsigned long)who->forests);
    } else if (who->hair_bytes >= caps->hair_bytes) {
        error_set(error, AWT_LIMIT, "the forests of this token fill the %llu MB set aside for them: DESTROY one first",
                  (unsigned long long)(caps->hair_bytes / 1000000));
    } else {
        return true;
    }
    return false;
}
