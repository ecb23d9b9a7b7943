"""Frames of hair to arrays, by the library's own reader (awtframes.h)."""

from __future__ import annotations

import ctypes
from typing import Optional, Tuple

import numpy as np

from . import _library as _l
from ._messages import Message
from .connection import raised
from .poses import Pose


class Decoder:
    """The frames of one stream, of which those that deltas build on are kept."""

    def __init__(self, library: ctypes.CDLL, binding: Optional[bytes] = None) -> None:
        """binding: what guides are evaluated with."""
        self._library = library
        self._frames = library.awtframes_create(0)
        error = _l.Error()
        if not self._frames:
            raise MemoryError("a frame")
        if binding is not None and not library.awtframes_bind(self._frames, binding, len(binding), error):
            raise raised(error)

    def __del__(self) -> None:
        if self._frames:
            self._library.awtframes_destroy(self._frames)

    @property
    def have(self) -> int:
        """The sequence of the newest frame decoded; 0: none."""
        return self._library.awtframes_have(self._frames)

    def decode(self, message: Message) -> Tuple[np.ndarray, np.ndarray, Pose]:
        """Of a FRAME: positions (strands, points, 3), widths (points,), float32, metres, and the head's pose."""
        library, frames, frame = self._library, self._frames, message.as_.frame
        error, shown = _l.Error(), _l.Shown()
        fine = library.awtframes_take(frames, ctypes.addressof(frame), error) and library.awtframes_begin(frames)
        if fine:
            library.awtframes_decode(frames)
            fine = library.awtframes_end(frames, error)
        if not fine:
            raise raised(error)
        if not library.awtframes_show(frames, frame.time_us, shown):
            raise MemoryError("a frame")
        shape = (shown.strand_count, shown.points_per_strand, 3)
        return (np.ctypeslib.as_array(shown.positions, shape).copy(),
                np.ctypeslib.as_array(shown.widths, shape[1:2]).copy(),
                Pose(tuple(shown.head.position), tuple(shown.head.orientation)))
