"""The forms that frames come in, by name."""

from __future__ import annotations

from typing import Literal, Optional

Hair = Literal["ribbon", "strands", "guides"]
Kind = Literal["ribbon", "strands", "guides", "nodes"]
Level = Literal["full", "fifth", "guides"]

KINDS = ("ribbon", "strands", "guides", "nodes")
LEVELS = ("full", "fifth", "guides")


def number(names: tuple, name: Optional[str]) -> int:
    """What the protocol writes for a name."""
    if name not in names:
        raise ValueError(f"{name!r} is none of {names}")
    return names.index(name)
