"""One head of hair in the daemon."""

from __future__ import annotations

import time
from types import MappingProxyType
from typing import Callable, Literal, Mapping, Optional, Union, overload

import numpy as np

from ._messages import Message, put
from .clock import MODES, Clock, Mode
from .colliders import put_collider_poses
from .connection import Connection
from .decoder import Decoder
from .forms import KINDS, LEVELS, Hair, Kind, Level, number
from .frame import Frame, Nodes
from .poses import Pose
from .subscription import Subscription

_NOWHERE: Mapping[int, Pose] = MappingProxyType({})


class Forest:
    """One head of hair. handle and tokens are for attach(); strands, points_per_strand: the shape of its frames. box:
    (2, 3) float32, metres, head frame: the least and the greatest position that frames hold; None of an attached one.
    clock: how its time goes, as set_clock() gave it here; None: it was not set here.

    Frames are of a kind: "strands", or "ribbon" (the same hair, as a file that any glTF viewer draws), or "guides" (a
    tenth of the bytes, of which the strands are made here, to some tenths of a millimetre), or "nodes", the wisp tree
    itself. And strands and ribbons of a level: "full", or "fifth" or "guides" with fewer and wider strands."""

    def __init__(self, connection: Connection, handle: int, strands: int, points_per_strand: int, drive_token: bytes,
                 view_token: bytes, box: Optional[np.ndarray] = None) -> None:
        self._connection = connection
        self.handle, self.strands, self.points_per_strand = handle, strands, points_per_strand
        self.drive_token, self.view_token, self.box = drive_token, view_token, box
        self.clock: Optional[Clock] = None
        self._epoch = int(time.time())  # greater than that of whoever drove it before
        self._sequence = 0
        self._binding: Optional[bytes] = None

    @overload
    def drive(self, time_us: int, head: Pose = ..., body: Pose = ..., *, kind: Hair = ..., level: Level = ...,
              attributes: bool = ..., teleport: bool = ..., colliders: Mapping[int, Pose] = ...) -> Frame: ...

    @overload
    def drive(self, time_us: int, head: Pose = ..., body: Pose = ..., *, kind: Literal["nodes"], teleport: bool = ...,
              colliders: Mapping[int, Pose] = ...) -> Nodes: ...

    def drive(self, time_us: int, head: Pose = Pose(), body: Pose = Pose(), *, kind: Kind = "strands",
              level: Level = "full", attributes: bool = False, teleport: bool = False,
              colliders: Mapping[int, Pose] = _NOWHERE) -> Union[Frame, Nodes]:
        """Moves head and body (world frame) to where they are at simulated time `time_us`, later than the last, and
        gives the hair of then. attributes: the vertices of its glb have more than their positions (PROTOCOL.md).
        teleport and colliders: see move(). In lock-step only, which is how every forest begins."""
        query = self._form("QUERY", kind, level, attributes)
        put(query.as_.query, time_us=time_us)
        read = self._reader(kind)
        self.move(head, body, time_us=time_us, teleport=teleport, colliders=colliders)
        return read(self._connection.call(query))

    def move(self, head: Pose = Pose(), body: Pose = Pose(), *, time_us: Optional[int] = None, teleport: bool = False,
             colliders: Mapping[int, Pose] = _NOWHERE) -> None:
        """Says where head and body (world frame) are at simulated time `time_us`, later than the last, and goes on
        without an answer: None is now_us(), of a free-running forest; in lock-step the hair follows with the next
        drive() or Client.step_many() that passes that time. teleport: a cut, the hair is carried along rigidly.
        colliders: poses (world frame) of obstacles with frames of their own by their ids (create()); one left out stays
        where it is. A pose that the daemon refuses fails the next call that is answered."""
        if time_us is None:
            time_us = self.now_us()
        motion = self._connection.message("MOTION")
        m = motion.as_.motion
        put(m, forest=self.handle, epoch=self._epoch, sequence=self._sequence + 1, time_us=time_us,
            teleport=int(teleport))
        m.head, m.body = head._struct(), body._struct()
        put_collider_poses(motion, colliders)
        self._connection.send(motion)
        self._sequence += 1

    def set_clock(self, mode: Mode, *, rate: float = 1, importance: float = 0) -> Clock:
        """How the forest's time goes: "lockstep", drive() brings it from time to time; "free", with the daemon's clock,
        at `rate` simulated seconds a second (0.01 to 10): move() moves the head, latest() and subscribe() show the hair
        of the present; "paused": not at all. importance (0.001 to 1000, at first 1; 0: as it is): whose hair is thinned
        out last when the daemon has too much to do."""
        request = self._connection.message("SET_CLOCK")
        wish = request.as_.set_clock
        put(wish, forest=self.handle, mode=number(MODES, mode))
        wish.rate, wish.importance = rate, importance
        reply = self._connection.call(request).as_.set_clock_reply
        self.clock = Clock(mode, rate, reply.time_us, reply.clock_us)
        return self.clock

    def now_us(self) -> int:
        """What simulated time it is, of a free-running forest; ValueError where set_clock() has not made it one. Asks
        the daemon for its clock at first, and every few seconds."""
        clock = self.clock
        if clock is None or clock.mode != "free":
            raise ValueError('the forest\'s time does not go by itself: set_clock("free") first, or say time_us')
        return clock.time_us + int((self._connection.clock.now_us() - clock.clock_us) * clock.rate)

    @overload
    def latest(self, *, kind: Hair = ..., level: Level = ..., attributes: bool = ...) -> Frame: ...

    @overload
    def latest(self, *, kind: Literal["nodes"]) -> Nodes: ...

    def latest(self, *, kind: Kind = "strands", level: Level = "full",
               attributes: bool = False) -> Union[Frame, Nodes]:
        """The hair as it stands, without a step; of a free-running forest, that of the present. For those who may only
        look, too."""
        query = self._form("QUERY", kind, level, attributes)
        query.as_.query.latest = 1
        read = self._reader(kind)
        return read(self._connection.call(query))

    @overload
    def subscribe(self, *, kind: Hair = ..., level: Level = ..., deltas: bool = ..., rate: int = ..., budget: int = ...,
                  attributes: bool = ...) -> Subscription[Frame]: ...

    @overload
    def subscribe(self, *, kind: Literal["nodes"], rate: int = ...) -> Subscription[Nodes]: ...

    def subscribe(self, *, kind: Kind = "strands", level: Level = "full", deltas: bool = False, rate: int = 0,
                  budget: int = 0, attributes: bool = False) -> Union[Subscription[Frame], Subscription[Nodes]]:
        """Every new frame from now on, whoever drives: iterate over what this gives. deltas: strands and guides come as
        what changed, a fraction of the bytes; the arrays are the same. rate: frames a second at most, 0: all. budget:
        bytes of a frame that the daemon tries to keep within by coarser levels, 0: none."""
        request = self._form("SUBSCRIBE", kind, level, attributes)
        put(request.as_.subscribe, greatest_rate=rate, budget=budget, deltas=int(deltas))
        if kind == "nodes":
            return Subscription(self._connection, request, Nodes, lambda: 0)
        decoder = self._decoder(kind)
        return Subscription(self._connection, request, lambda message: Frame(message, kind, decoder, deltas),
                            lambda: decoder.have)

    def set_params(self, **params: float) -> None:
        """Changes parameters from the next step on: all, or none where one is refused."""
        request = self._connection.message("SET_PARAMS")
        request.as_.set_params.forest = self.handle
        request.put_params(request.as_.set_params.params, params)
        self._connection.call(request)

    def snapshot(self) -> bytes:
        """The forest as it stands, groom and parameters included; Client.restore() makes another of it that goes on to
        the bit as this one does."""
        request = self._connection.message("SNAPSHOT")
        request.as_.snapshot.forest = self.handle
        return bytes(self._connection.call(request).as_.snapshot_reply.state)

    def close(self) -> None:
        """Ends the forest in the daemon."""
        request = self._connection.message("DESTROY")
        request.as_.destroy.forest = self.handle
        self._connection.call(request)

    def _form(self, name: str, kind: Kind, level: Level, attributes: bool) -> Message:
        """A QUERY or SUBSCRIBE of such frames."""
        request = self._connection.message(name)
        put(getattr(request.as_, name.lower()), forest=self.handle, kind=number(KINDS, kind),
            level=number(LEVELS, level), attributes=int(attributes))
        return request

    def _reader(self, kind: Kind) -> Callable[[Message], Union[Frame, Nodes]]:
        """What makes a frame of a FRAME that stands for itself."""
        if kind == "nodes":
            return Nodes
        decoder = self._decoder(kind)
        return lambda message: Frame(message, kind, decoder)

    def _decoder(self, kind: Kind) -> Decoder:
        """A new one. What guides are evaluated with is asked for once."""
        if kind == "guides" and self._binding is None:
            request = self._connection.message("BINDING")
            request.as_.binding.forest = self.handle
            self._binding = bytes(self._connection.call(request).as_.binding_reply.binding)
        return Decoder(self._connection.library, self._binding if kind == "guides" else None)
