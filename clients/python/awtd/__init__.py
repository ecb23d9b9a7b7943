"""Hair simulated by awtd, as NumPy arrays.

    with awtd.connect() as client:
        forest = client.create("long", strands=2000)
        frame = forest.drive(16667, awtd.Pose((0, 0.01, 0)))
        frame.positions        # (strands, points, 3) float32, metres, head frame

Lengths are metres, times microseconds of simulated time, orientations quaternions x y z w. One thread at a time may use a
client, its forests and its subscriptions. Calls wait for the daemon, at most the timeout.
"""

from __future__ import annotations

import ctypes
import os
import tempfile
import time
from collections import deque
from typing import Iterator, NamedTuple, Optional, Tuple

import numpy as np

from . import _library as _l

__all__ = ["AwtError", "Client", "Forest", "Frame", "Pose", "Subscription", "connect"]

_STRANDS = 1
_CREDIT = 8


class AwtError(Exception):
    """What went wrong. `code`: the daemon's error number, or a negative one of awtlink.h; `text`: for people;
    `retry`: trying again may help."""

    def __init__(self, code: int, text: str, retry: bool = False) -> None:
        super().__init__(f"{text} ({code})")
        self.code, self.text, self.retry = code, text, retry


class Pose(NamedTuple):
    """A place (3), metres, and an orientation (4), unit quaternion x y z w."""

    position: Tuple[float, float, float] = (0.0, 0.0, 0.0)
    orientation: Tuple[float, float, float, float] = (0.0, 0.0, 0.0, 1.0)

    def _struct(self) -> _l.PoseStruct:
        return _l.PoseStruct(tuple(self.position), tuple(self.orientation))


class Frame:
    """Hair of one instant.

    positions: (strands, points, 3) float32, metres, head frame. widths: (points,) float32, metres, root to tip.
    head: its Pose. time_us: simulated time. glb: the file's bytes. And what the daemon counted in this advance:
    active_nodes, splits, merges, step_us and encode_us (microseconds of work), kinetic_energy_j (joules).
    """

    def __init__(self, library: ctypes.CDLL, message: "_l.Message") -> None:
        frame = message.as_.frame
        for name in ("time_us", "sequence", "active_nodes", "splits", "merges", "step_us", "encode_us",
                     "kinetic_energy_j", "age_us", "skipped"):
            setattr(self, name, getattr(frame, name))
        self.glb: bytes = ctypes.string_at(frame.glb.bytes, frame.glb.length)
        self._decode(library, frame)

    def _decode(self, library: ctypes.CDLL, frame: ctypes.Structure) -> None:
        error, shown = _l.Error(), _l.Shown()
        frames = library.awtframes_create(0)
        if not frames:
            raise MemoryError("a frame")
        try:
            fine = library.awtframes_take(frames, ctypes.addressof(frame), error) and library.awtframes_begin(frames)
            if fine:
                library.awtframes_decode(frames)
                fine = library.awtframes_end(frames, error)
            if not fine:
                raise _error(error)
            if not library.awtframes_show(frames, self.time_us, shown):
                raise MemoryError("a frame")
            shape = (shown.strand_count, shown.points_per_strand, 3)
            self.positions: np.ndarray = np.ctypeslib.as_array(shown.positions, shape).copy()
            self.widths: np.ndarray = np.ctypeslib.as_array(shown.widths, shape[1:2]).copy()
            self.head = Pose(tuple(shown.head.position), tuple(shown.head.orientation))
        finally:
            library.awtframes_destroy(frames)

    def save(self, path: str) -> None:
        """Writes the frame as a GLB file, whole or not at all."""
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


def _error(error: "_l.Error") -> AwtError:
    return AwtError(error.code, error.text.decode(errors="replace"), error.retry)


