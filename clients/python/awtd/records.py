"""What a daemon says of itself."""

from __future__ import annotations

import ctypes
from typing import NamedTuple

from ._messages import Str


class Style(NamedTuple):
    """A built-in style. text: one line about it. levels: of the wisp hierarchy; finest_nodes: of its finest level."""

    name: str
    text: str
    levels: int
    finest_nodes: int
    points_per_strand: int


class Param(NamedTuple):
    """A parameter of create() and set_params(). value: its default; it may be from least to greatest."""

    name: str
    unit: str
    text: str
    value: float
    least: float
    greatest: float


class Stats(NamedTuple):
    """Counts and times of a daemon since its start. step_us: spent in steps (sub-steps); encode_us: spent encoding;
    memory: bytes held by forests and grooms; last_write_us: from the first byte to the last of the latest frame on this
    connection, 0: none; io_threads: that serve busy connections; workers: threads that simulate. connections, forests,
    idle_connections: now."""

    version: str
    uptime_us: int
    workers: int
    connections: int
    forests: int
    frames_encoded: int
    frames_sent: int
    bytes_sent: int
    errors_sent: int
    steps: int
    step_us: int
    encode_us: int
    memory: int
    last_write_us: int
    io_threads: int
    idle_connections: int


def record(kind: type, struct: ctypes.Structure) -> NamedTuple:
    """A record from the struct's fields of the same names."""
    values = (getattr(struct, name) for name in kind._fields)
    return kind(*(str(value) if isinstance(value, Str) else value for value in values))
