"""Frames as they come, one after another."""

from __future__ import annotations

import time
from collections import deque
from typing import Callable, Deque, Generic, Iterator, Optional, TypeVar, Union

from ._library import TYPES
from ._messages import Message, put
from .connection import Connection, refusal
from .errors import PEER, TIMEOUT, AwtError

CREDIT = 8  # frames under way and not yet taken; as many as a decoder keeps for deltas

F = TypeVar("F")


class Subscription(Generic[F]):
    """Iterates the frames of a forest; waits for the next. An error of the daemon's, or no frame in time, is raised. A
    frame that cannot be read is raised too, and the next one goes on."""

    def __init__(self, connection: Connection, request: Message, read: Callable[[Message], F],
                 have: Callable[[], int]) -> None:
        """`request`: SUBSCRIBE but for its credit. `read` makes a frame of a message; `have` says which one deltas may
        build on."""
        self._connection, self._read, self._have = connection, read, have
        self._waiting: Deque[Union[F, AwtError]] = deque()
        self._lost = False  # the last frame could not be read
        request.as_.subscribe.credit = CREDIT
        self._handle = connection.call(request).as_.subscribe_reply.subscription
        self._request = request.request
        connection.listeners[self._request] = self

    def __iter__(self) -> Iterator[F]:
        return self

    def __next__(self) -> F:
        frame = self._wait()
        if frame is None:
            raise StopIteration
        if self._open:
            credit = self._connection.message("CREDIT")
            put(credit.as_.credit, subscription=self._handle, frames=1, have=0 if self._lost else self._have())
            self._connection.send(credit)
        if isinstance(frame, AwtError):
            raise frame
        return frame

    def close(self) -> None:
        """No more frames; again does no harm."""
        if self._open:
            del self._connection.listeners[self._request]
            request = self._connection.message("UNSUBSCRIBE")
            request.as_.unsubscribe.subscription = self._handle
            self._connection.send(request)
        self._waiting.clear()

    @property
    def _open(self) -> bool:
        return self._connection.listeners.get(self._request) is self

    def _wait(self) -> Optional[Union[F, AwtError]]:
        """The next frame or failure. None: there are no more."""
        deadline = time.monotonic() + self._connection.timeout_s
        while not self._waiting:
            if not self._open:
                return None
            message = self._connection.receive()
            if message.type == TYPES["ERROR"] and message.request == 0:
                raise refusal(message)
            if not self._waiting and time.monotonic() >= deadline:  # other messages came, without end
                raise AwtError(TIMEOUT, f"no frame came within {self._connection.timeout_s} s", retry=True)
        return self._waiting.popleft()

    def took(self, message: Message) -> None:
        """See Listener."""
        if len(self._waiting) >= CREDIT:
            del self._connection.listeners[self._request]
            self._waiting[-1] = AwtError(PEER, "the other end sends more frames than it has credit for")
            return
        try:
            frame: Union[F, AwtError] = self._read(message)
            self._lost = False
        except AwtError as failure:
            frame, self._lost = failure, True
        self._waiting.append(frame)

    def ended(self, failure: AwtError) -> None:
        """See Listener."""
        self._waiting.append(failure)
