"""The package awtd, and the README's example."""

import os
import re
import subprocess
import unittest

import awtd
import numpy as np
from awtd import _library, _messages
from harness import TOP, WithDaemon


class Package(WithDaemon):
    def test_structs_are_as_in_the_header(self):
        lines = ['#include "proto.h"', '#include "awtframes.h"', "#include <stdio.h>", "int main(void) {"]
        expected = []
        for name, struct in _messages.STRUCTS.items():
            for field, _ in struct._fields_:
                lines.append(f'printf("%zu\\n", offsetof(struct proto_{name}, {field}));')
                expected.append(getattr(struct, field).offset)
        for struct, name in ((_library.Shown, "awtframes_shown"), (_library.Error, "awtclient_error"),
                             (_library.Options, "awtclient_options"), (_library.Transport, "awtlink_transport")):
            lines.append(f'printf("%zu\\n", sizeof({name}));')
            expected.append(_library.c.sizeof(struct))
        lines.append('printf("%zu\\n", offsetof(proto_message, as)); printf("%zu\\n", sizeof(proto_message)); }')
        program = self.path("offsets")
        subprocess.run(["cc", "-x", "c", "-I", f"{TOP}/proto", "-I", f"{TOP}/clients", "-o", program, "-"],
                       input="\n".join(lines), text=True, check=True)
        found = [int(n) for n in subprocess.check_output([program], text=True).split()]
        self.assertEqual(found[:-1], expected + [_messages.Message.as_.offset])
        self.assertLessEqual(found[-1], _library.c.sizeof(_messages.Message))

    def test_hair_follows_the_head(self):
        forest = self.connect().create("long", strands=500, style_omega=20)
        first = forest.drive(16667)
        self.assertEqual(first.positions.shape, (forest.strands, forest.points_per_strand, 3))
        self.assertEqual(first.positions.dtype, np.float32)
        self.assertTrue(np.isfinite(first.positions).all())
        self.assertEqual(first.widths.shape, (forest.points_per_strand,))
        moved = forest.drive(100000, awtd.Pose((0.1, 0, 0)))
        self.assertEqual(moved.time_us, 100000)
        self.assertEqual(moved.head.position, (0.1, 0, 0))
        roots, tips = (np.abs(moved.positions - first.positions).max(axis=(0, 2))[[0, -1]])
        self.assertLess(roots, 1e-3)
        self.assertGreater(tips, 1e-3)

    def test_a_subscription_gives_each_frame_that_another_connection_drives(self):
        forest = self.connect().create("short", strands=200)
        watched = self.connect().attach(forest.handle, forest.view_token)
        frames = watched.subscribe()
        for i in range(1, 13):  # more than its first credit
            driven = forest.drive(i * 16667, awtd.Pose((0.001 * i, 0, 0)))
            seen = next(frames)
            while seen.time_us < driven.time_us:
                seen = next(frames)
            self.assertTrue(np.array_equal(seen.positions, driven.positions))
        frames.close()
        self.assertEqual(list(frames), [])

    def test_a_subscription_keeps_frames_that_come_during_calls(self):
        forest = self.connect().create("short", strands=200)
        frames = forest.subscribe()
        driven = forest.drive(16667)
        self.assertEqual(forest.drive(33333).time_us, 33333)
        seen = next(frames)
        while seen.time_us < driven.time_us:
            seen = next(frames)
        self.assertTrue(np.array_equal(seen.positions, driven.positions))

    def test_a_saved_frame_is_its_glb(self):
        frame = self.connect().create("short", strands=200).drive(16667)
        path = self.path("hair.glb")
        frame.save(path)
        with open(path, "rb") as file:
            self.assertEqual(file.read(), frame.glb)
        self.assertEqual(frame.glb[:4], b"glTF")
        with self.assertRaises(OSError):
            frame.save(self.path("no", "folder.glb"))

    def test_errors_have_code_and_text(self):
        client = self.connect()
        for code, call in ((201, lambda: client.create("no such style")),
                           (202, lambda: client.create("short", strands=100, no_such=1)),
                           (200, lambda: client.attach(12345, bytes(16)))):
            with self.assertRaises(awtd.AwtError) as raised:
                call()
            self.assertEqual(raised.exception.code, code)
            self.assertTrue(raised.exception.text)
        forest = client.create("short", strands=100)
        forest.drive(16667)
        forest.close()
        with self.assertRaises(awtd.AwtError) as raised:
            forest.drive(33333)
        self.assertEqual(raised.exception.code, 200)
        client.close()
        with self.assertRaises(awtd.AwtError):
            forest.drive(50000)
        with self.assertRaises(awtd.AwtError) as raised:
            awtd.connect("127.0.0.1:1", self.token)
        self.assertEqual(raised.exception.code, -1)

    def test_the_readme_example_runs_as_given(self):
        with open(os.path.join(TOP, "README.md"), encoding="utf-8") as file:
            blocks = re.findall(r"(?:^    .*\n|^\n(?=    ))+", file.read(), re.M)
        example = [b for b in blocks if "awtd.connect(" in b]
        self.assertEqual(len(example), 1)
        path = self.path("example.py")
        with open(path, "w", encoding="utf-8") as file:
            file.write(re.sub(r"^    ", "", example[0], flags=re.M))
        done = self.run_script(path, self.address, self.token)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertTrue(os.path.getsize(self.path("hair.glb")) > 0)

    @unittest.skipUnless(__import__("importlib.util").util.find_spec("matplotlib"), "matplotlib is not here")
    def test_the_plot_is_drawn(self):
        done = self.run_script(os.path.join(TOP, "clients", "python", "plot.py"), "--address", self.address, "--token-file",
                               self.token, "--strands", "200", "--seconds", "0.5", "plot.png")
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        with open(self.path("plot.png"), "rb") as file:
            self.assertEqual(file.read(8), b"\x89PNG\r\n\x1a\n")
