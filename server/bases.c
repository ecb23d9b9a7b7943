/* bases.c: see bases.h. */
#include "bases.h"

void bases_sent(bases *b, uint64_t sequence, int form, uint64_t base)
{
    b->sent[b->next] = (sent_frame){.sequence = sequence, .form = form};
    b->next = (b->next + 1) % LIMIT_DELTA_BASES;
    b->named = base != 0 ? base : b->named;
}

bool bases_acknowledge(bases *b, uint64_t sequence)
{
    if (sequence == 0) {
        for (int i = 0; i < LIMIT_DELTA_BASES; i++) {
            b->sent[i].held = false;
        }
        return true;
    }
    for (int i = 0; i < LIMIT_DELTA_BASES; i++) {
        if (b->sent[i].sequence == sequence) {
            b->sent[i].held = true;
            return true;
        }
    }
    return sequence < b->sent[b->next].sequence; /* before the oldest known */
}

uint64_t bases_at(const bases *b, int form, uint32_t n)
{
    for (uint32_t back = 1; back <= LIMIT_DELTA_BASES; back++) {
        const sent_frame *f = &b->sent[(b->next + LIMIT_DELTA_BASES - back) % LIMIT_DELTA_BASES];
        if (f->held && f->form == form && f->sequence >= b->named && n-- == 0) {
            return f->sequence;
        }
    }
    return 0;
}
