"""Several forests by one deadline."""

from __future__ import annotations

from typing import Dict, List, NamedTuple, Optional, Sequence, Tuple, Union

from ._messages import put
from .connection import Connection
from .errors import PEER, AwtError
from .forest import Forest
from .forms import KINDS, LEVELS, Kind, Level, number
from .frame import Frame, Nodes


class Stepped(NamedTuple):
    """What Client.step_many() gives. frames: one for each forest, in the order given; stale: it was not ready in time;
    None: there is none. errors: why, one for each that is missing, in no order."""

    frames: List[Optional[Union[Frame, Nodes]]]
    errors: List[AwtError]


def step_many(connection: Connection, times: Sequence[Tuple[Forest, int]], deadline_us: int, kind: Kind, level: Level,
              attributes: bool) -> Stepped:
    """See Client.step_many()."""
    places: Dict[int, int] = {forest.handle: place for place, (forest, _) in enumerate(times)}
    if not times or len(places) < len(times):
        raise ValueError("there are no forests, or one of them twice")
    readers = [forest._reader(kind) for forest, _ in times]
    request = connection.message("STEP_MANY")
    many = request.as_.step_many
    put(many, deadline_us=deadline_us, kind=number(KINDS, kind), level=number(LEVELS, level),
        attributes=int(attributes))
    if len(times) > len(many.forests.items):
        raise ValueError(f"more than {len(many.forests.items)} forests")
    many.forests.count = len(times)
    for item, (forest, time_us) in zip(many.forests.items, times):
        put(item, forest=forest.handle, time_us=time_us)
    stepped = Stepped([None] * len(times), [])
    for _, answer in zip(times, connection.answers(request)):
        if isinstance(answer, AwtError):
            stepped.errors.append(answer)
            continue
        place = places.pop(answer.as_.frame.forest, None)
        if place is None:
            raise AwtError(PEER, "the other end sent a frame of a forest that was not asked for")
        stepped.frames[place] = readers[place](answer)
    return stepped
