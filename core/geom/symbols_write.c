/* symbols_write.c: the half of symbols.h that writes. */
#include "geom/symbols.h"

#include "base/assert.h"
#include "geom/varint.h"

#include <math.h>
#include <string.h>

enum { LEAST_LENGTH = 8, GREATEST_LENGTH = 12, TAG_ALPHABET = 32, TABLE_RUN = 64 };

/* ---- probabilities */

/* How often each symbol occurs, in the first quarter of `counts`. Four quarters, so that a symbol that follows itself,
 * as 0 does where little changed, does not wait for its own count. */
static void count_symbols(const uint16_t *symbols, size_t count, uint32_t alphabet, uint32_t *counts)
{
    uint32_t *a = counts, *b = a + alphabet, *c = b + alphabet, *d = c + alphabet;
    size_t i = 0;
    memset(counts, 0, 4 * (size_t)alphabet * sizeof *counts);
    for (; i + 4 <= count; i += 4) {
        a[symbols[i]]++;
        b[symbols[i + 1]]++;
        c[symbols[i + 2]]++;
        d[symbols[i + 3]]++;
    }
    for (; i < count; i++) {
        a[symbols[i]]++;
    }
    for (uint32_t s = 0; s < alphabet; s++) {
        a[s] += b[s] + c[s] + d[s];
    }
}

/* The symbols that occur, in order; returns how many. */
static uint32_t list_used(const uint32_t *counts, uint32_t alphabet, uint16_t *used)
{
    uint32_t distinct = 0;
    for (uint32_t s = 0; s < alphabet; s++) {
        used[distinct] = (uint16_t)s;
        distinct += counts[s] > 0;
    }
    return distinct;
}

/* What b, of the raw scheme, stands for (from LEAST_LENGTH to GREATEST_LENGTH nothing needs clamping). */
static int precision_of(int length)
{
    return 3 * length / 2;
}

/* Precise enough that symbols that occur once or twice get no more than their share, for they take it from the others,
 * or that all of them together take less than a hundredth; not more, for decoders make tables of 2^precision. */
static int choose_length(uint32_t distinct, size_t count)
{
    int length = LEAST_LENGTH;
    uint64_t whole = UINT64_C(1) << precision_of(length);
    while (length < GREATEST_LENGTH &&
           ((whole < count / 2 && whole < 128 * (uint64_t)distinct) || whole < 2 * distinct)) {
        whole = UINT64_C(1) << precision_of(++length);
    }
    return length;
}

/* Takes `debt` from the probabilities, most from the greatest. There is enough: they sum up to more than twice as many
 * as there are. */
static void pay(uint32_t *counts, const uint16_t *used, uint32_t distinct, uint32_t debt)
{
    uint32_t greatest = used[0];
    for (uint32_t n = 1; n < distinct; n++) {
        greatest = counts[used[n]] > counts[greatest] ? used[n] : greatest;
    }
    uint32_t from = counts[greatest] / 2 < debt ? counts[greatest] / 2 : debt;
    counts[greatest] -= from;
    debt -= from;
    while (debt > 0) {
        for (uint32_t n = 0; n < distinct && debt > 0; n++) {
            uint32_t taken = counts[used[n]] > 1;
            counts[used[n]] -= taken;
            debt -= taken;
        }
    }
}

/* Counts become probabilities, which sum up to 2^precision exactly: rarer symbols than one in 2^precision get the least
 * there is, the others share the rest, each by the rounded sum up to it less the rounded sum before it. */
static void share_out(uint32_t *counts, const uint16_t *used, uint32_t distinct, size_t count, int precision)
{
    const uint64_t whole = UINT64_C(1) << precision, rare_below = (count + whole - 1) / whole;
    uint64_t rare = 0, common = 0;
    for (uint32_t n = 0; n < distinct; n++) {
        bool is_rare = counts[used[n]] < rare_below;
        rare += is_rare;
        common += is_rare ? 0 : counts[used[n]];
    }
    const uint64_t scale = ((whole - rare) << 32) / (common ? common : 1);
    uint64_t before = 0, sum = 0;
    uint32_t debt = 0;
    for (uint32_t n = 0; n < distinct; n++) {
        uint32_t *share = &counts[used[n]];
        bool is_rare = *share < rare_below;
        sum += is_rare ? 0 : *share;
        uint64_t after = (sum * scale + (UINT64_C(1) << 31)) >> 32;
        uint32_t exact = (uint32_t)(after - before);
        debt += !is_rare && exact == 0;
        *share = exact > 1 ? exact : 1;
        before = after;
    }
    pay(counts, used, distinct, debt);
}

/* ---- the table */

static unsigned char *put_absent(unsigned char *at, uint32_t absent)
{
    for (; absent > TABLE_RUN; absent -= TABLE_RUN) {
        *at++ = (TABLE_RUN - 1) << 2 | 3;
    }
    if (absent > 0) {
        *at++ = (unsigned char)((absent - 1) << 2 | 3);
    }
    return at;
}

