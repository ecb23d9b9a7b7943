"""Frames of every kind, by query and by stream, whole and as deltas."""

import math

import awtd
import numpy as np
from harness import WithDaemon

GUIDES_OFF_M = 0.2e-3  # GEOMETRY.md, How near: greatest 0.163 mm there
STRANDS_BITS, RIBBON_BITS = 12, 14  # GEOMETRY.md, Ribbons and strands


def swing(step):
    """The head at 60 steps a second."""
    turn = 0.2 * math.sin(step / 5)
    return step * 16667, awtd.Pose((0.05 * math.sin(step / 4), 0, 0), (0, math.sin(turn), 0, math.cos(turn)))


def rounding(forest, bits):
    """The most that a coordinate is rounded by, metres, and a little for floats."""
    return (forest.box[1] - forest.box[0]).max() / (2**bits - 1) / 2 + 1e-7


class Frames(WithDaemon):
    def stream(self, forest, frames, steps):
        """(what was driven, what the stream gave of it) of each step."""
        for step in range(1, steps + 1):
            driven = forest.drive(*swing(step))
            seen = next(frames)
            while seen.sequence < driven.sequence:
                seen = next(frames)
            self.assertEqual((seen.sequence, seen.time_us), (driven.sequence, driven.time_us))
            yield driven, seen

    def test_deltas_of_guides_give_the_strands_of_a_query_but_for_their_rounding(self):
        forest = self.connect().create("long", strands=1000)
        bases = []
        for driven, seen in self.stream(forest, forest.subscribe(kind="guides", deltas=True), 20):
            finer = forest.latest(kind="ribbon")
            self.assertEqual((seen.kind, seen.sequence), ("guides", finer.sequence))
            self.assertEqual(seen.positions.shape, driven.positions.shape)
            for other, bits in ((driven, STRANDS_BITS), (finer, RIBBON_BITS)):
                off = np.abs(seen.positions - other.positions)
                self.assertLess(off.max(), GUIDES_OFF_M + rounding(forest, bits))
                self.assertLess(off.mean(), (GUIDES_OFF_M + rounding(forest, bits)) / 2)
            np.testing.assert_array_equal(seen.widths, driven.widths)
            self.assertEqual(seen.head, driven.head)
            self.assertLess(len(seen.glb), len(driven.glb) / 5)
            bases.append(seen.base)
        self.assertEqual(bases[0], 0)
        self.assertGreater(min(bases[10:]), 0)
        self.assertGreater(np.abs(driven.positions[:, -1] - driven.positions[:, 0]).max(), 0.1)

    def test_deltas_of_strands_give_the_very_positions_of_a_query(self):
        forest = self.connect().create("short", strands=300)
        bases = []
        for driven, seen in self.stream(forest, forest.subscribe(deltas=True), 20):
            np.testing.assert_array_equal(seen.positions, driven.positions)
            bases.append(seen.base)
        self.assertGreater(min(bases[10:]), 0)
        with self.assertRaises(ValueError):
            seen.save(self.path("delta.glb"))

    def test_guides_of_a_stream_without_deltas_are_files(self):
        forest = self.connect().create("short", strands=300)
        for driven, seen in self.stream(forest, forest.subscribe(kind="guides"), 3):
            self.assertLess(np.abs(seen.positions - driven.positions).max(), GUIDES_OFF_M + rounding(forest, STRANDS_BITS))
        seen.save(self.path("guides.glb"))

    def test_every_kind_shows_the_same_hair(self):
        forest = self.connect().create("long", strands=500)
        driven = forest.drive(*swing(1))
        strands = rounding(forest, STRANDS_BITS)
        for kind, off in (("strands", 0), ("ribbon", strands + rounding(forest, RIBBON_BITS)),
                          ("guides", strands + GUIDES_OFF_M)):
            frame = forest.latest(kind=kind)
            self.assertEqual((frame.kind, frame.level, frame.sequence), (kind, "full", driven.sequence))
            self.assertLessEqual(np.abs(frame.positions - driven.positions).max(), off)
        ribbon = forest.drive(*swing(2), kind="ribbon", attributes=True)
        self.assertIn(b"_STRAND", ribbon.glb)
        self.assertEqual(ribbon.positions.shape, driven.positions.shape)

    def test_coarser_levels_are_some_of_the_full_strands(self):
        forest = self.connect().create("long", strands=2000)
        driven = forest.drive(*swing(1))
        full = {strand.tobytes() for strand in driven.positions}
        for level, share in (("fifth", 0.3), ("guides", 0.5)):
            frame = forest.latest(level=level)
            self.assertEqual(frame.level, level)
            self.assertLess(len(frame.positions), len(driven.positions) * share)
            self.assertTrue(all(strand.tobytes() in full for strand in frame.positions))
            self.assertGreater(frame.widths[0], driven.widths[0])

    def test_nodes_are_a_tree(self):
        forest = self.connect().create("long", strands=500)
        for frame in (forest.drive(*swing(1), kind="nodes"), forest.latest(kind="nodes")):
            count = frame.active_nodes
            self.assertEqual(frame.positions.shape, (count, 3))
            self.assertEqual((frame.radii.shape, frame.parents.shape, frame.levels.shape), ((count,),) * 3)
            self.assertTrue((frame.parents <= np.arange(count)).all())
            self.assertTrue((frame.parents < np.arange(count)).any())
            self.assertTrue((frame.radii > 0).all())
            self.assertTrue((frame.levels[frame.parents] <= frame.levels).all())
        nodes = forest.subscribe(kind="nodes")
        driven = forest.drive(*swing(2))
        seen = next(nodes)
        self.assertEqual((seen.sequence, len(seen.positions)), (driven.sequence, driven.active_nodes))

    def test_a_budget_gives_a_coarser_level(self):
        forest = self.connect().create("long", strands=2000)
        for driven, seen in self.stream(forest, forest.subscribe(budget=20000), 10):
            pass
        self.assertNotEqual(seen.level, "full")
        self.assertLess(len(seen.positions), len(driven.positions))

    def test_a_rate_thins_the_stream_out(self):
        forest = self.connect().create("short", strands=200)
        frames = forest.subscribe(rate=1)
        for step in range(1, 121):
            forest.drive(*swing(step))
        times = [next(frames).time_us for _ in range(2)]
        self.assertGreaterEqual(times[1] - times[0], 900000)

    def test_frames_that_nobody_has(self):
        forest = self.connect().create("short", strands=200)
        for wrong in (dict(kind="hair"), dict(level="half"), dict(kind=1)):
            for call in (forest.latest, forest.subscribe, lambda **form: forest.drive(16667, **form)):
                with self.assertRaises(ValueError):
                    call(**wrong)
        for wrong in (dict(rate=70000), dict(rate=-1), dict(budget=2**32)):
            with self.assertRaises(ValueError):
                forest.subscribe(**wrong)
        for call in (forest.latest, forest.subscribe):
            with self.assertRaises(awtd.AwtError) as raised:
                call(kind="guides", level="fifth")
            self.assertEqual(raised.exception.code, 105)

    def test_a_stream_ends_with_its_forest(self):
        forest = self.connect().create("short", strands=200)
        frames = forest.subscribe(kind="guides", deltas=True)
        forest.drive(*swing(1))
        next(frames)
        forest.close()
        with self.assertRaises(awtd.AwtError) as raised:
            next(frames)
        self.assertEqual(raised.exception.code, 200)
        self.assertEqual(list(frames), [])
