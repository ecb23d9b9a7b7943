/* evaluate.c: see evaluate.h.
 *
 * evaluate_strands is where the time goes, 160,000 points a frame: LANES stations side by side are loaded once for a
 * few strands, and every point costs nine products. */
#include "sim/evaluate.h"

enum {
    RECORD = 8,  /* floats of a section or a station: a point, 0, a quaternion */
    SECTIONS = 4 /* that a station's curve is made of */
};

typedef float evaluate_record __attribute__((vector_size(4 * RECORD)));

/* Catmull-Rom between sections `from` and `to`; beyond the ends the curve goes on straight. */
static evaluate_tap tap_at(uint32_t sections, uint32_t points, uint32_t station)
{
    const uint32_t segments = sections - 1, way = station * segments, last = points - 1;
    uint32_t from = way / last < segments ? way / last : segments - 1;
    float t = (float)(way - from * last) / (float)last, t2 = t * t, t3 = t2 * t;
    float a = 0.5f * (-t3 + 2.0f * t2 - t), b = 0.5f * (3.0f * t3 - 5.0f * t2 + 2.0f);
    float c = 0.5f * (-3.0f * t3 + 4.0f * t2 + t), d = 0.5f * (t3 - t2);
    if (from == 0) { /* the section before: 2 b - c */
        b += 2.0f * a, c -= a, a = 0.0f;
    }
    if (from + 2 > segments) { /* the section after: 2 c - b */
        c += 2.0f * d, b -= d, d = 0.0f;
    }
    uint32_t first = from > 0 ? from - 1 : 0;
    first = first + SECTIONS <= sections ? first : sections > SECTIONS ? sections - SECTIONS : 0;
    const float weight[4] = {a, b, c, d}, blend[4] = {0.0f, 1.0f - t, t, 0.0f};
    evaluate_tap tap = {.first = first};
    for (uint32_t k = 0; k < 4; k++) { /* section from - 1 + k */
        uint32_t at = from + k - 1 - first;
        for (uint32_t i = 0; i < RECORD && at < SECTIONS; i++) {
            tap.weight[RECORD * at + i] = i < 4 ? weight[k] : blend[k];
        }
    }
    return tap;
}

void evaluate_lay_out(evaluate_table *table, arena *memory, uint32_t sections, uint32_t points)
{
    table->points = points;
    table->sections = sections;
    table->stride = (points + LANES - 1) / LANES * LANES;
    table->taps = ARENA_PUSH(memory, evaluate_tap, points);
    table->records = ARENA_PUSH(memory, float, RECORD *(size_t)(sections > SECTIONS ? sections : SECTIONS));
    table->mixed = ARENA_PUSH(memory, float, RECORD *(size_t)table->stride);
    table->column = ARENA_PUSH(memory, float, (size_t)EVALUATE_COLUMNS * table->stride);
    for (uint32_t i = 0; memory->base && table->taps && i < points; i++) {
        table->taps[i] = tap_at(sections, points, i);
    }
    for (uint32_t s = sections; memory->base && table->records && s < SECTIONS; s++) { /* of weight 0 */
        memset(table->records + RECORD * (size_t)s, 0, RECORD * sizeof *table->records);
    }
}

/* The sections' records. A quaternion and its negative are the same turn: each takes the sign that is nearer to the one
 * before it, so that the way between any two neighbours is the short one. */
static void sections_record(const evaluate_table *table, const vec3 *centres, const quat *frames)
{
    float sign = 1.0f;
    for (uint32_t s = 0; s < table->sections; s++) {
        const quat q = frames[s], before = frames[s > 0 ? s - 1 : 0];
        const float dot = (before.x * q.x + before.y * q.y) + (before.z * q.z + before.w * q.w);
        sign *= copysignf(1.0f, dot);
        /* in one piece: the mixing that follows reads whole records */
        const evaluate_record record = {centres[s].x, centres[s].y, centres[s].z, 0.0f,
                                        sign * q.x,   sign * q.y,   sign * q.z,   sign * q.w};
        memcpy(table->records + RECORD * (size_t)s, &record, sizeof record);
    }
}

/* Point and quaternion of every station, not yet of length 1. */
static void stations_mix(const evaluate_table *table)
{
    for (uint32_t i = 0; i < table->points; i++) {
        const evaluate_tap *tap = &table->taps[i];
        const float *near = table->records + RECORD * (size_t)tap->first;
        evaluate_record mixed, section, weight;
        memcpy(&section, near, sizeof section);
        memcpy(&weight, tap->weight, sizeof weight);
        mixed = section * weight;
        for (size_t k = 1; k < SECTIONS; k++) {
            memcpy(&section, near + RECORD * k, sizeof section);
            memcpy(&weight, tap->weight + RECORD * k, sizeof weight);
            mixed += section * weight;
        }
        memcpy(table->mixed + RECORD * (size_t)i, &mixed, sizeof mixed);
    }
}