/* The table, and with the same sums what encoding needs. */
static unsigned char *put_table(unsigned char *at, const uint32_t *shares, const uint16_t *used, uint32_t distinct,
                                int precision, rans_entry *entries)
{
    uint32_t next = 0, sum = 0;
    at = varint_put(at, used[distinct - 1] + 1u);
    for (uint32_t n = 0; n < distinct; n++) {
        uint32_t share = shares[used[n]];
        at = put_absent(at, used[n] - next);
        next = used[n] + 1u;
        uint32_t more = share < 1u << 6 ? 0 : share < 1u << 14 ? 1 : 2, value = share << 2 | more;
        for (uint32_t k = 0; k <= more; k++) {
            *at++ = (unsigned char)(value >> (8 * k));
        }
        entries[used[n]] = rans_entry_make(share, sum, precision);
        sum += share;
    }
    ASSERT(sum == UINT32_C(1) << precision);
    return at;
}

/* ---- tags */

/* Appends numbers of up to 15 bits, the least bit first. */
typedef struct bit_writer {
    unsigned char *at;
    uint64_t pending; /* the bits that make no byte yet, and how many: below 8 between two numbers */
    uint32_t count;
} bit_writer;

static inline void put_bits(bit_writer *w, uint64_t value, uint32_t length)
{
    w->pending |= value << w->count;
    w->count += length;
    for (int k = 0; k < 8; k++) {
        w->at[k] = (unsigned char)(w->pending >> (8 * k));
    }
    w->at += w->count >> 3;
    w->pending >>= w->count & ~7u;
    w->count &= 7;
}

static inline uint32_t length_of(uint32_t a, uint32_t b, uint32_t c)
{
    return 32u - (uint32_t)__builtin_clz(a | b | c | 1);
}

/* Tags of all threes, and their bits. */
static void put_tags(symbols_run *run)
{
    const size_t threes = run->count / 3;
    bit_writer writer = {.at = run->bits};
    for (size_t i = 0; i < threes; i++) {
        const uint16_t *s = run->symbols + 3 * i;
        uint32_t length = length_of(s[0], s[1], s[2]);
        run->tags[i] = (uint16_t)length;
        put_bits(&writer, s[0] | (uint64_t)s[1] << length | (uint64_t)s[2] << (2 * length), 3 * length);
    }
    run->bits_size = (size_t)(writer.at - run->bits) + (writer.count > 0);
}

/* ---- runs */

static double entropy_of(const uint32_t *counts, uint32_t alphabet, size_t count)
{
    double bits = 0;
    for (uint32_t s = 0; s < alphabet; s++) {
        bits += counts[s] > 0 ? counts[s] * log2((double)count / counts[s]) : 0;
    }
    return bits;
}

/* Everything before the rANS data but its length; the lane will put the data where the longest length would end. */
static unsigned char *begin_run(symbols_run *run, rans_lane *lane)
{
    unsigned char *at = run->bytes;
    const bool tagged = run->scheme == SYMBOLS_TAGGED;
    if (run->measure) {
        count_symbols(run->symbols, run->count, run->alphabet, run->counts);
        run->entropy_bits = entropy_of(run->counts, run->alphabet, run->count);
    }
    run->bits_size = 0;
    if (tagged) {
        put_tags(run);
    }
    const uint16_t *coded = tagged ? run->tags : run->symbols;
    const size_t count = tagged ? run->count / 3 : run->count;
    const uint32_t alphabet = tagged ? TAG_ALPHABET : run->alphabet;
    count_symbols(coded, count, alphabet, run->counts);
    const uint32_t distinct = list_used(run->counts, alphabet, run->used);
    const int length = choose_length(distinct, count);
    const int precision = tagged ? RANS_LEAST_PRECISION : precision_of(length);
    share_out(run->counts, run->used, distinct, count, precision);
    *at++ = (unsigned char)run->scheme;
    if (!tagged) {
        *at++ = (unsigned char)length;
    }
    at = put_table(at, run->counts, run->used, distinct, precision, run->entries);
    *lane = (rans_lane){.symbols = coded,
                        .count = count,
                        .entries = run->entries,
                        .precision = precision,
                        .bytes = at + VARINT_MAX_BYTES};
    return at;
}

void symbols_write(symbols_run runs[RANS_LANES])
{
    rans_lane lanes[RANS_LANES] = {{0}};
    unsigned char *ends[RANS_LANES] = {0};
    for (int k = 0; k < RANS_LANES; k++) {
        if (runs[k].count > 0) {
            ends[k] = begin_run(&runs[k], &lanes[k]);
        }
    }
    rans_encode(lanes);
    for (int k = 0; k < RANS_LANES; k++) {
        if (runs[k].count > 0) {
            unsigned char *data = varint_put(ends[k], (uint32_t)lanes[k].size);
            memmove(data, lanes[k].bytes, lanes[k].size);
            runs[k].size = (size_t)(data - runs[k].bytes) + lanes[k].size;
        }
    }
}
