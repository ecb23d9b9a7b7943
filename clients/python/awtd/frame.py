"""What frames hold."""

from __future__ import annotations

import os
import tempfile

import numpy as np

from . import nodes
from ._messages import Message
from .decoder import Decoder
from .errors import PEER, AwtError
from .forms import KINDS, LEVELS

_STALE = 1  # of FRAME's flags
_COUNTED = ("time_us", "sequence", "base", "age_us", "skipped", "active_nodes", "splits", "merges", "steps",
            "unreached_contacts", "clamped_speeds", "link_error", "kinetic_energy_j", "queue_us", "step_us",
            "encode_us", "last_write_us")


class FrameBase:
    """What frames of all kinds have.

    kind and level: what it shows, by name. time_us: simulated time. sequence: its number among the forest's frames.
    glb: the file's bytes; base not 0: it is a delta against the frame of that sequence. stale: it is older than was
    asked for, or than it should be. age_us: between the end of its step and its writing. skipped: frames that found no
    credit before it.

    What the daemon counted in this advance: active_nodes, splits and merges of the wisp trees, steps (sub-steps),
    unreached_contacts (nodes that their link kept inside an obstacle), clamped_speeds (nodes at the speed limit),
    link_error (the greatest |length / target - 1| of the links), kinetic_energy_j (joules, relative to the head). And
    where the time went, microseconds: queue_us (it waited for a worker), step_us, encode_us (of work), last_write_us
    (from the first byte to the last of the frame before it on this connection; 0: none).
    """

    kind: str
    level: str
    time_us: int
    sequence: int
    base: int
    stale: bool
    age_us: int
    skipped: int
    active_nodes: int
    splits: int
    merges: int
    steps: int
    unreached_contacts: int
    clamped_speeds: int
    link_error: float
    kinetic_energy_j: float
    queue_us: int
    step_us: int
    encode_us: int
    last_write_us: int
    glb: bytes

    def __init__(self, message: Message, kind: str, numbers: bool = False) -> None:
        """`numbers`: glb may be of a form that does not stand for itself."""
        frame = message.as_.frame
        if frame.kind != KINDS.index(kind) or frame.level >= len(LEVELS):
            raise AwtError(PEER, "the other end sent a frame of another kind than was asked for")
        self.kind, self.level = kind, LEVELS[frame.level]
        for name in _COUNTED:
            setattr(self, name, getattr(frame, name))
        self.stale = bool(frame.flags & _STALE)
        self.glb = bytes(frame.glb)
        self._alone = not numbers and self.base == 0

    def save(self, path: str) -> None:
        """Writes the frame as a GLB file, whole or not at all. ValueError where it does not stand for itself: a delta,
        or guides of a stream of deltas."""
        if not self._alone:
            raise ValueError("a frame of a stream of deltas is no file for others")
        handle, other = tempfile.mkstemp(dir=os.path.dirname(os.path.abspath(path)))
        try:
            with os.fdopen(handle, "wb") as file:
                file.write(self.glb)
                file.flush()
                os.fsync(file.fileno())
            os.replace(other, path)
        except BaseException:
            os.unlink(other)
            raise


class Frame(FrameBase):
    """Hair of one instant: what FrameBase says, and

    positions: (strands, points, 3) float32, metres, head frame. widths: (points,) float32, metres, root to tip.
    head: its Pose.
    """

    positions: np.ndarray
    widths: np.ndarray

    def __init__(self, message: Message, kind: str, decoder: Decoder, deltas: bool = False) -> None:
        super().__init__(message, kind, numbers=deltas and kind == "guides")
        self.positions, self.widths, self.head = decoder.decode(message)


class Nodes(FrameBase):
    """The active nodes of the wisp trees at one instant: what FrameBase says, and

    positions: (nodes, 3) float32, metres, head frame. radii: (nodes,) float32, metres, of the wisp there.
    parents: (nodes,) uint32, numbers of nodes; of a root its own. levels: (nodes,) uint8, 0 coarsest, at most 3.
    head: its Pose.
    """

    positions: np.ndarray
    radii: np.ndarray
    parents: np.ndarray
    levels: np.ndarray

    def __init__(self, message: Message) -> None:
        super().__init__(message, "nodes")
        self.head, records = nodes.read(self.glb)
        self.positions, self.radii = records["position"].copy(), records["radius"].copy()
        self.parents, self.levels = records["parent"].astype(np.uint32), records["level"].copy()
