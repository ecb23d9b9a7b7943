/* interleaving_says.h: what the files have in common that hold what a client of an interleaving says. */
#ifndef INTERLEAVING_SAYS_H
#define INTERLEAVING_SAYS_H

#include "interleaving_actor.h"

uint32_t actor_decide(const actor *who, uint32_t below);
/* Puts a message, which is answered so often, into the wire; nothing where there is no room, or too much is open. */
void actor_put(actor *who, proto_message *message, uint32_t answers);
/* Mostly the one that it opened last, else one of those that were made last, or one that never was. */
const struct proto_create_reply *actor_some_forest(const actor *who);

/* interleaving_opens.c */
void say_hello(actor *who);
void say_auth(actor *who);
void say_resume(actor *who);
void say_create(actor *who);
void say_upload(actor *who);
void say_hair(actor *who);
void say_attach(actor *who);
void say_restore(actor *who);

#endif
