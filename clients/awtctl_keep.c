/* awtctl_keep.c: what awtctl play keeps of each frame: its figures, its file, and what decoding it says. */
#include "awtctl_play.h"

#include "files.h"

void play_frame_path(const play_record *record, size_t frame, char *path, size_t size)
{
    snprintf(path, size, "%s/frame_%06zu.glb", record->plan->out, frame + 1);
}

void play_keep_figures(play_frame *f, const struct proto_frame *from)
{
    f->time_us = from->time_us;
    f->active_nodes = from->active_nodes;
    f->splits = from->splits;
    f->merges = from->merges;
    f->steps = from->steps;
    f->queue_us = from->queue_us;
    f->step_us = from->step_us;
    f->encode_us = from->encode_us;
    f->unreached_contacts = from->unreached_contacts;
    f->clamped_points = from->clamped_points;
    f->clamped_speeds = from->clamped_speeds;
    f->link_error = from->link_error;
    f->kinetic_energy_j = from->kinetic_energy_j;
    f->bytes = from->glb.length;
    f->delta = from->base != 0;
}

static bool measure(play_record *record, play_stream *stream, const struct proto_frame *from, char *why, size_t size)
{
    awt_error error;
    const geom_strands *strands = NULL;
    awt_status status = play_stream_read(stream, from, &strands, &error);
    if (status == AWT_OK && strands) {
        status = strandcheck_add(&record->strands, strands, &error);
    }
    if (status != AWT_OK) {
        snprintf(why, size, "%s", error.text);
    }
    return status == AWT_OK;
}

bool play_keep_geometry(play_record *record, play_stream *stream, size_t frame, const struct proto_frame *from,
                        bool write, char *why, size_t size)
{
    char path[4200];
    const bool read = write || record->plan->check || frame == 0 || record->plan->deltas;
    if (read && !measure(record, stream, from, why, size)) {
        return false;
    }
    if (!write) {
        return true;
    }
    play_frame_path(record, frame, path, sizeof path);
    record->frames[frame].written = files_write(path, from->glb.bytes, from->glb.length, why, size);
    return record->frames[frame].written;
}