def _text(struct: ctypes.Structure, name: str, text: str) -> None:
    """Puts a text into a message, which keeps its memory."""
    raw = text.encode()
    if len(raw) > 0xffff:
        raise ValueError("a name is too long")
    memory = ctypes.create_string_buffer(raw)
    setattr(struct, name, _l.Str(ctypes.addressof(memory), len(raw)))
    struct._kept = memory


class Client:
    """A connection to awtd; `with` closes it. Made by connect()."""

    def __init__(self, address: str, token_file: Optional[str], timeout_s: float) -> None:
        error = _l.Error()
        self._client = None
        self._library = _l.load()
        options = _l.Options(address=address.encode(), token_file=os.fsencode(token_file) if token_file else None,
                             name=b"python", timeout_ms=int(timeout_s * 1000))
        self._client = self._library.awtclient_open(options, error)
        if not self._client:
            raise _error(error)
        self._subscriptions: dict = {}

    def __enter__(self) -> "Client":
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __del__(self) -> None:
        self.close()

    def close(self) -> None:
        """Ends the connection; again does no harm."""
        client, self._client = self._client, None
        if client:
            self._library.awtclient_close(client)

    def create(self, style: str, strands: int = 0, *, seed: int = 1, time_us: int = 0, head: Pose = Pose(),
               body: Pose = Pose(), **params: float) -> "Forest":
        """Makes hair of a built-in style (`awtctl styles` lists them, and `params`). strands 0: the style's number."""
        request = self._message("create")
        create = request.as_.create
        names = self._params(create.params, params)
        _text(create, "style", style)
        create.seed, create.strands, create.time_us = seed, strands, time_us
        create.head, create.body, create.progress = head._struct(), body._struct(), 1
        answer = self._call(request)
        del names
        reply = answer.as_.create_reply
        return Forest(self, reply.forest, reply.strands, reply.points_per_strand, bytes(reply.drive_token),
                      bytes(reply.view_token))

    def attach(self, handle: int, token: bytes) -> "Forest":
        """Opens a forest made on another connection: its `handle`, and its `drive_token` or `view_token`."""
        request = self._message("attach")
        request.as_.attach.forest = handle
        request.as_.attach.token = (ctypes.c_uint8 * 16)(*token)
        reply = self._call(request).as_.attach_reply
        drive, view = (token, b"") if reply.may_drive else (b"", token)
        return Forest(self, handle, reply.strands, reply.points_per_strand, drive, view)

    def _message(self, name: str) -> "_l.Message":
        return _l.Message(type=_l.TYPES[name.upper()])

    def _params(self, into: ctypes.Structure, params: dict) -> list:
        if len(params) > 64:
            raise ValueError("more than 64 parameters")
        kept = []
        for i, (name, value) in enumerate(params.items()):
            into.items[i].value = value
            memory = ctypes.create_string_buffer(name.encode())
            into.items[i].name = _l.Str(ctypes.addressof(memory), len(name.encode()))
            kept.append(memory)
        into.count = len(params)
        return kept

    def _open(self) -> int:
        if not self._client:
            raise AwtError(-3, "the client is closed")
        return self._client

    def _send(self, message: "_l.Message") -> None:
        error = _l.Error()
        if not self._library.awtclient_send(self._open(), message, error):
            raise _error(error)

    def _receive(self) -> Tuple["_l.Message", Optional[AwtError]]:
        """The next message. Frames of subscriptions are put where these take them from."""
        message, error = _l.Message(), _l.Error()
        if not self._library.awtclient_receive(self._open(), message, error):
            raise _error(error)
        failure = None
        if message.type == _l.TYPES["ERROR"]:
            e = message.as_.error
            text = ctypes.string_at(e.text.text, e.text.length).decode(errors="replace") if e.text.length else ""
            failure = AwtError(e.code, text, bool(e.retry))
        waiting = self._subscriptions.get(message.request)
        if waiting is not None and message.type == _l.TYPES["FRAME"]:
            waiting.append(Frame(self._library, message))
        elif waiting is not None and failure:
            waiting.append(failure)
        return message, failure

    def _call(self, request: "_l.Message") -> "_l.Message":
        self._send(request)
        while True:
            answer, failure = self._receive()
            if failure and answer.request in (request.request, 0):
                raise failure
            if answer.request == request.request and answer.type != _l.TYPES["PROGRESS"]:
                return answer


