/* test_interleaving.c: what must hold of every conversation with the daemon's logic, over many seeds. AWT_SEEDS says
 * how many (make soak: thousands). */
#include "check.h"
#include "interleaving.h"

#include <stdio.h>
#include <stdlib.h>

enum { SEEDS = 80, DECISIONS = 1500 };

TEST(server_keeps_its_promises_however_clients_interleave)
{
    const char *asked = getenv("AWT_SEEDS");
    const long seeds = asked ? strtol(asked, NULL, 10) : SEEDS;
    uint64_t answers = 0, errors = 0, frames = 0, cuts = 0, restored = 0, many = 0, clocks = 0;
    for (long seed = 1; seed <= seeds; seed++) {
        const interleaving seen = interleaving_of_seed((uint64_t)seed, DECISIONS);
        if (seen.broken) {
            printf("   seed %ld\n", seed);
        }
        CHECK_TEXT(seen.broken ? seen.broken : "", "");
        answers += seen.answers;
        errors += seen.errors;
        frames += seen.frames;
        cuts += seen.cuts;
        restored += seen.restored;
        many += seen.many;
        clocks += seen.clocks;
    }
    printf("   %ld seeds: %llu answers, %llu errors, %llu frames, %llu cuts\n", seeds, (unsigned long long)answers,
           (unsigned long long)errors, (unsigned long long)frames, (unsigned long long)cuts);
    CHECK(answers > (uint64_t)seeds * 20);
    printf("   of them %llu of RESTORE, %llu of STEP_MANY, %llu of SET_CLOCK\n", (unsigned long long)restored,
           (unsigned long long)many, (unsigned long long)clocks);
    CHECK(restored > (uint64_t)seeds / 8 && many > (uint64_t)seeds && clocks > (uint64_t)seeds);
    CHECK(frames > (uint64_t)seeds && errors > (uint64_t)seeds && cuts > (uint64_t)seeds);
}

TEST(server_says_the_same_where_the_same_is_decided)
{
    const interleaving once = interleaving_of_seed(77, DECISIONS), again = interleaving_of_seed(77, DECISIONS);
    const interleaving other = interleaving_of_seed(78, DECISIONS);
    CHECK_U64(once.hash, again.hash);
    CHECK(once.hash != other.hash);
}
