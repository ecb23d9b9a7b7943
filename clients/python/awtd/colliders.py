"""Obstacles of the hair."""

from __future__ import annotations

from typing import Literal, Mapping, NamedTuple, Optional, Sequence, Tuple

from ._messages import Message, put
from .forms import number
from .poses import Pose

Vector = Tuple[float, float, float]
FRAMES = ("head", "body", "own")  # by their numbers on the wire


class Collider(NamedTuple):
    """A sphere, or with a second centre b a capsule that tapers from radius_a to radius_b (None: as radius_a). Metres,
    in the frame that it moves with: the head's, the body's, or its own, of which the poses are given as it moves. id:
    your number for it."""

    id: int
    a: Vector
    radius_a: float
    b: Optional[Vector] = None
    radius_b: Optional[float] = None
    frame: Literal["head", "body", "own"] = "own"


def put_colliders(create: Message, colliders: Sequence[Collider]) -> None:
    """The obstacles of a CREATE, instead of the default head and body."""
    into = create.as_.create
    into.own_colliders = 1
    for item, collider in zip(_room(into.colliders, len(colliders)), colliders):
        end = collider.a if collider.b is None else collider.b
        put(item, id=collider.id, frame=number(FRAMES, collider.frame))
        item.ax, item.ay, item.az = collider.a
        item.bx, item.by, item.bz = end
        item.radius_a = collider.radius_a
        item.radius_b = collider.radius_a if collider.radius_b is None else collider.radius_b


def put_collider_poses(motion: Message, poses: Mapping[int, Pose]) -> None:
    """Where the obstacles of those ids are in a MOTION."""
    for item, (key, pose) in zip(_room(motion.as_.motion.colliders, len(poses)), poses.items()):
        put(item, id=key)
        item.pose = pose._struct()


def _room(into, count: int):
    if count > len(into.items):
        raise ValueError(f"more than {len(into.items)} obstacles")
    into.count = count
    return into.items
