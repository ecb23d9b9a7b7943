"""A client of awtd, and how to get one."""

from __future__ import annotations

import contextlib
import os
import ssl as _ssl
from typing import Callable, Optional, Sequence, Tuple, Union

import numpy as np

from ._messages import Message, put
from .colliders import Collider, put_colliders
from .connection import Connection
from .errors import AwtError
from .forest import Forest
from .forms import Kind, Level, number
from .poses import Pose
from .records import Param, Stats, Style, record
from .stepping import Stepped, step_many
from .tls import TlsTransport

_UPS = (None, "y", "z")


class Client:
    """A connection to awtd; `with` closes it. Made by connect()."""

    def __init__(self, connection: Connection) -> None:
        self._connection = connection
        self._uploads = 0

    def __enter__(self) -> "Client":
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Ends the connection; again does no harm."""
        self._connection.close()

    def create(self, style: Optional[str] = None, strands: int = 0, *, upload: Optional[int] = None,
               hierarchy: Optional[int] = None, seed: int = 1, name: str = "", points_per_strand: int = 0,
               levels: int = 0, scale: float = 0, up: Optional[str] = None,
               head_centre: Tuple[float, float, float] = (0, 0, 0), head_radius: float = 0, time_us: int = 0,
               head: Pose = Pose(), body: Pose = Pose(), colliders: Optional[Sequence[Collider]] = None,
               **params: float) -> Forest:
        """Makes hair of a built-in style (see styles()), or of an upload(), with what of params() is to be otherwise.

        Of a style: strands, 0: the style's number; seed: other seeds, other hair. Of an upload: hierarchy, the upload
        of a wisp hierarchy; scale, metres per unit of the file, up, "y" or "z", and the head's centre (3) and radius in
        units of the file: what is left out is guessed. Of both: points_per_strand and levels of the wisp hierarchy, 0:
        the style's or file's; name, for the log; time_us, head and body (world frame), when and where it is at rest;
        colliders, the obstacles, None: a head and a body."""
        if (style is None) == (upload is None):
            raise ValueError("a style or an upload is wanted, not both")
        request = self._connection.message("CREATE")
        create = request.as_.create
        create.style, create.name = request.text(style or ""), request.text(name)
        put(create, source=int(upload is not None), upload=upload or 0, own_hierarchy=int(hierarchy is not None),
            hierarchy=hierarchy or 0, seed=seed, strands=strands, points_per_strand=points_per_strand, levels=levels,
            scale=scale, up=number(_UPS, up), head_radius=head_radius, time_us=time_us, progress=1)
        create.head_x, create.head_y, create.head_z = head_centre
        create.head, create.body = head._struct(), body._struct()
        if colliders is not None:
            put_colliders(request, colliders)
        request.put_params(create.params, params)
        return self._made(request)

    def attach(self, handle: int, token: bytes) -> Forest:
        """Opens a forest made on another connection: its `handle`, and its `drive_token` or `view_token`."""
        request = self._connection.message("ATTACH")
        put(request.as_.attach, forest=handle)
        request.as_.attach.token[:] = token
        reply = self._connection.call(request).as_.attach_reply
        drive, view = (token, b"") if reply.may_drive else (b"", token)
        return Forest(self._connection, handle, reply.strands, reply.points_per_strand, drive, view)

    def step_many(self, times: Sequence[Tuple[Forest, int]], *, deadline_us: int = 1_000_000, kind: Kind = "strands",
                  level: Level = "full", attributes: bool = False) -> Stepped:
        """Brings each forest, all in lock-step, to its simulated time: move() their heads first. What is not ready
        deadline_us from now comes as it was, stale, and its step goes on. The daemon's workers share the work."""
        return step_many(self._connection, times, deadline_us, kind, level, attributes)

    def upload(self, path: Union[str, os.PathLike], progress: Optional[Callable[[float], None]] = None) -> int:
        """Sends a strand file (cyHair .hair, TressFX .tfx) or a hierarchy; what it gives is for create(). The daemon
        keeps a few at a time: forget() those that are done with. progress hears the share that is there, 0 to 1."""
        with open(path, "rb") as file:
            return self._upload(file.read(), progress)

    def forget(self, upload: int) -> None:
        """The daemon need not keep the upload any more; the hair made of it stays."""
        self._connection.forget_upload(upload)

    def restore(self, snapshot: bytes, name: str = "") -> Forest:
        """Makes a forest of what Forest.snapshot() gave, here or elsewhere, at the simulated time of then."""
        request = self._connection.message("RESTORE")
        request.as_.restore.name = request.text(name)
        request.as_.restore.upload = upload = self._upload(snapshot)
        try:
            return self._made(request)
        finally:
            with contextlib.suppress(AwtError):  # the connection has ended, and the upload with it
                self.forget(upload)

    def stats(self) -> Stats:
        """How the daemon is."""
        return record(Stats, self._connection.call(self._connection.message("STATS")).as_.stats_reply)

    def styles(self) -> Tuple[Style, ...]:
        """The built-in styles."""
        styles = self._lists().styles
        return tuple(record(Style, style) for style in styles.items[:styles.count])

    def params(self) -> Tuple[Param, ...]:
        """The parameters of create() and set_params()."""
        params = self._lists().params
        return tuple(record(Param, param) for param in params.items[:params.count])

    def _lists(self):
        return self._connection.call(self._connection.message("LIST_STYLES")).as_.list_styles_reply

    def _upload(self, content: bytes, progress: Optional[Callable[[float], None]] = None) -> int:
        self._uploads += 1
        self._connection.upload(self._uploads, content, progress)
        return self._uploads

    def _made(self, request: Message) -> Forest:
        """The forest that a CREATE or RESTORE makes."""
        reply = self._connection.call(request).as_.create_reply
        box = np.array([reply.box_min_x, reply.box_min_y, reply.box_min_z,
                        reply.box_max_x, reply.box_max_y, reply.box_max_z], np.float32).reshape(2, 3)
        return Forest(self._connection, reply.forest, reply.strands, reply.points_per_strand,
                      bytes(reply.drive_token), bytes(reply.view_token), box)


def connect(address: str = "127.0.0.1:4680", token_file: Optional[str] = None, timeout_s: float = 30, *,
            ssl: Optional[_ssl.SSLContext] = None, server_hostname: Optional[str] = None) -> Client:
    """Connects to the awtd at "HOST:PORT". token_file None: where a daemon on this machine keeps it. timeout_s: of
    connecting and of each answer. ssl: the connection is under TLS, for a daemon behind a TLS terminator;
    ssl.create_default_context() checks its certificate, for the name server_hostname, None: the address's host.
    AwtError says what went wrong; its __cause__ is the exception of the ssl module, where that was the reason."""
    if ssl is None and server_hostname is not None:
        raise ValueError("server_hostname is of no use without ssl")
    transport = TlsTransport(address, ssl, server_hostname, timeout_s) if ssl is not None else None
    return Client(Connection(address, token_file, timeout_s, transport))
