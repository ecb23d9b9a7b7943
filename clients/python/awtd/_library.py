"""libawtclient by ctypes: its functions, and those of its structs that are used (awtlink.h, awtframes.h, awtclock.h)."""

import ctypes as c
import ctypes.util
import glob
import os

from ._messages import Message, PoseStruct


class Error(c.Structure):
    _fields_ = [("code", c.c_int), ("retry", c.c_bool), ("retry_after_ms", c.c_uint32), ("text", c.c_char * 256)]


SEND = c.CFUNCTYPE(c.c_long, c.c_void_p, c.c_void_p, c.c_size_t, c.POINTER(Error))
RECEIVE = c.CFUNCTYPE(c.c_long, c.c_void_p, c.c_void_p, c.c_size_t, c.POINTER(Error))
DESCRIPTOR = c.CFUNCTYPE(c.c_int, c.c_void_p)


class Transport(c.Structure):
    _fields_ = [("context", c.c_void_p), ("send", SEND), ("receive", RECEIVE), ("descriptor", DESCRIPTOR),
                ("close", c.c_void_p)]


class Options(c.Structure):
    _fields_ = [("address", c.c_char_p), ("token_file", c.c_char_p), ("token", c.c_char_p), ("name", c.c_char_p),
                ("timeout_ms", c.c_int), ("queue_bytes", c.c_uint32), ("transport", c.POINTER(Transport)),
                ("routing_key", c.c_void_p)]


class ClockSamples(c.Structure):
    _fields_ = [("offset_us", c.c_int64 * 16), ("round_us", c.c_int64 * 16), ("count", c.c_uint32)]


class Shown(c.Structure):
    _fields_ = [("way", c.c_int), ("time_us", c.c_int64), ("strand_count", c.c_uint32),
                ("points_per_strand", c.c_uint32), ("positions", c.POINTER(c.c_float)),
                ("previous", c.POINTER(c.c_float)), ("widths", c.POINTER(c.c_float)), ("head", PoseStruct),
                ("previous_head", PoseStruct), ("least", c.c_float * 3), ("greatest", c.c_float * 3)]


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
            ("awtclock_add", c.c_bool, [c.POINTER(ClockSamples), *[c.c_int64] * 4]),
            ("awtclock_offset", c.c_bool, [c.POINTER(ClockSamples), *[c.POINTER(c.c_int64)] * 2]),
            ("awtframes_create", handle, [c.c_int64]),
            ("awtframes_destroy", None, [handle]),
            ("awtframes_bind", c.c_bool, [handle, c.c_char_p, c.c_size_t, error]),
            ("awtframes_take", c.c_bool, [handle, c.c_void_p, error]),
            ("awtframes_begin", c.c_bool, [handle]),
            ("awtframes_decode", None, [handle]),
            ("awtframes_end", c.c_bool, [handle, error]),
            ("awtframes_have", c.c_uint64, [handle]),
            ("awtframes_show", c.c_bool, [handle, c.c_int64, c.POINTER(Shown)]),
            ("proto_type_name", c.c_char_p, [c.c_uint16])]:
        function = getattr(library, name)
        function.restype, function.argtypes = result, arguments
    for number in [*range(1, 0x100), *range(0x8001, 0x8100)]:
        TYPES[library.proto_type_name(number).decode()] = number
    return library
