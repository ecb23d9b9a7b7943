/* rans.c: see rans.h. */
#include "geom/rans.h"

/* ---- encoding */

/* ceil(2^(31 + log) / p), p being in (2^(log-1), 2^log]: between 2^31 and 2^32 - 1. A quotient that is not whole lies
 * at least 1 / p >= 2^-20 from the next whole number, a double rounds it by at most 2^-22: the ceiling is exact. */
static uint32_t ceil_reciprocal(uint32_t p, int log)
{
    double quotient = (double)(INT64_C(1) << (31 + log)) / (double)p;
    int64_t whole = (int64_t)quotient;
    return (uint32_t)(whole + ((double)whole < quotient));
}

static int ceil_log2(uint32_t p)
{
    return p > 1 ? 32 - __builtin_clz(p - 1) : 0;
}

/* States are in [2^(precision+2), 2^(precision+10)), and one may take a symbol once it is below 1024 p. Bytes are sent
 * until it is: k + 1 of them from 1024 p 2^(8k) on and k below, and of these thresholds exactly one is in the range. */
rans_entry rans_entry_make(uint32_t probability, uint32_t cumulative, int precision)
{
    uint64_t threshold = (uint64_t)probability << 10;
    uint32_t bits = 8;
    while (threshold < UINT64_C(4) << precision) {
        threshold <<= 8;
        bits += 8;
    }
    int log = ceil_log2(probability);
    return (rans_entry){.threshold = (uint32_t)threshold,
                        .reciprocal = ceil_reciprocal(probability, log),
                        .complement = ((UINT32_C(1) << precision) - probability) | bits << 24,
                        .cumulative = cumulative | (uint32_t)(31 + log) << 24};
}

static void put_u32(unsigned char *at, uint32_t value)
{
    at[0] = (unsigned char)value;
    at[1] = (unsigned char)(value >> 8);
    at[2] = (unsigned char)(value >> 16);
    at[3] = (unsigned char)(value >> 24);
}

/* Writes 4 bytes at *at whatever happens and moves it by those that count. */
static inline uint32_t put_symbol(uint32_t state, const rans_entry *entry, unsigned char **at)
{
    uint32_t sent = (entry->complement >> 24) - (state < entry->threshold ? 8 : 0);
    put_u32(*at, state);
    *at += sent >> 3;
    state >>= sent;
    uint32_t quotient = (uint32_t)((uint64_t)state * entry->reciprocal >> (entry->cumulative >> 24));
    return state + quotient * (entry->complement & 0xffffff) + (entry->cumulative & 0xffffff);
}

/* The last state, less the first one: 6, 14, 22 or 30 bits under a length of 2 bits. */
static unsigned char *put_state(unsigned char *at, uint32_t state)
{
    uint32_t length = state < 1u << 6 ? 0 : state < 1u << 14 ? 1 : state < 1u << 22 ? 2 : 3;
    uint32_t value = state | length << (8 * length + 6);
    for (uint32_t k = 0; k <= length; k++) {
        *at++ = (unsigned char)(value >> (8 * k));
    }
    return at;
}

typedef struct rans_writer {
    uint32_t state;
    unsigned char *at;
} rans_writer;

/* What is left of one lane. */
static void put_alone(const rans_lane *lane, size_t *left, rans_writer *writer)
{
    uint32_t state = writer->state;
    unsigned char *at = writer->at;
    while (*left > 0) {
        state = put_symbol(state, &lane->entries[lane->symbols[--*left]], &at);
    }
    *writer = (rans_writer){state, at};
}

/* Lane `k`, of which symbols before number left[k] are still to be written, and its state. */
typedef struct rans_band {
    const rans_lane *lanes;
    size_t left[RANS_LANES];
    rans_writer writers[RANS_LANES];
} rans_band;

/* The next `count` symbols of two lanes. */
static void put_two(rans_band *band, int a, int b, size_t count)
{
    const uint16_t *sa = band->lanes[a].symbols + band->left[a], *sb = band->lanes[b].symbols + band->left[b];
    const rans_entry *ea = band->lanes[a].entries, *eb = band->lanes[b].entries;
    rans_writer wa = band->writers[a], wb = band->writers[b];
    band->left[a] -= count;
    band->left[b] -= count;
    while (count-- > 0) {
        wa.state = put_symbol(wa.state, &ea[*--sa], &wa.at);
        wb.state = put_symbol(wb.state, &eb[*--sb], &wb.at);
    }
    band->writers[a] = wa;
    band->writers[b] = wb;
}