class Forest:
    """One head of hair. handle and tokens are for attach(); strands, points_per_strand: the shape of its frames."""

    def __init__(self, client: Client, handle: int, strands: int, points_per_strand: int, drive_token: bytes,
                 view_token: bytes) -> None:
        self.client, self.handle, self.strands, self.points_per_strand = client, handle, strands, points_per_strand
        self.drive_token, self.view_token = drive_token, view_token
        self._epoch = int(time.time())  # greater than that of whoever drove it before
        self._sequence = 0

    def drive(self, time_us: int, head: Pose = Pose(), body: Pose = Pose()) -> Frame:
        """Moves head and body (world frame) to where they are at simulated time `time_us`, later than the last, and
        gives the hair of then."""
        self._sequence += 1
        motion = self.client._message("motion")
        m = motion.as_.motion
        m.forest, m.epoch, m.sequence, m.time_us = self.handle, self._epoch, self._sequence, time_us
        m.head, m.body = head._struct(), body._struct()
        self.client._send(motion)
        query = self.client._message("query")
        q = query.as_.query
        q.forest, q.time_us, q.kind = self.handle, time_us, _STRANDS
        return Frame(self.client._library, self.client._call(query))

    def set_params(self, **params: float) -> None:
        """Changes parameters from the next step on: all, or none where one is refused."""
        request = self.client._message("set_params")
        request.as_.set_params.forest = self.handle
        names = self.client._params(request.as_.set_params.params, params)
        self.client._call(request)
        del names

    def subscribe(self) -> "Subscription":
        """Every new frame from now on, whoever drives: iterate over what this gives."""
        return Subscription(self)

    def close(self) -> None:
        """Ends the forest in the daemon."""
        request = self.client._message("destroy")
        request.as_.destroy.forest = self.handle
        self.client._call(request)


class Subscription:
    """Iterates the frames of a forest; waits for the next. An error of the daemon's, or no frame in time, is raised."""

    def __init__(self, forest: Forest) -> None:
        self._client, self._waiting = forest.client, deque()
        request = self._client._message("subscribe")
        s = request.as_.subscribe
        s.forest, s.kind, s.credit = forest.handle, _STRANDS, _CREDIT
        self._handle = self._client._call(request).as_.subscribe_reply.subscription
        self._request = request.request
        self._client._subscriptions[self._request] = self._waiting

    def __iter__(self) -> Iterator[Frame]:
        return self

    def __next__(self) -> Frame:
        if self._request not in self._client._subscriptions:
            raise StopIteration
        while not self._waiting:
            _, failure = self._client._receive()
            if failure and not self._waiting:
                raise failure
        frame = self._waiting.popleft()
        if isinstance(frame, AwtError):
            raise frame
        credit = self._client._message("credit")
        credit.as_.credit.subscription, credit.as_.credit.frames = self._handle, 1
        self._client._send(credit)
        return frame

    def close(self) -> None:
        """No more frames; again does no harm."""
        if self._client._subscriptions.pop(self._request, None) is not None:
            request = self._client._message("unsubscribe")
            request.as_.unsubscribe.subscription = self._handle
            self._client._send(request)


def connect(address: str = "127.0.0.1:4680", token_file: Optional[str] = None, timeout_s: float = 30) -> Client:
    """Connects to the awtd at "HOST:PORT". token_file None: where a daemon on this machine keeps it. timeout_s: of
    connecting and of each answer. AwtError says what went wrong."""
    return Client(address, token_file, timeout_s)
