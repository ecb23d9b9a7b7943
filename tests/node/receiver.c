/* receiver.c: geom/receive.h for a host that is not C: numbers and addresses only. suite.sh runs it as WebAssembly. */
#include "geom/receive.h"

#if defined(_WIN32)
#define EXPORT __declspec(dllexport)
#else
#define EXPORT __attribute__((visibility("default")))
#endif

static geom_strands strands; /* of the last frame */
static geom_guides kept;      /* the last frame of receiver_numbers, the base of the next one */
static geom_delta_reader *reader;
static awt_error error;

EXPORT geom_binding *receiver_binding(const void *bytes, size_t size);
EXPORT bool receiver_frame(const geom_binding *binding, const void *bytes, size_t size);
EXPORT bool receiver_numbers(const geom_binding *binding, const void *bytes, size_t size, uint32_t base_sequence);
EXPORT const float *receiver_positions(void);
EXPORT uint32_t receiver_strands(void);
EXPORT uint32_t receiver_points(void);
EXPORT const char *receiver_error(void);

/* NULL: receiver_error says why. Kept until the program ends. */
geom_binding *receiver_binding(const void *bytes, size_t size)
{
    geom_binding *binding;
    geom_binding_read(bytes, size, &binding, &error);
    return binding;
}

/* False: receiver_error says why. */
bool receiver_frame(const geom_binding *binding, const void *bytes, size_t size)
{
    geom_strands_fini(&strands);
    return geom_receive_frame(binding, bytes, size, &strands, &error) == AWT_OK;
}

/* A frame of guides as numbers, whole or against the one that came this way before, which its sender called
 * `base_sequence`. False: receiver_error says why. */
bool receiver_numbers(const geom_binding *binding, const void *bytes, size_t size, uint32_t base_sequence)
{
    geom_guides next = {0};
    if (!reader && geom_delta_reader_create(&reader, &error) != AWT_OK) {
        return false;
    }
    if (geom_read_guides_delta(reader, binding, bytes, size, &kept, base_sequence, &next, &error) != AWT_OK) {
        return false;
    }
    geom_guides_fini(&kept);
    kept = next;
    return geom_guides_strands(binding, &kept, &strands, &error) == AWT_OK;
}

/* [receiver_strands][receiver_points][3], of the last frame. */
const float *receiver_positions(void)
{
    return strands.positions;
}

uint32_t receiver_strands(void)
{
    return strands.strand_count;
}

uint32_t receiver_points(void)
{
    return strands.points_per_strand;
}

const char *receiver_error(void)
{
    return error.text;
}