/* The next `count` symbols of all lanes. */
static void put_four(rans_band *band, size_t count)
{
    const rans_lane *lanes = band->lanes;
    const uint16_t *s0 = lanes[0].symbols + band->left[0], *s1 = lanes[1].symbols + band->left[1];
    const uint16_t *s2 = lanes[2].symbols + band->left[2], *s3 = lanes[3].symbols + band->left[3];
    const rans_entry *e0 = lanes[0].entries, *e1 = lanes[1].entries, *e2 = lanes[2].entries, *e3 = lanes[3].entries;
    rans_writer w0 = band->writers[0], w1 = band->writers[1], w2 = band->writers[2], w3 = band->writers[3];
    for (int k = 0; k < RANS_LANES; k++) {
        band->left[k] -= count;
    }
    while (count-- > 0) {
        w0.state = put_symbol(w0.state, &e0[*--s0], &w0.at);
        w1.state = put_symbol(w1.state, &e1[*--s1], &w1.at);
        w2.state = put_symbol(w2.state, &e2[*--s2], &w2.at);
        w3.state = put_symbol(w3.state, &e3[*--s3], &w3.at);
    }
    band->writers[0] = w0;
    band->writers[1] = w1;
    band->writers[2] = w2;
    band->writers[3] = w3;
}

/* The lane with most left, other than `but`. */
static int longest(const rans_band *band, int but)
{
    int found = but == 0 ? 1 : 0;
    for (int k = 0; k < RANS_LANES; k++) {
        found = k != but && band->left[k] > band->left[found] ? k : found;
    }
    return found;
}

void rans_encode(rans_lane lanes[RANS_LANES])
{
    rans_band band = {.lanes = lanes};
    size_t least = SIZE_MAX;
    for (int k = 0; k < RANS_LANES; k++) {
        band.writers[k] = (rans_writer){UINT32_C(4) << lanes[k].precision, lanes[k].bytes};
        band.left[k] = lanes[k].count;
        least = lanes[k].count < least ? lanes[k].count : least;
    }
    if (least > 0) {
        put_four(&band, least);
    }
    for (int a = longest(&band, -1); band.left[a] > 0; a = longest(&band, -1)) {
        int b = longest(&band, a);
        if (band.left[b] > 0) {
            put_two(&band, a, b, band.left[b]);
        } else {
            put_alone(&lanes[a], &band.left[a], &band.writers[a]);
        }
    }
    for (int k = 0; k < RANS_LANES; k++) {
        if (lanes[k].count > 0) {
            uint32_t first = UINT32_C(4) << lanes[k].precision;
            unsigned char *end = put_state(band.writers[k].at, band.writers[k].state - first);
            lanes[k].size = (size_t)(end - lanes[k].bytes);
        }
    }
}

/* ---- decoding */

/* The state that an encoder ended with; *size shrinks by its bytes. 0: there is none. */
static uint32_t take_state(const rans_source *source, size_t *size)
{
    if (*size < 1) {
        return 0;
    }
    size_t length = (size_t)(source->bytes[*size - 1] >> 6) + 1;
    if (length > *size) {
        return 0;
    }
    *size -= length;
    uint32_t state = 0;
    for (size_t k = length; k-- > 0;) {
        state = state << 8 | source->bytes[*size + k];
    }
    state &= (UINT32_C(1) << (8 * length - 2)) - 1;
    return state < UINT32_C(1020) << source->precision ? state + (UINT32_C(4) << source->precision) : 0;
}

/* Where decoding of one stream stands. */
typedef struct rans_reader {
    uint32_t state;
    size_t left; /* bytes */
} rans_reader;

/* The last `count` symbols of a stream. */
static bool take_rest(const rans_source *source, rans_reader reader, uint16_t *symbols, size_t count)
{
    const uint32_t least = UINT32_C(4) << source->precision, mask = (UINT32_C(1) << source->precision) - 1;
    const int precision = source->precision;
    const unsigned char *bytes = source->bytes;
    size_t left = reader.left;
    uint32_t state = reader.state;
    for (size_t i = 0; i < count; i++) {
        while (state < least && left > 0) {
            state = state << 8 | bytes[--left];
        }
        uint32_t slot = state & mask;
        uint16_t symbol = source->slots[slot];
        const rans_share *share = &source->shares[symbol];
        state = (state >> precision) * share->probability + slot - share->cumulative;
        symbols[i] = symbol;
    }
    while (state < least && left > 0) {
        state = state << 8 | bytes[--left];
    }
    return state == least && left == 0;
}

bool rans_decode(const rans_source *source, uint16_t *symbols, size_t count)
{
    rans_reader reader = {.left = source->size};
    reader.state = take_state(source, &reader.left);
    return reader.state != 0 && take_rest(source, reader, symbols, count);
}

enum { WINDOW = 4, MOST_TAKEN = 3 /* bytes that one symbol takes, of a precision of 18 at most */ };

/* One symbol, and the bytes that bring the state back above its least: as many as it is short of, without a branch.
 * `at`, behind the next byte, has WINDOW of them before it. */
