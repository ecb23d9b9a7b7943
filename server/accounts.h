/* accounts.h: who may come in: each account has a name, a token, and bounds on what it holds and sends at once. The
 * owner of the daemon is the first of them, by the token file, without bounds but the daemon's own; the others stand in
 * a file (accounts_file.h). Nothing on the wire names an account: AUTH's proof tells which token a client has.
 *
 * Under the service's lock. Accounts stay where they are as long as the daemon runs; one that was struck off the file
 * keeps its place until nothing is held by it any more. */
#ifndef ACCOUNTS_H
#define ACCOUNTS_H

#include "awt.h"
#include "limits.h"
#include "proto.h"
#include "upload.h"

enum { ACCOUNT_NAME = 33 };

/* Without a bound: the greatest value there is. */
typedef struct account_caps {
    uint64_t connections, forests;
    uint64_t points;     /* that one forest draws: strands times points of each */
    uint64_t hair_bytes; /* forests, as awtctl info shows them; reached: no further one is made */
    uint64_t upload_bytes;
    uint64_t messages_per_s; /* of all its connections; beyond, they are read more slowly */
    bool views_only;         /* it makes and moves nothing */
} account_caps;

account_caps account_caps_none(void);

typedef struct account_def {
    char name[ACCOUNT_NAME];
    uint8_t token[AUTH_TOKEN_SIZE];
    account_caps caps;
} account_def;

typedef struct account_list {
    account_def items[LIMIT_ACCOUNTS];
    uint32_t count;
} account_list;

typedef struct account {
    account_def is;
    bool open; /* its token lets in */
    uint32_t connections, forests;
    uint64_t hair_bytes;
    upload_budget uploads;
    int64_t paid_until_us; /* its messages so far take up its rate until then */
} account;

typedef struct account_book {
    account items[LIMIT_ACCOUNTS + 1]; /* the owner first */
    uint32_t count;
} account_book;

/* The owner alone. `uploads` is the budget of all. */
void accounts_init(account_book *all, const uint8_t token[AUTH_TOKEN_SIZE], upload_budget *uploads);
/* From now on the accounts besides the owner are these; those of a name that was there before keep what they hold.
 * False: the places are taken by accounts that are struck off and still hold something; nothing has changed then. */
bool accounts_set(account_book *all, const account_list *others);

account *accounts_owner(account_book *all);
/* NULL: there is none of that name. */
account *accounts_find(account_book *all, const char *name);
/* The account whose token the proof was made with; NULL: none. Takes the same time whichever it is. */
account *accounts_prove(account_book *all, const uint8_t server_nonce[AUTH_NONCE_SIZE], const struct proto_auth *auth);

/* Counts a message that has come. */
void account_count_message(account *who, int64_t now_us);
/* When its next message may be taken: then, or earlier. */
int64_t account_free_us(const account *who);

/* Whether a further forest may be made; false: `error` says why not (AWT_LIMIT). */
bool account_may_make(const account *who, awt_error *error);

#endif
