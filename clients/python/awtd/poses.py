"""Where a head, or a body, is."""

from __future__ import annotations

from typing import NamedTuple, Tuple

from ._messages import PoseStruct


class Pose(NamedTuple):
    """A place (3), metres, and an orientation (4), unit quaternion x y z w."""

    position: Tuple[float, float, float] = (0.0, 0.0, 0.0)
    orientation: Tuple[float, float, float, float] = (0.0, 0.0, 0.0, 1.0)

    def _struct(self) -> PoseStruct:
        return PoseStruct(tuple(self.position), tuple(self.orientation))