/* The columns of what was mixed. */
static void stations_turn(evaluate_table *table)
{
    const uint32_t stride = table->stride;
    for (uint32_t i = 0; i < stride; i += LANES) {
        const float *record[LANES];
        lanes m[8];
        for (uint32_t k = 0; k < LANES; k++) {
            record[k] = table->mixed + RECORD * (size_t)(i + k);
        }
        lanes_turn8(record, m);
        lanes x = m[4], y = m[5], z = m[6], w = m[7];
        lanes xx = x * x, yy = y * y, zz = z * z, xy = x * y, xz = x * z, yz = y * z, wx = w * x, wy = w * y,
              wz = w * z;
        lanes s = 2.0f / ((xx + yy) + (zz + w * w));
        const lanes column[EVALUATE_COLUMNS] = {1.0f - s * (yy + zz), s * (xy + wz), s * (xz - wy), s * (xy - wz),
                                                1.0f - s * (xx + zz), s * (yz + wx), s * (xz + wy), s * (yz - wx),
                                                1.0f - s * (xx + yy), m[0],          m[1],          m[2]};
        for (uint32_t c = 0; c < EVALUATE_COLUMNS; c++) {
            lanes_store(table->column + c * stride + i, column[c]);
        }
    }
}

void evaluate_stations(evaluate_table *table, const vec3 *centres, const quat *frames)
{
    sections_record(table, centres, frames);
    stations_mix(table);
    stations_turn(table);
}

/* LANES points of one strand: their coordinates, side by side. */
static inline lanes3 points_at(const lanes column[EVALUATE_COLUMNS], const float *offsets, uint32_t points)
{
    lanes x = lanes_load(offsets), y = lanes_load(offsets + points), z = lanes_load(offsets + 2 * (size_t)points);
    return (lanes3){column[9] + (column[0] * x + column[3] * y + column[6] * z),
                    column[10] + (column[1] * x + column[4] * y + column[7] * z),
                    column[11] + (column[2] * x + column[5] * y + column[8] * z)};
}

static inline void columns_load(const evaluate_table *table, uint32_t station, lanes column[EVALUATE_COLUMNS])
{
    for (uint32_t c = 0; c < EVALUATE_COLUMNS; c++) {
        column[c] = lanes_load(table->column + c * table->stride + station);
    }
}

/* Strands of fewer points than there are lanes. */
static void evaluate_short(const evaluate_table *table, const float *offsets, uint32_t strands, float *out)
{
    const uint32_t points = table->points;
    lanes column[EVALUATE_COLUMNS];
    columns_load(table, 0, column);
    for (uint32_t s = 0; s < strands; s++, offsets += 3 * (size_t)points, out += 3 * (size_t)points) {
        float offset[3 * LANES] = {0}, point[3 * LANES];
        for (uint32_t axis = 0; axis < 3; axis++) {
            memcpy(offset + axis * LANES, offsets + axis * points, points * sizeof *offset);
        }
        lanes3_store(point, points_at(column, offset, LANES));
        memcpy(out, point, 3 * points * sizeof *point);
    }
}

void evaluate_strands(const evaluate_table *table, const float *restrict offsets, uint32_t strands, float *restrict out)
{
    const uint32_t points = table->points;
    if (points < LANES) {
        evaluate_short(table, offsets, strands, out);
        return;
    }
    for (uint32_t i = 0; i < points; i += LANES) {
        const uint32_t at = i + LANES <= points ? i : points - LANES; /* the last ones: some of them once more */
        lanes column[EVALUATE_COLUMNS];
        columns_load(table, at, column);
        for (uint32_t s = 0; s < strands; s++) {
            const size_t strand = 3 * (size_t)points * s;
            lanes3_store(out + strand + 3 * (size_t)at, points_at(column, offsets + strand + at, points));
        }
    }
}

size_t evaluate_scratch(uint32_t sections, uint32_t points)
{
    evaluate_table table;
    arena counting = arena_counting();
    evaluate_lay_out(&table, &counting, sections, points);
    return (counting.used + ARENA_ALIGNMENT) / sizeof(float) + 1;
}

void evaluate_hair(const evaluate_binding *binding, const float *centres, const float *frames, float *scratch,
                   float *points)
{
    const uint32_t sections = binding->sections;
    const size_t strand = 3 * (size_t)binding->points;
    const vec3 *centre = (const vec3 *)(const void *)centres;
    const quat *frame = (const quat *)(const void *)frames;
    arena memory = arena_over(scratch, evaluate_scratch(sections, binding->points) * sizeof(float));
    evaluate_table table;
    evaluate_lay_out(&table, &memory, sections, binding->points);
    for (uint32_t g = 0; g < binding->wisps; g++) {
        const uint32_t first = binding->strand_first[g];
        if (binding->trees && !binding->trees[binding->tree[g]]) {
            continue;
        }
        evaluate_stations(&table, centre + (size_t)g * sections, frame + (size_t)g * sections);
        evaluate_strands(&table, binding->offsets + strand * first, binding->strand_first[g + 1] - first,
                         points + strand * first);
    }
}
