/* test_geom_symbols.c: the entropy coder by itself: what goes in comes out, whatever it is, and side by side as alone.
 */
#include "check.h"

#include "base/rng.h"
#include "geom/symbols.h"

#include <stdlib.h>
#include <string.h>

enum { MOST = 30000, ALPHABET = 1 << 14 };

/* All the memory of one run. */
typedef struct room {
    uint16_t symbols[MOST], tags[MOST / 3], used[ALPHABET];
    uint32_t counts[4 * ALPHABET];
    rans_entry entries[ALPHABET];
    unsigned char bytes[ALPHABET * 3 + MOST * 3 + 64], bits[MOST * 2 + 8];
} room;

static symbols_run run_of(room *r, symbols_scheme scheme, size_t count)
{
    return (symbols_run){.scheme = scheme,
                         .symbols = r->symbols,
                         .count = count,
                         .alphabet = ALPHABET,
                         .counts = r->counts,
                         .used = r->used,
                         .entries = r->entries,
                         .tags = r->tags,
                         .bytes = r->bytes,
                         .bits = r->bits};
}

/* Number i of a run in which a thousand symbols are rarer than the least probability, and as many just not. */
static uint32_t edge(size_t i)
{
    return (uint32_t)(i < 1000 ? i : i < 3000 ? 1000 + (i - 1000) / 2 : 5000);
}

/* Kinds of numbers: all alike, two, few, hair's differences, a ramp over the whole alphabet, noise over all of it,
 * rare. */
enum { FILLS = 7 };
static void fill(room *r, int kind, size_t count, rng *random)
{
    for (size_t i = 0; i < count; i++) {
        uint32_t noise = rng_u32(random);
        uint32_t bell = (noise & 63) + (noise >> 6 & 63) + (noise >> 12 & 63) + (noise >> 18 & 1023) / 200;
        const uint32_t values[FILLS] = {
            7, noise % 500 == 0, noise % 5, bell, (uint32_t)i % ALPHABET, noise % ALPHABET, edge(i)};
        r->symbols[i] = (uint16_t)values[kind];
    }
}

/* The run as it stands in the bitstream, in memory of exactly its size. */
static unsigned char *joined(const symbols_run *run, size_t *size)
{
    *size = run->size + run->bits_size;
    unsigned char *all = malloc(*size);
    memcpy(all, run->bytes, run->size);
    memcpy(all + run->size, run->bits, run->bits_size);
    return all;
}

static void check_reads_back(const symbols_run *run, symbols_tables *tables)
{
    size_t size;
    unsigned char *all = joined(run, &size);
    uint16_t *back = malloc(run->count * sizeof *back);
    const unsigned char *at = all;
    CHECK(symbols_read(&at, all + size, ALPHABET, tables, back, run->count));
    CHECK(at == all + size);
    CHECK(memcmp(back, run->symbols, run->count * sizeof *back) == 0);
    free(back);
    free(all);
}

TEST(geom_symbols_come_back_whatever_they_are)
{
    const size_t counts[] = {3, 6, 99, 3000, 8190, MOST};
    symbols_tables *tables = malloc(sizeof *tables);
    room *r = malloc(sizeof *r);
    rng random = rng_seed(11);
    for (int kind = 0; kind < FILLS; kind++) {
        for (size_t c = 0; c < sizeof counts / sizeof counts[0]; c++) {
            fill(r, kind, counts[c], &random);
            for (int scheme = SYMBOLS_TAGGED; scheme <= SYMBOLS_RAW; scheme++) {
                symbols_run runs[RANS_LANES] = {run_of(r, (symbols_scheme)scheme, counts[c])};
                symbols_write(runs);
                CHECK(runs[0].size <= symbols_bound(ALPHABET, counts[c]));
                CHECK(runs[0].bits_size <= symbols_bits_bound(counts[c]));
                check_reads_back(&runs[0], tables);
            }
        }
    }
    free(r);
    free(tables);
}

