"""One head of hair in the daemon."""

from __future__ import annotations

import time
from typing import Literal, Optional, Union, overload

import numpy as np

from ._messages import Message, put
from .connection import Connection
from .decoder import Decoder
from .forms import KINDS, LEVELS, Hair, Kind, Level, number
from .frame import Frame, Nodes
from .poses import Pose
from .subscription import Subscription


class Forest:
    """One head of hair. handle and tokens are for attach(); strands, points_per_strand: the shape of its frames. box:
    (2, 3) float32, metres, head frame: the least and the greatest position that frames hold; None of an attached one.

    Frames are of a kind: "strands", or "ribbon" (the same hair, as a file that any glTF viewer draws), or "guides" (a
    tenth of the bytes, of which the strands are made here, to some tenths of a millimetre), or "nodes", the wisp tree
    itself. And strands and ribbons of a level: "full", or "fifth" or "guides" with fewer and wider strands."""

    def __init__(self, connection: Connection, handle: int, strands: int, points_per_strand: int, drive_token: bytes,
                 view_token: bytes, box: Optional[np.ndarray] = None) -> None:
        self._connection = connection
        self.handle, self.strands, self.points_per_strand = handle, strands, points_per_strand
        self.drive_token, self.view_token, self.box = drive_token, view_token, box
        self._epoch = int(time.time())  # greater than that of whoever drove it before
        self._sequence = 0
        self._binding: Optional[bytes] = None

    @overload
    def drive(self, time_us: int, head: Pose = ..., body: Pose = ..., *, kind: Hair = ..., level: Level = ...,
              attributes: bool = ...) -> Frame: ...

    @overload
    def drive(self, time_us: int, head: Pose = ..., body: Pose = ..., *, kind: Literal["nodes"]) -> Nodes: ...

    def drive(self, time_us: int, head: Pose = Pose(), body: Pose = Pose(), *, kind: Kind = "strands",
              level: Level = "full", attributes: bool = False) -> Union[Frame, Nodes]:
        """Moves head and body (world frame) to where they are at simulated time `time_us`, later than the last, and
        gives the hair of then. attributes: the vertices of its glb have more than their positions (PROTOCOL.md)."""
        query = self._form("QUERY", kind, level, attributes)
        put(query.as_.query, time_us=time_us)
        self._sequence += 1
        motion = self._connection.message("MOTION")
        m = motion.as_.motion
        put(m, forest=self.handle, epoch=self._epoch, sequence=self._sequence, time_us=time_us)
        m.head, m.body = head._struct(), body._struct()
        self._connection.send(motion)
        return self._ask(query, kind)

    @overload
    def latest(self, *, kind: Hair = ..., level: Level = ..., attributes: bool = ...) -> Frame: ...

    @overload
    def latest(self, *, kind: Literal["nodes"]) -> Nodes: ...

    def latest(self, *, kind: Kind = "strands", level: Level = "full",
               attributes: bool = False) -> Union[Frame, Nodes]:
        """The hair as it stands, without a step. For those who may only look, too."""
        query = self._form("QUERY", kind, level, attributes)
        query.as_.query.latest = 1
        return self._ask(query, kind)

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

    def _ask(self, query: Message, kind: Kind) -> Union[Frame, Nodes]:
        if kind == "nodes":
            return Nodes(self._connection.call(query))
        decoder = self._decoder(kind)
        return Frame(self._connection.call(query), kind, decoder)

    def _decoder(self, kind: Kind) -> Decoder:
        """A new one. What guides are evaluated with is asked for once."""
        if kind == "guides" and self._binding is None:
            request = self._connection.message("BINDING")
            request.as_.binding.forest = self.handle
            self._binding = bytes(self._connection.call(request).as_.binding_reply.binding)
        return Decoder(self._connection.library, self._binding if kind == "guides" else None)
