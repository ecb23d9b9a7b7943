/* read.c: a frame back to strands: container and JSON (glb.h), then each patch's Draco data: what our own encoder wrote
 * by our own reader (draco_read.h), anything else by libdraco (draco_shim.h). */
#include "geom/read.h"

#include "base/error.h"
#include "geom/draco_shim.h"
#include "geom/lines.h"

awt_status geom_read_frame(const void *bytes, size_t size, geom_strands *out, awt_error *error)
{
    glb_frame frame;
    awt_status status = glb_read(bytes, size, &frame, error);
    if (status == AWT_OK && frame.kind == GEOM_GUIDES) {
        status = error_set(error, AWT_BAD_VALUE, "this frame holds guides, which only their binding makes strands of");
    } else if (status == AWT_OK) {
        status = lines_read(&frame, draco_shim_decode, out, error);
    }
    glb_frame_fini(&frame);
    return status;
}
