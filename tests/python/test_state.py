"""Strand files in, snapshots out and in, and what the daemon says of itself."""

import struct

import awtd
import numpy as np
from harness import WithDaemon

POINTS = 12


def hair_file(strands):
    """A cyHair file of curved strands on the upper half of a head, centimetres, Z up."""
    rng = np.random.default_rng(1)
    out = rng.normal(size=(strands, 1, 3))
    out[:, :, 2] = np.abs(out[:, :, 2])
    out /= np.linalg.norm(out, axis=2, keepdims=True)
    along = np.linspace(0, 1, POINTS)[None, :, None]
    points = out * (9 + 12 * along) - np.array([0, 0, 6]) * along**2
    header = struct.pack("<4s4I4f88s", b"HAIR", strands, strands * POINTS, 2, POINTS - 1, 0.01, 0, 1, 1, b"")
    return header.ljust(128, b"\0")[:128] + points.astype("<f4").tobytes()


class State(WithDaemon):
    def file(self, name, content):
        path = self.path(name)
        with open(path, "wb") as file:
            file.write(content)
        return path

    def refused(self, code, call, *arguments, **options):
        with self.assertRaises(awtd.AwtError) as raised:
            call(*arguments, **options)
        self.assertEqual(raised.exception.code, code)
        self.assertTrue(raised.exception.text)

    def test_a_strand_file_becomes_hair(self):
        client = self.connect()
        content, shares = hair_file(10000), []
        self.assertGreater(len(content), 1 << 20)  # more than one piece
        upload = client.upload(self.file("some.hair", content), shares.append)
        self.assertEqual((len(shares), shares[-1]), (2, 1))
        forest = client.create(upload=upload, scale=0.01, up="z", head_centre=(0, 0, 0), head_radius=9, name="some")
        self.assertEqual((forest.strands, forest.points_per_strand), (10000, POINTS))
        frame = forest.drive(16667)
        longest = np.linalg.norm(frame.positions, axis=2).max()
        self.assertTrue(0.1 < longest < 0.25, longest)
        client.forget(upload)
        self.refused(205, client.create, upload=upload)
        forest.drive(33333)

    def test_a_hierarchy_of_ones_own(self):
        client = self.connect()
        wisps = "".join(f"{i // 20}\n" for i in range(200)).encode()
        uploads = dict(upload=client.upload(self.file("some.hair", hair_file(200))),
                       hierarchy=client.upload(self.file("wisps", wisps)))
        forest = client.create(**uploads, scale=0.01, up="z", head_radius=9)
        self.assertEqual(forest.strands, 200)
        self.assertGreater(len(forest.latest(kind="nodes").positions), 0)

    def test_files_that_are_none(self):
        client = self.connect()
        self.refused(206, client.upload, self.file("empty", b""))
        self.refused(207, client.create, upload=client.upload(self.file("wrong", b"not hair")))
        with self.assertRaises(OSError):
            client.upload(self.path("not there"))
        for wrong in (dict(), dict(style="long", upload=1), dict(style="long", up="x"), dict(style="long", levels=300)):
            with self.assertRaises(ValueError):
                client.create(**wrong)
        client.create("short", strands=100)

    def test_a_restored_forest_goes_on_to_the_bit(self):
        client = self.connect()
        forest = client.create("short", strands=300, style_omega=20)
        for step in range(1, 6):
            forest.drive(step * 16667, awtd.Pose((0.02 * step, 0, 0)))
        other = self.connect()
        for _ in range(6):  # its uploads are forgotten: more than may be kept at a time
            again = other.restore(forest.snapshot(), "again")
        self.assertNotEqual(again.handle, forest.handle)
        self.assertEqual((again.strands, again.points_per_strand), (forest.strands, forest.points_per_strand))
        np.testing.assert_array_equal(again.box, forest.box)
        for step in range(6, 10):
            pose = awtd.Pose((0.1, 0.01 * step, 0))
            np.testing.assert_array_equal(again.drive(step * 16667, pose).positions,
                                          forest.drive(step * 16667, pose).positions)
        for _ in range(6):
            self.refused(207, other.restore, b"no snapshot")
        damaged = bytearray(forest.snapshot())
        damaged[len(damaged) // 2] ^= 1
        self.refused(203, other.restore, bytes(damaged))
        viewer = self.connect().attach(forest.handle, forest.view_token)
        self.refused(112, viewer.snapshot)

    def test_the_daemon_says_how_it_is(self):
        client = self.connect()
        before = client.stats()
        self.assertTrue(before.version)
        self.assertGreater(before.workers, 0)
        self.assertGreaterEqual(before.connections, 1)
        forest = client.create("short", strands=100)
        forest.drive(16667)
        after = client.stats()
        for _ in range(1000):  # counted when the last byte is gone, which may be after it is here
            after = after if after.frames_sent > before.frames_sent else client.stats()
        self.assertGreater(after.frames_sent, before.frames_sent)
        self.assertEqual(after.forests, before.forests + 1)
        self.assertEqual(after.steps, before.steps + 2)  # of 10 ms at most
        self.assertGreater(after.uptime_us, before.uptime_us)
        forest.close()
        self.assertEqual(client.stats().forests, before.forests)

    def test_styles_and_parameters_are_what_create_takes(self):
        client = self.connect()
        styles, params = client.styles(), client.params()
        self.assertEqual([style.name for style in styles], ["short", "short-curly", "long", "long-curly"])
        for style in styles:
            forest = client.create(style.name, strands=100)
            self.assertEqual(forest.points_per_strand, style.points_per_strand)
            self.assertTrue(style.text and style.levels > 0 and style.finest_nodes > 0)
        for param in params:
            self.assertTrue(param.least <= param.value <= param.greatest, param)
            self.assertTrue(param.text)
        forest.set_params(**{param.name: param.value for param in params})
        greatest = params[0]
        self.refused(203, forest.set_params, **{greatest.name: greatest.greatest * 2})
