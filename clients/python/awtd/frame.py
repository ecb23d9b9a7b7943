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

_COUNTED = ("time_us", "sequence", "base", "active_nodes", "splits", "merges", "step_us", "encode_us",
            "kinetic_energy_j", "age_us", "skipped")


class FrameBase:
    """What frames of all kinds have.

    kind and level: what it shows, by name. time_us: simulated time. sequence: its number among the forest's frames.
    glb: the file's bytes; base not 0: it is a delta against the frame of that sequence. age_us: between the end of its
    step and its writing. skipped: frames that found no credit before it. And what the daemon counted in this advance:
    active_nodes, splits, merges, step_us and encode_us (microseconds of work), kinetic_energy_j (joules).
    """

    kind: str
    level: str
    time_us: int
    sequence: int
    base: int
    active_nodes: int
    splits: int
    merges: int
    step_us: int
    encode_us: int
    kinetic_energy_j: float
    age_us: int
    skipped: int
    glb: bytes

    def __init__(self, message: Message, kind: str, numbers: bool = False) -> None:
        """`numbers`: glb may be of a form that does not stand for itself."""
        frame = message.as_.frame
        if frame.kind != KINDS.index(kind) or frame.level >= len(LEVELS):
            raise AwtError(PEER, "the other end sent a frame of another kind than was asked for")
        self.kind, self.level = kind, LEVELS[frame.level]
        for name in _COUNTED:
            setattr(self, name, getattr(frame, name))
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