TEST(geom_symbols_written_side_by_side_are_those_written_alone)
{
    const size_t counts[RANS_LANES] = {MOST, 3000, 9999, 9};
    room *rooms = malloc(RANS_LANES * sizeof *rooms), *alone = malloc(sizeof *alone);
    symbols_run runs[RANS_LANES];
    rng random = rng_seed(12);
    for (int scheme = SYMBOLS_TAGGED; scheme <= SYMBOLS_RAW; scheme++) {
        for (int k = 0; k < RANS_LANES; k++) {
            fill(&rooms[k], 3, counts[k], &random);
            runs[k] = run_of(&rooms[k], (symbols_scheme)scheme, counts[k]);
        }
        symbols_write(runs);
        for (int k = 0; k < RANS_LANES; k++) {
            memcpy(alone->symbols, rooms[k].symbols, sizeof alone->symbols);
            symbols_run one[RANS_LANES] = {{0}};
            one[3 - k] = run_of(alone, (symbols_scheme)scheme, counts[k]);
            symbols_write(one);
            CHECK_U64(one[3 - k].size, runs[k].size);
            CHECK_BYTES(one[3 - k].bytes, runs[k].bytes, runs[k].size);
            CHECK_U64(one[3 - k].bits_size, runs[k].bits_size);
            CHECK_BYTES(one[3 - k].bits, runs[k].bits, runs[k].bits_size);
        }
    }
    free(rooms);
    free(alone);
}

/* Within 2 % of the entropy, and what the tables take. */
TEST(geom_symbols_come_near_their_entropy)
{
    room *r = malloc(sizeof *r);
    rng random = rng_seed(13);
    fill(r, 3, MOST, &random);
    symbols_run runs[RANS_LANES] = {run_of(r, SYMBOLS_RAW, MOST)};
    runs[0].measure = true;
    symbols_write(runs);
    double bits = 8.0 * (double)runs[0].size;
    CHECK(runs[0].entropy_bits > 6.0 * MOST && runs[0].entropy_bits < 8.0 * MOST);
    CHECK(bits > runs[0].entropy_bits && bits < 1.02 * runs[0].entropy_bits + 8 * 400);
    free(r);
}

/* A probability's reciprocal stands for the division in every state that can meet it. */
TEST(geom_rans_divides_exactly)
{
    rng random = rng_seed(14);
    for (uint32_t p = 1; p <= 1u << 18; p += 1 + (p > 5000 ? rng_u32(&random) % 999 : 0)) {
        const rans_entry entry = rans_entry_make(p, 0, 18);
        for (int n = 0; n < 8; n++) {
            uint64_t state = n == 0 ? 4 * p : n == 1 ? 1024 * p - 1 : n < 5 ? rng_u32(&random) % (1024 * p) / p * p : 0;
            state = n < 5 ? state - (n == 3 && state > 0) : 4 * p + rng_u32(&random) % (1020 * p);
            CHECK_U64(state * entry.reciprocal >> (entry.cumulative >> 24), state / p);
        }
    }
}

TEST(geom_symbols_cut_short_or_damaged_are_refused)
{
    symbols_tables *tables = malloc(sizeof *tables);
    room *r = malloc(sizeof *r);
    rng random = rng_seed(15);
    uint16_t back[300];
    int taken = 0, flips = 0;
    for (int scheme = SYMBOLS_TAGGED; scheme <= SYMBOLS_RAW; scheme++) {
        fill(r, 3, 300, &random);
        symbols_run runs[RANS_LANES] = {run_of(r, (symbols_scheme)scheme, 300)};
        symbols_write(runs);
        size_t size;
        unsigned char *all = joined(&runs[0], &size);
        for (size_t cut = 0; cut < size; cut++) {
            unsigned char *copy = malloc(cut ? cut : 1);
            memcpy(copy, all, cut);
            const unsigned char *at = copy;
            CHECK(!symbols_read(&at, copy + cut, ALPHABET, tables, back, 300));
            free(copy);
        }
        for (size_t place = 0; place < runs[0].size; place++) { /* all but the bits */
            for (int bit = 0; bit < 8; bit++) {
                all[place] ^= (unsigned char)(1 << bit);
                const unsigned char *at = all;
                taken += symbols_read(&at, all + size, ALPHABET, tables, back, 300) && at == all + size;
                flips++;
                all[place] ^= (unsigned char)(1 << bit);
            }
        }
        free(all);
    }
    CHECK(flips > 3000 && taken < flips / 40); /* the coder's end is a weak checksum */
    free(r);
    free(tables);
}
