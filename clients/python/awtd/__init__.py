"""Hair simulated by awtd, as NumPy arrays.

    with awtd.connect() as client:
        forest = client.create("long", strands=2000)
        frame = forest.drive(16667, awtd.Pose((0, 0.01, 0)))
        frame.positions        # (strands, points, 3) float32, metres, head frame

Hair is brought from time to time (drive, Client.step_many), or left to the daemon's clock (Forest.set_clock, move).
Lengths are metres, times microseconds of simulated time, orientations quaternions x y z w. One thread at a time may use
a client, its forests and its subscriptions. Calls wait for the daemon, at most the timeout.
"""

from .client import Client, connect
from .clock import Clock
from .colliders import Collider
from .errors import AwtError
from .forest import Forest
from .frame import Frame, Nodes
from .poses import Pose
from .records import Param, Stats, Style
from .stepping import Stepped
from .subscription import Subscription

__all__ = ["AwtError", "Client", "Clock", "Collider", "Forest", "Frame", "Nodes", "Param", "Pose", "Stats", "Stepped",
           "Style", "Subscription", "connect"]
