/* symbols_read.c: the half of symbols.h that reads what a stranger sent. */
#include "geom/symbols.h"

#include "base/bytes.h"
#include "geom/varint.h"

enum { GREATEST_LENGTH = 12, GREATEST_TAG = 15 };

/* One probability, or *absent symbols that do not occur. */
static bool take_share(const unsigned char **at, const unsigned char *end, uint32_t *share, uint32_t *absent)
{
    if (*at == end) {
        return false;
    }
    uint32_t first = *(*at)++, more = first & 3;
    *share = first >> 2;
    *absent = 0;
    if (more == 3) {
        *absent = *share + 1;
        return true;
    }
    for (uint32_t k = 0; k < more; k++) {
        if (*at == end) {
            return false;
        }
        uint32_t byte = *(*at)++;
        *share |= byte << (8 * k + 6);
    }
    return *share > 0;
}

static bool take_table(const unsigned char **at, const unsigned char *end, uint32_t alphabet, int precision,
                       symbols_tables *tables)
{
    const uint32_t whole = UINT32_C(1) << precision;
    uint32_t sum = 0, known;
    if (!varint_take(at, end, &known) || known < 1 || known > alphabet) {
        return false;
    }
    for (uint32_t s = 0; s < known;) {
        uint32_t share, absent;
        if (!take_share(at, end, &share, &absent) || absent > known - s) {
            return false;
        }
        if (absent > 0) {
            s += absent;
            continue;
        }
        if (share > whole - sum) {
            return false;
        }
        tables->shares[s] = (rans_share){share, sum};
        for (uint32_t k = 0; k < share; k++) {
            tables->slots[sum + k] = (uint16_t)s;
        }
        sum += share;
        s++;
    }
    return sum == whole;
}

/* Table, and where the data are. */
static bool open_coded(const unsigned char **at, const unsigned char *end, uint32_t alphabet, int precision,
                       symbols_tables *tables, rans_source *out)
{
    uint32_t size;
    if (!take_table(at, end, alphabet, precision, tables) || !varint_take(at, end, &size) ||
        size > (size_t)(end - *at)) {
        return false;
    }
    *out = (rans_source){*at, size, precision, tables->slots, tables->shares};
    *at += size;
    return true;
}

/* Up to 8 bytes from *at on, the least first. */
static uint64_t peek(const unsigned char *at, const unsigned char *end)
{
    uint64_t value = 0;
    for (int k = 0; k < 8; k++) {
        value |= at + k < end ? (uint64_t)at[k] << (8 * k) : 0;
    }
    return value;
}

/* The bits behind `threes` tags, which stand in the last third of `symbols`: a three is written over tags that have
 * been used. */
static bool take_bits(const unsigned char **at, const unsigned char *end, uint32_t alphabet, uint16_t *symbols,
                      size_t threes)
{
    const uint16_t *tags = symbols + 2 * threes;
    const unsigned char *from = *at;
    uint32_t done = 0, all = 0; /* bits of *from that are used; every bit of every number */
    for (size_t i = 0; i < threes; i++) {
        const uint32_t length = tags[i];
        if (length < 1 || length > GREATEST_TAG || (size_t)(end - from) * 8 < done + 3 * (size_t)length) {
            return false;
        }
        uint64_t bits = (end - from >= 8 ? load_u64(from) : peek(from, end)) >> done;
        const uint32_t mask = (1u << length) - 1;
        uint16_t *s = symbols + 3 * i;
        s[0] = (uint16_t)(bits & mask);
        s[1] = (uint16_t)(bits >> length & mask);
        s[2] = (uint16_t)(bits >> (2 * length) & mask);
        all |= s[0] | s[1] | s[2];
        done += 3 * length;
        from += done >> 3;
        done &= 7;
    }
    *at = from + (done > 0);
    return all < alphabet; /* a power of two, as it is for coordinates */
}

bool symbols_open(const unsigned char **at, const unsigned char *end, uint32_t alphabet, symbols_tables *tables,
                  rans_source *out)
{
    if (end - *at < 2 || **at != SYMBOLS_RAW || (*at)[1] < 1 || (*at)[1] > GREATEST_LENGTH) {
        return false;
    }
    const int precision = 3 * (*at)[1] / 2;
    *at += 2;
    return open_coded(at, end, alphabet, precision < RANS_LEAST_PRECISION ? RANS_LEAST_PRECISION : precision, tables,
                      out);
}

bool symbols_begin(const unsigned char **at, const unsigned char *end, uint32_t alphabet, symbols_tables *tables,
                   uint16_t *symbols, size_t count, symbols_waiting *out)
{
    const bool tagged = *at < end && **at == SYMBOLS_TAGGED && count % 3 == 0;
    *out = (symbols_waiting){tagged ? SYMBOLS_TAGGED : SYMBOLS_RAW, alphabet, count, symbols, {{0}, symbols, count}};
    if (!tagged) {
        return symbols_open(at, end, alphabet, tables, &out->target.source);
    }
    ++*at;
    out->target.symbols = symbols + 2 * (count / 3);
    out->target.count = count / 3;
    return open_coded(at, end, GREATEST_TAG + 1, RANS_LEAST_PRECISION, tables, &out->target.source);
}

bool symbols_end(const unsigned char **at, const unsigned char *end, const symbols_waiting *run)
{
    return run->scheme == SYMBOLS_RAW || take_bits(at, end, run->alphabet, run->symbols, run->count / 3);
}

bool symbols_read(const unsigned char **at, const unsigned char *end, uint32_t alphabet, symbols_tables *tables,
                  uint16_t *symbols, size_t count)
{
    symbols_waiting run;
    return symbols_begin(at, end, alphabet, tables, symbols, count, &run) &&
           rans_decode(&run.target.source, run.target.symbols, run.target.count) && symbols_end(at, end, &run);
}
