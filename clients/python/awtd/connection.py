"""A connection to awtd: messages out and in, answers to their requests, frames to their subscriptions."""

from __future__ import annotations

import ctypes
import hashlib
import os
from typing import Callable, Dict, Iterator, Optional, Protocol, Tuple, Union

from . import _library as _l
from ._messages import Message, put
from .clock import DaemonClock
from .errors import CLOSED, PEER, AwtError
from .tls import TlsTransport

_PIECE = 1 << 20  # bytes of an upload in one message
_BAD_UPLOAD = 206  # errors.def
# Where the answer is not named as its request and _REPLY.
_ANSWERS = {"QUERY": "FRAME", "STEP_MANY": "FRAME", "RESTORE": "CREATE_REPLY", "PING": "PONG"}


class Listener(Protocol):
    """Who has asked for messages without end."""

    def took(self, message: Message) -> None:
        """A FRAME came. Its bytes are good until this returns."""

    def ended(self, failure: AwtError) -> None:
        """An ERROR came: no more frames."""


def raised(error: _l.Error) -> AwtError:
    """The library's error as an exception."""
    return AwtError(error.code, error.text.decode(errors="replace"), error.retry)


class Connection:
    """One connection, open from the beginning. One thread at a time."""

    def __init__(self, address: str, token_file: Optional[str], timeout_s: float,
                 transport: Optional[TlsTransport]) -> None:
        self._client, self._transport = None, transport
        self.timeout_s = timeout_s
        self.library = _l.load()
        self.clock = DaemonClock(self.library, self._ping)
        self.listeners: Dict[int, Listener] = {}  # by the request that they made
        error = _l.Error()
        options = _l.Options(address=address.encode(), token_file=os.fsencode(token_file) if token_file else None,
                             name=b"python", timeout_ms=max(1, int(timeout_s * 1000)))
        if transport:
            options.transport = ctypes.pointer(transport.struct)
        self._client = self.library.awtclient_open(options, error)
        if not self._client:
            self.close()
            raise self._failure(error)

    def __del__(self) -> None:
        self.close()

    def close(self) -> None:
        """Ends the connection; again does no harm."""
        client, self._client = self._client, None
        if client:
            self.library.awtclient_close(client)
        if self._transport:
            self._transport.close()

    def message(self, name: str) -> Message:
        """An empty message, to be filled."""
        return Message(type=_l.TYPES[name])

    def send(self, message: Message) -> None:
        """Sends it. One that is answered has its request number then."""
        error = _l.Error()
        if not self.library.awtclient_send(self._open(), message, error):
            raise self._failure(error)

    def receive(self) -> Message:
        """The next message. Those of listeners have been given to them."""
        message, error = Message(), _l.Error()
        if not self.library.awtclient_receive(self._open(), message, error):
            raise self._failure(error)
        listener = self.listeners.get(message.request)
        if listener and message.type == _l.TYPES["FRAME"]:
            listener.took(message)
        elif listener and message.type == _l.TYPES["ERROR"]:
            del self.listeners[message.request]
            listener.ended(refusal(message))
        return message

    def call(self, request: Message) -> Message:
        """Sends a request and gives its answer. Texts and blobs in it are good until the next message."""
        answer = next(self.answers(request))
        if isinstance(answer, AwtError):
            raise answer
        return answer

    def answers(self, request: Message) -> Iterator[Union[Message, AwtError]]:
        """Sends a request and gives its answers, without end; what each holds is good until the next."""
        name = self.library.proto_type_name(request.type).decode()
        wanted = _ANSWERS.get(name, name + "_REPLY")
        self.send(request)
        while True:
            answer = self.receive()
            if answer.type == _l.TYPES["ERROR"] and answer.request == 0:
                raise refusal(answer)
            if answer.request != request.request or answer.type == _l.TYPES["PROGRESS"]:
                continue
            if answer.type == _l.TYPES["ERROR"]:
                yield refusal(answer)
            elif answer.type == _l.TYPES[wanted]:
                yield answer
            else:
                raise AwtError(PEER, f"the other end answered {name} with something else than {wanted}")

    # The library's awtclient_upload leaves out the frames that come meanwhile; here they go to their subscriptions.
    def upload(self, number: int, content: bytes, heard: Optional[Callable[[float], None]] = None) -> None:
        """Sends a file in pieces. `heard` is told the share that is there, 0 to 1."""
        if not content:
            raise AwtError(_BAD_UPLOAD, "the file is empty")
        digest = hashlib.sha256(content).digest()
        for offset in range(0, len(content), _PIECE):
            piece = content[offset:offset + _PIECE]
            received = self._upload_piece(number, len(content), offset, digest, piece)
            if received != offset + len(piece):
                raise AwtError(PEER, "the daemon has lost a piece of the file")
            if heard:
                heard(received / len(content))

    def forget_upload(self, number: int) -> None:
        """The daemon need not keep it any more."""
        self._upload_piece(number, 0, 0, bytes(32), b"")

    def _upload_piece(self, number: int, total: int, offset: int, digest: bytes, piece: bytes) -> int:
        request = self.message("UPLOAD")
        upload = request.as_.upload
        put(upload, upload=number, total=total, offset=offset)
        upload.sha256[:] = digest
        upload.piece.bytes, upload.piece.length = request.keep(piece), len(piece)
        return self.call(request).as_.upload_reply.received

    def _ping(self, sent_us: int) -> Tuple[int, int]:
        request = self.message("PING")
        request.as_.ping.sent_us = sent_us
        pong = self.call(request).as_.pong
        return pong.received_us, pong.answered_us

    def _open(self) -> int:
        if not self._client:
            raise AwtError(CLOSED, "the client is closed")
        return self._client

    def _failure(self, error: _l.Error) -> BaseException:
        """Why the library failed; under TLS with the exception that was the reason."""
        reason = self._transport.failure if self._transport else None
        if reason is not None and not isinstance(reason, Exception):
            return reason  # an interrupt, for example
        failure = raised(error)
        failure.__cause__ = reason
        return failure


def refusal(message: Message) -> AwtError:
    """What an ERROR says."""
    error = message.as_.error
    return AwtError(error.code, str(error.text), bool(error.retry))