static inline uint16_t take_symbol(const rans_source *source, uint32_t *state, const unsigned char **at)
{
    const int precision = source->precision;
    const uint32_t slot = *state & ((UINT32_C(1) << precision) - 1);
    const uint16_t symbol = source->slots[slot];
    const rans_share *share = &source->shares[symbol];
    const uint32_t next = (*state >> precision) * share->probability + slot - share->cumulative;
    const int missing = precision + 3 - (32 - __builtin_clz(next)); /* bits */
    const int taken = missing > 0 ? (missing + 7) & ~7 : 0;
    const unsigned char *b = *at - WINDOW;
    const uint64_t window = (uint32_t)b[0] | (uint32_t)b[1] << 8 | (uint32_t)b[2] << 16 | (uint32_t)b[3] << 24;
    *state = (uint32_t)(((uint64_t)next << 32 | window) >> (32 - taken));
    *at -= taken >> 3;
    return symbol;
}

/* `count` symbols of each stream, from number `done` on, for which there are bytes enough. */
static void take_four(const rans_target *targets, rans_reader *readers, size_t done, size_t count)
{
    const rans_source s0 = targets[0].source, s1 = targets[1].source, s2 = targets[2].source, s3 = targets[3].source;
    const unsigned char *a0 = s0.bytes + readers[0].left, *a1 = s1.bytes + readers[1].left;
    const unsigned char *a2 = s2.bytes + readers[2].left, *a3 = s3.bytes + readers[3].left;
    uint32_t x0 = readers[0].state, x1 = readers[1].state, x2 = readers[2].state, x3 = readers[3].state;
    for (size_t i = done; i < done + count; i++) {
        targets[0].symbols[i] = take_symbol(&s0, &x0, &a0);
        targets[1].symbols[i] = take_symbol(&s1, &x1, &a1);
        targets[2].symbols[i] = take_symbol(&s2, &x2, &a2);
        targets[3].symbols[i] = take_symbol(&s3, &x3, &a3);
    }
    readers[0] = (rans_reader){x0, (size_t)(a0 - s0.bytes)};
    readers[1] = (rans_reader){x1, (size_t)(a1 - s1.bytes)};
    readers[2] = (rans_reader){x2, (size_t)(a2 - s2.bytes)};
    readers[3] = (rans_reader){x3, (size_t)(a3 - s3.bytes)};
}

/* How many symbols a stream can give without a look at where its bytes end. */
static size_t sure_symbols(const rans_target *target, const rans_reader *reader, size_t done)
{
    const size_t bytes = reader->left < WINDOW ? 0 : (reader->left - WINDOW) / MOST_TAKEN;
    const size_t symbols = target->count - done;
    return bytes < symbols ? bytes : symbols;
}

/* How many streams are still to be decoded; *any becomes the last of them. */
static int count_left(const bool left[RANS_LANES], int *any)
{
    int count = 0;
    for (int k = 0; k < RANS_LANES; k++) {
        count += left[k];
        *any = left[k] ? k : *any;
    }
    return count;
}

bool rans_decode_lanes(const rans_target targets[RANS_LANES])
{
    enum { WORTH_IT = 8, LANES_WORTH_IT = 3 /* fewer are faster one after the other */ };
    rans_target lanes[RANS_LANES]; /* one that is not used, or at its end, does what another does, to the same place */
    rans_reader readers[RANS_LANES];
    bool left[RANS_LANES], right = true;
    size_t done = 0;
    for (int k = 0; k < RANS_LANES; k++) {
        lanes[k] = targets[k];
        readers[k] = (rans_reader){.left = targets[k].source.size};
        left[k] = targets[k].count > 0;
        readers[k].state = left[k] ? take_state(&targets[k].source, &readers[k].left) : 0;
        right = right && (!left[k] || readers[k].state != 0);
    }
    for (int any = 0, count = count_left(left, &any); right && count > 0; count = count_left(left, &any)) {
        size_t sure = SIZE_MAX;
        int least = any;
        for (int k = 0; k < RANS_LANES; k++) {
            lanes[k] = left[k] ? lanes[k] : lanes[any];
            readers[k] = left[k] ? readers[k] : readers[any];
            const size_t here = sure_symbols(&lanes[k], &readers[k], done);
            least = here < sure ? k : least;
            sure = here < sure ? here : sure;
        }
        if (sure >= WORTH_IT && count >= LANES_WORTH_IT) {
            take_four(lanes, readers, done, sure);
            done += sure;
        } else {
            least = left[least] ? least : any;
            right =
                take_rest(&lanes[least].source, readers[least], lanes[least].symbols + done, lanes[least].count - done);
            left[least] = false;
        }
    }
    return right;
}
