"""Hair simulated by awtd, as NumPy arrays.

    with awtd.connect() as client:
        forest = client.create("long", strands=2000)
        frame = forest.drive(16667, awtd.Pose((0, 0.01, 0)))
        frame.positions        # (strands, points, 3) float32, metres, head frame

Lengths are metres, times microseconds of simulated time, orientations quaternions x y z w. One thread at a time may use
a client, its forests and its subscriptions. Calls wait for the daemon, at most the timeout.
"""

from .client import Client, connect
from .errors import AwtError
from .forest import Forest
from .frame import Frame, Nodes
from .poses import Pose
from .records import Param, Stats, Style
from .subscription import Subscription

__all__ = ["AwtError", "Client", "Forest", "Frame", "Nodes", "Param", "Pose", "Stats", "Style", "Subscription",
           "connect"]
