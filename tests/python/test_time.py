"""How time goes: by the daemon's clock, in lock-step with several heads at once, by cuts; and obstacles that move."""

import time

import awtd
import numpy as np
from harness import PATIENCE_S, WithDaemon

FRAME_US = 16667
S = 1_000_000  # microseconds


class Time(WithDaemon):
    def refused(self, code, call, *arguments, **options):
        with self.assertRaises(awtd.AwtError) as raised:
            call(*arguments, **options)
        self.assertEqual(raised.exception.code, code)

    def bracket(self, forest):
        """now_us() and our clock before and after it."""
        before = time.monotonic_ns() // 1000
        now = forest.now_us()
        return before, now, time.monotonic_ns() // 1000

    def later(self, forest, time_us, **form):
        """The first frame seen that is not before that simulated time."""
        deadline = time.monotonic() + PATIENCE_S
        frame = forest.latest(**form)
        while frame.time_us < time_us:
            self.assertLess(time.monotonic(), deadline, "simulated time does not go on")
            time.sleep(0.01)
            frame = forest.latest(**form)
        return frame

    def test_a_free_running_forest_goes_by_the_daemons_clock_at_its_rate(self):
        forest = self.connect().create("short", strands=100, time_us=5 * S)
        self.assertIsNone(forest.clock)
        for rate in (1, 2, 0.5):
            asked = time.monotonic_ns() // 1000
            clock = forest.set_clock("free", rate=rate)
            self.assertEqual((clock, clock.mode, clock.rate), (forest.clock, "free", rate))
            before, first, after = self.bracket(forest)
            error = rate * (after - before) + 2  # the way of PING and PONG, and what is rounded
            self.assertGreaterEqual(first, clock.time_us - error)
            self.assertLessEqual(first, clock.time_us + rate * (after - asked) + error)
            frame = self.later(forest, first + S // 10)
            begin, last, end = self.bracket(forest)
            self.assertLessEqual(frame.time_us, last + error)
            self.assertGreaterEqual(last - first, rate * (begin - after) - error)
            self.assertLessEqual(last - first, rate * (end - before) + error)
        self.assertGreaterEqual(forest.set_clock("paused").time_us, frame.time_us)

    def test_its_head_goes_where_it_is_moved(self):
        forest = self.connect().create("short", strands=100)
        forest.set_clock("free")
        frames = forest.subscribe()
        for place in ((0.1, 0, 0), (0.1, 0.05, 0)):
            forest.move(awtd.Pose(place))
            then = forest.now_us() + S // 2  # late poses are taken at most 250 ms later
            frame = next(frames)
            while frame.time_us < then:
                frame = next(frames)
            np.testing.assert_allclose(frame.head.position, place, atol=1e-6)
            self.assertTrue(np.isfinite(frame.positions).all())
        frames.close()

    def test_a_paused_forest_stands_still(self):
        forest = self.connect().create("short", strands=100)
        forest.set_clock("free")
        self.later(forest, S // 10)
        clock = forest.set_clock("paused")
        first = forest.latest()
        self.assertLessEqual(first.time_us, clock.time_us)
        time.sleep(0.05)
        again = forest.latest()
        self.assertEqual((again.time_us, again.sequence), (first.time_us, first.sequence))
        np.testing.assert_array_equal(again.positions, first.positions)

    def test_lock_step_and_free_running_keep_to_their_own_calls(self):
        client = self.connect()
        forest = client.create("short", strands=100)
        for call in (forest.now_us, forest.move, lambda: forest.set_clock("fast")):
            with self.assertRaises(ValueError):
                call()
        self.refused(203, forest.set_clock, "free", rate=1000)
        self.refused(203, forest.set_clock, "free", importance=-1)
        self.assertIsNone(forest.clock)
        self.refused(112, self.connect().attach(forest.handle, forest.view_token).set_clock, "free")
        forest.set_clock("free")
        self.refused(204, forest.drive, forest.now_us() + S)
        clock = forest.set_clock("lockstep")
        with self.assertRaises(ValueError):
            forest.now_us()
        asked = max(clock.time_us, forest.latest().time_us) + 2 * S
        self.assertEqual(forest.drive(asked).time_us, asked)

    def test_a_teleport_takes_the_hair_along(self):
        shapes = []
        for teleport in (False, True):
            forest = self.connect().create("long", strands=200)
            before = forest.drive(S)
            after = forest.drive(S + FRAME_US, awtd.Pose((0.2, 0, 0)), teleport=teleport)
            self.assertEqual(after.head.position, (0.2, 0, 0))
            shapes.append(np.abs(after.positions - before.positions).max())
        self.assertGreater(shapes[0], 1e-2)
        self.assertLess(shapes[1], 1e-3)

    def test_an_obstacle_of_ones_own_pushes_the_hair(self):
        ball = [awtd.Collider(1, (0, 0, 0), 0.1, frame="head"),
                awtd.Collider(7, (-0.5, 0, 0), 0.01, (-0.9, 0, 0), 0.05)]  # its second end is what reaches the hair
        ends = []
        for aside in (2.0, 0.0):
            forest = self.connect().create("long", strands=200, colliders=ball)
            forest.drive(FRAME_US, colliders={7: awtd.Pose((2, 0, 0))})
            for step in range(2, 30):
                frame = forest.drive(step * FRAME_US, colliders={7: awtd.Pose((aside + 0.98, -0.12, 0))})
            ends.append(frame.positions)
        self.assertGreater(np.abs(ends[1] - ends[0]).max(), 5e-3)
        self.refused(203, forest.drive, S, colliders={8: awtd.Pose()})
        for wrong in ([awtd.Collider(1, (0, 0, 0), 0.1, frame="world")], ball * 9, [awtd.Collider(-1, (0, 0, 0), 0.1)]):
            with self.assertRaises(ValueError):
                self.connect().create("short", colliders=wrong)
        with self.assertRaises(ValueError):
            forest.move(time_us=2 * S, colliders={key: awtd.Pose() for key in range(17)})

    def test_several_forests_step_by_one_deadline_as_each_would_alone(self):
        client, alone = self.connect(), self.connect()
        forests = [client.create("short", strands=100 + 50 * i, seed=i + 1) for i in range(3)]
        again = [alone.create("short", strands=100 + 50 * i, seed=i + 1) for i in range(3)]
        for kind in ("strands", "guides", "nodes"):
            start = forests[0].latest().time_us
            for forest in forests:
                forest.move(awtd.Pose((0.05, 0, 0)), time_us=start + FRAME_US)
            stepped = client.step_many([(forest, start + FRAME_US * (1 + i)) for i, forest in enumerate(forests)],
                                       deadline_us=PATIENCE_S * S, kind=kind)
            self.assertEqual(stepped.errors, [])
            for i, frame in enumerate(stepped.frames):
                again[i].move(awtd.Pose((0.05, 0, 0)), time_us=start + FRAME_US)
                expected = client_frame(again[i], start + FRAME_US * (1 + i), kind)
                self.assertEqual((frame.kind, frame.time_us, frame.stale), (kind, start + FRAME_US * (1 + i), False))
                np.testing.assert_array_equal(frame.positions, expected.positions)
            start += FRAME_US * 4
            for forest in forests + again:  # all at one time again
                forest.drive(start)

    def test_what_is_not_ready_by_the_deadline_comes_stale_or_as_an_error(self):
        client = self.connect()
        slow, gone = client.create("long", strands=2000), client.create("short", strands=100)
        slow.drive(FRAME_US)
        gone.close()
        stepped = client.step_many([(gone, FRAME_US), (slow, 10 * S)], deadline_us=1)
        self.assertIsNone(stepped.frames[0])
        self.assertEqual([error.code for error in stepped.errors], [200])
        self.assertEqual((stepped.frames[1].time_us, stepped.frames[1].stale), (FRAME_US, True))
        later = slow.drive(10 * S + FRAME_US)
        self.assertEqual((later.time_us, later.stale), (10 * S + FRAME_US, False))
        for wrong in ([], [(slow, 20 * S), (slow, 21 * S)], [(slow, 1 << 70)]):
            with self.assertRaises(ValueError):
                client.step_many(wrong)

    def test_a_frame_says_where_its_time_went(self):
        forest = self.connect().create("long", strands=2000)
        frame = forest.drive(S, awtd.Pose((0.02, 0, 0)))
        self.assertEqual(frame.steps, 100)  # of 10 ms
        self.assertGreater(frame.step_us, 0)
        self.assertGreater(frame.encode_us, 0)
        self.assertTrue(0 <= frame.link_error < 0.1, frame.link_error)
        self.assertGreater(forest.drive(S + FRAME_US).last_write_us, 0)


def client_frame(forest, time_us, kind):
    """The frame of a forest whose head was moved already."""
    stepped = awtd.Client(forest._connection).step_many([(forest, time_us)], deadline_us=PATIENCE_S * S, kind=kind)
    return stepped.frames[0]
