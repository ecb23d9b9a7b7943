"""The structs of proto.h that are used, as ctypes sees them; a test compares them with the header."""

from __future__ import annotations

import ctypes as c


class Str(c.Structure):
    _fields_ = [("text", c.c_void_p), ("length", c.c_uint16)]

    def __str__(self) -> str:
        return c.string_at(self.text, self.length).decode(errors="replace") if self.length else ""


class Blob(c.Structure):
    _fields_ = [("bytes", c.c_void_p), ("length", c.c_uint32)]

    def __bytes__(self) -> bytes:
        return c.string_at(self.bytes, self.length) if self.length else b""


class PoseStruct(c.Structure):
    _fields_ = [("position", c.c_double * 3), ("orientation", c.c_double * 4)]


KINDS = {"u8": c.c_uint8, "u16": c.c_uint16, "u32": c.c_uint32, "u64": c.c_uint64, "i64": c.c_int64,
         "f32": c.c_float, "f64": c.c_double, "raw16": c.c_uint8 * 16, "raw32": c.c_uint8 * 32, "str": Str,
         "blob": Blob, "pose": PoseStruct}


def struct(name, text):
    """A struct of "kind name name ...; kind name ...", as messages.def lists its fields."""
    fields = []
    for part in text.split(";"):
        kind, *names = part.split()
        fields += [(field, KINDS[kind]) for field in names]
    return type(name, (c.Structure,), {"_fields_": fields})


def list_of(record, greatest):
    return type("List", (c.Structure,), {"_fields_": [("count", c.c_uint16), ("items", record * greatest)]})


KINDS.update(
    params=list_of(struct("Param", "str name; f32 value"), 64),
    param_infos=list_of(struct("ParamInfo", "str name unit text; f32 value least greatest"), 64),
    style_infos=list_of(struct("StyleInfo", "str name text; u8 levels; u32 finest_nodes; u16 points_per_strand"), 16),
    step_requests=list_of(struct("StepRequest", "u64 forest; i64 time_us"), 256),
    colliders=list_of(struct("Collider", "u32 id; u8 frame; f32 ax ay az radius_a bx by bz radius_b"), 16),
    collider_poses=list_of(struct("ColliderPose", "u32 id; pose pose"), 16))

STRUCTS = {
    "error": struct("ErrorMessage", "u16 code; u8 retry; u32 retry_after_ms; u16 about; str text"),
    "list_styles_reply": struct("ListStylesReply", "style_infos styles; param_infos params"),
    "upload": struct("Upload", "u32 upload; u64 total offset; raw32 sha256; blob piece"),
    "upload_reply": struct("UploadReply", "u32 upload; u64 received"),
    "create": struct("Create", "u8 source; str style; u32 upload; str name; u64 seed; u32 strands; "
                     "u16 points_per_strand; u8 levels; u16 sections; u32 finest_wisps top_wisps; f64 scale; u8 up; "
                     "f64 head_x head_y head_z head_radius; u8 own_hierarchy; u32 hierarchy; params params; "
                     "u8 own_colliders; colliders colliders; i64 time_us; pose head body; u8 progress"),
    "create_reply": struct("CreateReply", "u64 forest; raw16 drive_token view_token; u32 strands skipped_strands; "
                           "u16 points_per_strand; u8 levels; u16 sections; u32 top_wisps finest_wisps coarse_nodes "
                           "finest_nodes; f64 mass_kg longest_strand_m median_strand_m; "
                           "f32 box_min_x box_min_y box_min_z box_max_x box_max_y box_max_z"),
    "attach": struct("Attach", "u64 forest; raw16 token"),
    "attach_reply": struct("AttachReply", "u8 may_drive; i64 time_us; u32 strands; u16 points_per_strand"),
    "destroy": struct("Destroy", "u64 forest"),
    "set_params": struct("SetParams", "u64 forest; params params"),
    "motion": struct("Motion", "u64 forest; u32 epoch sequence; u8 teleport; i64 time_us; pose head body; "
                     "collider_poses colliders"),
    "set_clock": struct("SetClock", "u64 forest; u8 mode; f32 rate importance"),
    "set_clock_reply": struct("SetClockReply", "i64 time_us clock_us"),
    "step_many": struct("StepMany", "u32 deadline_us; u8 kind level attributes; step_requests forests"),
    "ping": struct("Ping", "i64 sent_us"),
    "pong": struct("Pong", "i64 sent_us received_us answered_us"),
    "query": struct("Query", "u64 forest; u8 latest; i64 time_us; u8 kind level attributes"),
    "subscribe": struct("Subscribe", "u64 forest; u8 kind level; u16 greatest_rate; u32 credit; u8 deltas; "
                        "u32 budget; u8 attributes"),
    "subscribe_reply": struct("SubscribeReply", "u64 subscription"),
    "unsubscribe": struct("Unsubscribe", "u64 subscription"),
    "credit": struct("Credit", "u64 subscription; u32 frames; u64 have"),
    "frame": struct("FrameMessage", "u64 forest; u8 kind level; u16 flags; i64 time_us; u64 sequence base; "
                    "u32 age_us skipped active_nodes splits merges steps unreached_contacts clamped_speeds "
                    "clamped_points; f32 link_error kinetic_energy_j; u32 queue_us step_us encode_us last_write_us; "
                    "blob glb"),
    "binding": struct("Binding", "u64 forest; u8 level"),
    "binding_reply": struct("BindingReply", "u64 forest; blob binding"),
    "stats_reply": struct("StatsReply", "str version; u64 uptime_us; u32 workers connections forests; "
                          "u64 frames_encoded frames_sent bytes_sent errors_sent steps step_us encode_us memory; "
                          "u32 last_write_us io_threads idle_connections"),
    "snapshot": struct("Snapshot", "u64 forest"),
    "snapshot_reply": struct("SnapshotReply", "u64 forest; i64 time_us; u64 hash; blob state"),
    "restore": struct("Restore", "u32 upload; str name"),
}


class Union(c.Union):
    _fields_ = list(STRUCTS.items()) + [("room", c.c_uint64 * 32768)]  # no message of C is larger: a test looks


class Message(c.Structure):
    """A message. What its texts and blobs point to is kept with it."""

    _fields_ = [("type", c.c_uint16), ("flags", c.c_uint16), ("request", c.c_uint64), ("as_", Union)]

    def keep(self, raw: bytes) -> int:
        """Where these bytes are, as long as the message lives."""
        memory = c.create_string_buffer(raw, max(len(raw), 1))
        self.__dict__.setdefault("_kept", []).append(memory)
        return c.addressof(memory)

    def text(self, text: str) -> Str:
        """A field's value."""
        raw = text.encode()
        if len(raw) > 0xffff:
            raise ValueError("a name is too long")
        return Str(self.keep(raw), len(raw))

    def put_params(self, into: c.Structure, params: dict) -> None:
        """Names and values into a list of params."""
        if len(params) > len(into.items):
            raise ValueError(f"more than {len(into.items)} parameters")
        for item, (name, value) in zip(into.items, params.items()):
            item.name, item.value = self.text(name), value
        into.count = len(params)


def put(into: c.Structure, **values: int) -> None:
    """Numbers into fields. ctypes cuts off what does not fit; here that is an error."""
    for name, value in values.items():
        setattr(into, name, value)
        if getattr(into, name) != value:
            raise ValueError(f"{name} cannot be {value}")
