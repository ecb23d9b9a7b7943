/* awtctl_inspect.c: what is in a frame's file. */
#include "awtctl.h"

#include "base/vec.h"
#include "files.h"
#include "geom/read.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* Bounds of the centre lines. */
typedef struct inspect_box {
    double low[3], high[3];
} inspect_box;

typedef struct inspect_report {
    const char *path;
    size_t bytes;
    geom_strands strands;
    inspect_box head, world; /* in the head frame; with the head's pose applied */
} inspect_report;

static void box_add(inspect_box *box, dvec3 p)
{
    double at[3] = {p.x, p.y, p.z};
    for (int k = 0; k < 3; k++) {
        box->low[k] = fmin(box->low[k], at[k]);
        box->high[k] = fmax(box->high[k], at[k]);
    }
}

static void report_boxes(inspect_report *report)
{
    const geom_strands *s = &report->strands;
    const double *p = s->head.position, *q = s->head.orientation;
    dquat turn = {q[0], q[1], q[2], q[3]};
    report->head = report->world = (inspect_box){{HUGE_VAL, HUGE_VAL, HUGE_VAL}, {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL}};
    for (size_t i = 0; i < (size_t)s->strand_count * s->points_per_strand; i++) {
        dvec3 point = {(double)s->positions[3 * i], (double)s->positions[3 * i + 1], (double)s->positions[3 * i + 2]};
        box_add(&report->head, point);
        box_add(&report->world, dvec3_add((dvec3){p[0], p[1], p[2]}, dquat_rotate(turn, point)));
    }
}

static void print_box(const char *name, const inspect_box *box)
{
    printf("%-22s %.4f %.4f %.4f to %.4f %.4f %.4f m\n", name, box->low[0], box->low[1], box->low[2], box->high[0],
           box->high[1], box->high[2]);
}

static void report_print(const inspect_report *report)
{
    const geom_strands *s = &report->strands;
    const double *p = s->head.position, *q = s->head.orientation;
    printf("%-22s %s, %zu bytes\n", "file", report->path, report->bytes);
    printf("%-22s %u, of %u points each\n", "strands", s->strand_count, s->points_per_strand);
    printf("%-22s %u, with %u triangles\n", "patches", s->patch_count, s->triangle_count);
    print_box("box in the head frame", &report->head);
    print_box("box in the world", &report->world);
    printf("%-22s at %.4f %.4f %.4f m, turned by %.5f %.5f %.5f %.5f (x y z w)\n", "head", p[0], p[1], p[2], q[0], q[1],
           q[2], q[3]);
    printf("%-22s %.6f s\n", "time", (double)s->time_us * 1e-6);
}

static void json_box(jsonout *json, const char *key, const inspect_box *box)
{
    jsonout_object(json, key);
    jsonout_reals(json, "min", box->low, 3);
    jsonout_reals(json, "max", box->high, 3);
    jsonout_close(json);
}

static void report_json(jsonout *json, const void *context)
{
    const inspect_report *report = context;
    const geom_strands *s = &report->strands;
    jsonout_object(json, NULL);
    jsonout_text(json, "file", report->path);
    jsonout_unsigned(json, "bytes", report->bytes);
    jsonout_unsigned(json, "strands", s->strand_count);
    jsonout_unsigned(json, "points_per_strand", s->points_per_strand);
    jsonout_unsigned(json, "patches", s->patch_count);
    jsonout_unsigned(json, "triangles", s->triangle_count);
    json_box(json, "box_head", &report->head);
    json_box(json, "box_world", &report->world);
    jsonout_object(json, "head");
    jsonout_reals(json, "position", s->head.position, 3);
    jsonout_reals(json, "orientation", s->head.orientation, 4);
    jsonout_close(json);
    jsonout_real(json, "time_s", (double)s->time_us * 1e-6);
    jsonout_close(json);
}

awtctl_exit awtctl_inspect(int argc, char *const *argv)
{
    const char *json_path = NULL, *path = NULL;
    size_t paths = 0;
    const option options[] = {
        {"json", OPTION_OPTIONAL_TEXT, "FILE", &json_path, 0, 0, "JSON instead, to FILE or stdout"}};
    const option_program program = {"awtctl inspect", "Says what is in a GLB file that awtd made.", "FILE.glb", options,
                                    sizeof options / sizeof options[0]};
    awtctl_exit code;
    if (!awtctl_options(&program, argc, argv, &path, 1, &paths, &code)) {
        return code;
    }
    if (paths != 1) {
        return awtctl_wrong_usage(&program, "a GLB file is wanted");
    }
    char text[512];
    awt_error error;
    inspect_report report = {.path = path};
    unsigned char *bytes = files_read(path, GEOM_MAX_GLB, &report.bytes, text, sizeof text);
    if (!bytes) {
        return awtctl_failed("%s", text);
    }
    awt_status status = geom_read_frame(bytes, report.bytes, &report.strands, &error);
    free(bytes);
    if (status != AWT_OK) {
        return awtctl_failed("%s: %s", path, error.text);
    }
    report_boxes(&report);
    bool written = true;
    if (json_path) {
        written = awtctl_write_json(json_path, report_json, &report);
    } else {
        report_print(&report);
    }
    geom_strands_fini(&report.strands);
    return written ? AWTCTL_FINE : AWTCTL_FAILED;
}
