"""libawtclient by ctypes: its functions, and those of its structs that are used (proto.h, awtlink.h, awtframes.h)."""

import ctypes as c
import ctypes.util
import glob
import os


class Error(c.Structure):
    _fields_ = [("code", c.c_int), ("retry", c.c_bool), ("retry_after_ms", c.c_uint32), ("text", c.c_char * 256)]


class Options(c.Structure):
    _fields_ = [("address", c.c_char_p), ("token_file", c.c_char_p), ("token", c.c_char_p), ("name", c.c_char_p),
                ("timeout_ms", c.c_int), ("queue_bytes", c.c_uint32), ("transport", c.c_void_p),
                ("routing_key", c.c_void_p)]


class Str(c.Structure):
    _fields_ = [("text", c.c_void_p), ("length", c.c_uint16)]


class Blob(c.Structure):
    _fields_ = [("bytes", c.c_void_p), ("length", c.c_uint32)]


class PoseStruct(c.Structure):
    _fields_ = [("position", c.c_double * 3), ("orientation", c.c_double * 4)]


class Shown(c.Structure):
    _fields_ = [("way", c.c_int), ("time_us", c.c_int64), ("strand_count", c.c_uint32),
                ("points_per_strand", c.c_uint32), ("positions", c.POINTER(c.c_float)),
                ("previous", c.POINTER(c.c_float)), ("widths", c.POINTER(c.c_float)), ("head", PoseStruct),
                ("previous_head", PoseStruct), ("least", c.c_float * 3), ("greatest", c.c_float * 3)]


KINDS = {"u8": c.c_uint8, "u16": c.c_uint16, "u32": c.c_uint32, "u64": c.c_uint64, "i64": c.c_int64,
         "f32": c.c_float, "f64": c.c_double, "raw16": c.c_uint8 * 16, "str": Str, "blob": Blob, "pose": PoseStruct}


def struct(name, text):
    """A struct of "kind name name ...; kind name ...", as messages.def lists its fields."""
    fields = []
    for part in text.split(";"):
        kind, *names = part.split()
        fields += [(field, KINDS[kind]) for field in names]
    return type(name, (c.Structure,), {"_fields_": fields})


def list_of(record, greatest):
    return type("List", (c.Structure,), {"_fields_": [("count", c.c_uint16), ("items", record * greatest)]})


Param = struct("Param", "str name; f32 value")
Collider = struct("Collider", "u32 id; u8 frame; f32 ax ay az radius_a bx by bz radius_b")
ColliderPose = struct("ColliderPose", "u32 id; pose pose")
KINDS.update(params=list_of(Param, 64), colliders=list_of(Collider, 16), collider_poses=list_of(ColliderPose, 16))

STRUCTS = {
    "error": struct("ErrorMessage", "u16 code; u8 retry; u32 retry_after_ms; u16 about; str text"),
    "create": struct("Create", "u8 source; str style; u32 upload; str name; u64 seed; u32 strands; "
                     "u16 points_per_strand; u8 levels; u16 sections; u32 finest_wisps top_wisps; f64 scale; u8 up; "
                     "f64 head_x head_y head_z head_radius; u8 own_hierarchy; u32 hierarchy; params params; "
                     "u8 own_colliders; colliders colliders; i64 time_us; pose head body; u8 progress"),
    "create_reply": struct("CreateReply", "u64 forest; raw16 drive_token view_token; u32 strands skipped_strands; "
                           "u16 points_per_strand"),
    "attach": struct("Attach", "u64 forest; raw16 token"),
    "attach_reply": struct("AttachReply", "u8 may_drive; i64 time_us; u32 strands; u16 points_per_strand"),
    "destroy": struct("Destroy", "u64 forest"),
    "set_params": struct("SetParams", "u64 forest; params params"),
    "motion": struct("Motion", "u64 forest; u32 epoch sequence; u8 teleport; i64 time_us; pose head body; "
                     "collider_poses colliders"),
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
}


class Union(c.Union):
    _fields_ = list(STRUCTS.items()) + [("room", c.c_uint64 * 32768)]  # no message of C is larger: a test looks


class Message(c.Structure):
    _fields_ = [("type", c.c_uint16), ("flags", c.c_uint16), ("request", c.c_uint64), ("as_", Union)]


# Message numbers, filled from proto_type_name: the library is the one list.
TYPES: dict = {}


def find():
    """$AWTD_LIBRARY; what was built in the checkout that this file is in; the system's."""
    named = os.environ.get("AWTD_LIBRARY")
    if named:
        return named
    top = os.path.dirname(os.path.abspath(__file__))
    built = sorted(glob.glob(os.path.join(top, "..", "..", "..", "build", "release", "lib", "libawtclient.so.*")))
    found = built[-1] if built else ctypes.util.find_library("awtclient")
    if not found:
        raise OSError("libawtclient is not here: `make libraries` or `make install` in awtd's checkout, or name the "
                      "file in $AWTD_LIBRARY")
    return found


def load():
    """The library, with the types of the functions used."""
    library = c.CDLL(find())
    handle, error, message = c.c_void_p, c.POINTER(Error), c.POINTER(Message)
    for name, result, arguments in [
            ("awtclient_open", handle, [c.POINTER(Options), error]),
            ("awtclient_close", None, [handle]),
            ("awtclient_send", c.c_bool, [handle, message, error]),
            ("awtclient_receive", c.c_bool, [handle, message, error]),
            ("awtframes_create", handle, [c.c_int64]),
            ("awtframes_destroy", None, [handle]),
            ("awtframes_take", c.c_bool, [handle, c.c_void_p, error]),
            ("awtframes_begin", c.c_bool, [handle]),
            ("awtframes_decode", None, [handle]),
            ("awtframes_end", c.c_bool, [handle, error]),
            ("awtframes_show", c.c_bool, [handle, c.c_int64, c.POINTER(Shown)]),
            ("proto_type_name", c.c_char_p, [c.c_uint16])]:
        function = getattr(library, name)
        function.restype, function.argtypes = result, arguments
    for number in [*range(1, 0x100), *range(0x8001, 0x8100)]:
        TYPES[library.proto_type_name(number).decode()] = number
    return library
