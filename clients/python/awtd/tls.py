"""TLS under the protocol: a transport of libawtclient (awtlink.h) made of Python's ssl module.

The TCP connection is made here; the handshake of TLS runs in the library's own loop, under its deadline."""

from __future__ import annotations

import ctypes
import socket
import ssl
from typing import Any, Callable, Optional, Tuple

from . import _library as _l
from .errors import ADDRESS, CLOSED, PEER, AwtError

_WANT_READ, _WANT_WRITE, _FAILED = -1, -2, -3  # awtlink_answer
_PIECE = 1 << 16  # of one call; a record of TLS is shorter


def _split(address: str) -> Tuple[str, int]:
    """"HOST:PORT", the host in brackets where it is IPv6, none: localhost."""
    host, _, port = address.rpartition(":")
    if not port.isdecimal() or int(port) > 65535:
        raise AwtError(ADDRESS, f'"{address}" is not an address: HOST:PORT is wanted')
    return host.strip("[]") or "localhost", int(port)


class TlsTransport:
    """One connection under TLS. Whoever opens a client on it keeps it as long as that lives, then closes it."""

    def __init__(self, address: str, context: ssl.SSLContext, server_hostname: Optional[str],
                 timeout_s: float) -> None:
        host, port = _split(address)
        try:
            plain = socket.create_connection((host, port), timeout_s)
        except OSError as error:
            raise AwtError(ADDRESS, f"nobody answers at {address}: {error}", retry=True) from error
        try:
            plain.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            plain.setblocking(False)
            self._socket = context.wrap_socket(plain, server_hostname=server_hostname or host,
                                               do_handshake_on_connect=False)
        except BaseException:
            plain.close()
            raise
        self._greeted = False
        self.failure: Optional[BaseException] = None  # what ended it
        self.struct = _l.Transport(send=_l.SEND(self._send), receive=_l.RECEIVE(self._receive),
                                   descriptor=_l.DESCRIPTOR(lambda _: self._socket.fileno()))

    def close(self) -> None:
        """Says that nothing more comes, if that goes out at once, and closes."""
        try:
            self._socket.unwrap()
        except (OSError, ValueError):
            pass
        self._socket.close()

    def _send(self, _: Any, place: int, size: int, error: Any) -> int:
        return self._attempt(lambda: self._socket.send(ctypes.string_at(place, min(size, _PIECE))), error)

    def _receive(self, _: Any, place: int, size: int, error: Any) -> int:
        def take() -> int:
            piece = self._socket.recv(min(size, _PIECE))
            ctypes.memmove(place, piece, len(piece))
            return len(piece)

        return self._attempt(take, error)

    def _attempt(self, action: Callable[[], int], error: Any) -> int:
        """What the action answers, as the library wants it. An exception cannot pass through C: it is kept."""
        try:
            if self.failure:  # the first reason is the one to tell
                raise self.failure
            if not self._greeted:
                self._socket.do_handshake()
                self._greeted = True
            return action()
        except ssl.SSLWantReadError:
            return _WANT_READ
        except ssl.SSLWantWriteError:
            return _WANT_WRITE
        except BaseException as failure:
            self.failure = failure
            if error:
                error[0].code = PEER if isinstance(failure, ssl.SSLError) else CLOSED
                error[0].text = f"TLS: {failure}".encode()[:255]
            return _FAILED
