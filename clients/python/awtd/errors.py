"""What goes wrong, as one exception."""

from __future__ import annotations

# Codes of the client's own, as in awtlink.h; positive ones are the daemon's.
ADDRESS, TOKEN, CLOSED, TIMEOUT, PEER = -1, -2, -3, -4, -5


class AwtError(Exception):
    """What went wrong. `code`: the daemon's error number, or a negative one of awtlink.h; `text`: for people;
    `retry`: trying again may help."""

    def __init__(self, code: int, text: str, retry: bool = False) -> None:
        super().__init__(f"{text} ({code})")
        self.code, self.text, self.retry = code, text, retry
