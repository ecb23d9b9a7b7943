"""How simulated time goes, and what time it is with the daemon."""

from __future__ import annotations

import ctypes
import time
from typing import Callable, Literal, NamedTuple, Tuple

from ._library import ClockSamples
from .errors import PEER, AwtError

Mode = Literal["lockstep", "free", "paused"]

MODES = ("lockstep", "free", "paused")  # by their numbers in SET_CLOCK

_FIRST = 4  # exchanges before the first answer
_OLD_US = 5_000_000  # two clocks that part by 50 millionths are 0.25 ms off after so long


class Clock(NamedTuple):
    """How a forest's time goes. It was simulated time time_us when the daemon's own clock was clock_us, and goes on by
    rate simulated seconds a second where mode is "free"; in "lockstep" a driver takes it from time to time, "paused" it
    stands still."""

    mode: Mode
    rate: float
    time_us: int
    clock_us: int


class DaemonClock:
    """The daemon's monotonic clock, by PING and PONG (awtclock.h)."""

    def __init__(self, library: ctypes.CDLL, ping: Callable[[int], Tuple[int, int]]) -> None:
        """`ping` sends our time and gives the daemon's two: of PING's arrival and of PONG's leaving."""
        self._library, self._ping = library, ping
        self._samples = ClockSamples()
        self._asked_us = 0

    def now_us(self) -> int:
        """What it says now. Asks the daemon the first time, and again where that was some seconds ago."""
        while self._samples.count < _FIRST or _now_us() - self._asked_us > _OLD_US:
            self._ask()
        offset, uncertainty = ctypes.c_int64(), ctypes.c_int64()
        self._library.awtclock_offset(self._samples, offset, uncertainty)
        return _now_us() + offset.value

    def _ask(self) -> None:
        sent_us = _now_us()
        received_us, answered_us = self._ping(sent_us)
        self._asked_us = _now_us()
        if not self._library.awtclock_add(self._samples, sent_us, received_us, answered_us, self._asked_us):
            raise AwtError(PEER, "the other end's clock says what cannot be")


def _now_us() -> int:
    return time.monotonic_ns() // 1000
