"""Frames of nodes, which are plain glTF (GEOMETRY.md, Nodes), to arrays."""

from __future__ import annotations

import json
import struct
from typing import Tuple

import numpy as np

from .errors import PEER, AwtError
from .poses import Pose

_RECORD = np.dtype({"names": ["position", "radius", "parent", "level"], "formats": ["3<f4", "<f4", "<f4", "u1"],
                    "offsets": [0, 12, 16, 20], "itemsize": 24})


def _chunks(glb: bytes) -> Tuple[dict, bytes]:
    """The JSON and the binary chunk of a GLB file."""
    magic, version, length, size, kind = struct.unpack_from("<4sIII4s", glb)
    if (magic, version, length, kind) != (b"glTF", 2, len(glb), b"JSON"):
        raise ValueError("no GLB")
    binary_size, binary_kind = struct.unpack_from("<I4s", glb, 20 + size)
    binary = glb[28 + size:]
    if binary_kind != b"BIN\0" or binary_size != len(binary):
        raise ValueError("no binary chunk")
    return json.loads(glb[20:20 + size]), binary


def _records(document: dict, binary: bytes) -> np.ndarray:
    node = document["nodes"][0]
    view = document["bufferViews"][0]
    count, offset = int(node["extras"]["nodes"]), int(view.get("byteOffset", 0))
    if node["extras"]["kind"] != "nodes" or count < 1 or offset < 0 or view["byteStride"] != _RECORD.itemsize:
        raise ValueError("no nodes")
    records = np.frombuffer(binary, _RECORD, count, offset)
    parents = records["parent"]
    if not (np.isfinite(records["position"]).all() and np.isfinite(records["radius"]).all()):
        raise ValueError("not finite")
    if not ((parents >= 0) & (parents <= np.arange(count)) & (parents == np.floor(parents))).all():
        raise ValueError("parents that cannot be")
    if (records["level"] > 3).any():
        raise ValueError("levels that cannot be")
    return records


def read(glb: bytes) -> Tuple[Pose, np.ndarray]:
    """The head's pose, and a record (position, radius, parent, level) of each node. AwtError: it is damaged."""
    try:
        document, binary = _chunks(glb)
        records = _records(document, binary)
        node = document["nodes"][0]
        place, turn = node.get("translation", (0, 0, 0)), node.get("rotation", (0, 0, 0, 1))
        head = Pose(tuple(float(x) for x in place), tuple(float(x) for x in turn))
        if len(head.position) != 3 or len(head.orientation) != 4:
            raise ValueError("no pose")
    except (ValueError, TypeError, KeyError, IndexError, AttributeError, OverflowError, RecursionError,
            struct.error) as error:
        raise AwtError(PEER, f"a frame of nodes cannot be read: {error}") from error
    return head, records
