"""Whoever else may listen at that port: programs that lie, stop, or never stop. Every call ends, with an AwtError."""

import contextlib
import json
import math
import socket
import struct
import threading
import time
import unittest

import awtd
from awtd import _library
from harness import PATIENCE_S, ended

CLOSED, TIMEOUT, PEER = -3, -4, -5  # awtlink.h
BAD_VERSION, TIMED_OUT = 101, 113  # errors.def
SHORT_S = 0.3

NAMES = _library.load().proto_type_name
TYPES = _library.TYPES


def message(name, payload=b"", request=0):
    """A message's bytes."""
    return struct.pack("<IHHQ", len(payload), TYPES[name], 0, request) + payload


def text(words):
    return struct.pack("<H", len(words)) + words.encode()


def welcome(version=1):
    """WELCOME that asks for no token."""
    return message("WELCOME", struct.pack("<BB32sI16s", version, 0, bytes(32), 2 << 20, b"s" * 16) + text("liar"), 1)


def frame(request, glb, kind=1, base=0, time_us=0, level=0):
    """FRAME of a forest number 1."""
    fields = struct.pack("<QBBHqQQ9I2f4I", 1, kind, level, 0, time_us, 1, base, *[0] * 9, 0, 0, *[0] * 4)
    return message("FRAME", fields + struct.pack("<I", len(glb)) + glb, request)


def nodes_glb(records, **changed):
    """A frame of nodes: (place, radius, parent, level) of each."""
    binary = b"".join(struct.pack("<5fBxxx", *place, radius, parent, level) for place, radius, parent, level in records)
    extras = {"kind": "nodes", "nodes": len(records), **changed}
    document = {"nodes": [{"extras": extras}], "bufferViews": [{"byteStride": 24}]}
    said = json.dumps(document).encode()
    said += b" " * (-len(said) % 4)
    body = struct.pack("<I4s", len(said), b"JSON") + said + struct.pack("<I4s", len(binary), b"BIN\0") + binary
    return struct.pack("<4sII", b"glTF", 2, 12 + len(body)) + body


class Peer:
    """The other end of one connection, for scripts."""

    def __init__(self, connection):
        connection.settimeout(PATIENCE_S)
        self.socket = connection

    def send(self, *pieces):
        self.socket.sendall(b"".join(pieces))

    def take(self, name=None):
        """The request id of the next message; with a name, of the next such one."""
        while True:
            length, kind, _, request = struct.unpack("<IHHQ", self._bytes(16))
            self._bytes(length)
            if name in (None, NAMES(kind).decode()):
                return request

    def stay(self):
        """Says nothing until the client is gone."""
        while self.socket.recv(1 << 16):
            pass

    def _bytes(self, size):
        out = b""
        while len(out) < size:
            piece = self.socket.recv(size - len(out))
            if not piece:
                raise ConnectionError("gone")
            out += piece
        return out


def without_end(peer, piece):
    while True:
        peer.send(piece)
        time.sleep(0.01)


class Liars(unittest.TestCase):
    def lie(self, script):
        """The address where the script awaits one client."""
        listener = socket.create_server(("127.0.0.1", 0))

        def run():
            with listener, contextlib.suppress(OSError):
                connection, _ = listener.accept()
                with connection:
                    script(Peer(connection))

        thread = threading.Thread(target=run, daemon=True)
        thread.start()
        self.addCleanup(thread.join, PATIENCE_S)
        return f"127.0.0.1:{listener.getsockname()[1]}"

    def fails(self, codes, call):
        error = ended(call)
        self.assertIsInstance(error, awtd.AwtError)
        self.assertIn(error.code, codes, error)
        self.assertTrue(error.text)

    def greeting(self, script, *codes, timeout_s=PATIENCE_S):
        """Connecting to the script fails."""
        address = self.lie(script)
        self.fails(codes, lambda: awtd.connect(address, timeout_s=timeout_s).close())

    def meet(self, script, timeout_s=PATIENCE_S):
        """A client of a script that has shaken hands."""
        def whole(peer):
            peer.take()
            peer.send(welcome())
            script(peer)
            peer.stay()

        client = awtd.connect(self.lie(whole), timeout_s=timeout_s)
        self.addCleanup(client.close)
        return client

    def forest(self, script, timeout_s=PATIENCE_S):
        """A forest of a script that lets everybody attach."""
        def attached(peer):
            peer.send(message("ATTACH_REPLY", struct.pack("<BqIH", 1, 0, 2, 4), peer.take("ATTACH")))
            script(peer)

        return self.meet(attached, timeout_s).attach(1, bytes(16))

    # ---- greeting ----

    def test_garbage(self):
        for garbage in (bytes(range(256)) * 8, b"HTTP/1.1 400 Bad Request\r\n\r\n", b"\xff" * 64):
            self.greeting(lambda peer: (peer.take(), peer.send(garbage), peer.stay()), PEER)

    def test_lengths_that_are_wrong(self):
        rest = welcome()[4:]
        for length in (0, 2, len(rest) - 12 - 1, 0xffffffff):
            self.greeting(lambda peer: (peer.take(), peer.send(struct.pack("<I", length), rest), peer.stay()), PEER)

    def test_other_versions(self):
        refusal = message("ERROR", struct.pack("<HBIH", BAD_VERSION, 0, 0, TYPES["HELLO"]) + text("no"), 1)
        self.greeting(lambda peer: (peer.take(), peer.send(refusal)), BAD_VERSION)
        self.greeting(lambda peer: (peer.take(), peer.send(welcome(9)), peer.stay()), PEER, BAD_VERSION)

    def test_who_closes(self):
        self.greeting(lambda peer: peer.take(), CLOSED)
        self.greeting(lambda peer: (peer.take(), peer.send(welcome()[:-3])), CLOSED)

    def test_who_never_answers(self):
        self.greeting(lambda peer: peer.stay(), TIMEOUT, timeout_s=SHORT_S)

    def test_who_drips(self):
        self.greeting(lambda peer: (peer.send(struct.pack("<IHHQ", 80, TYPES["WELCOME"], 0, 1)),
                                    without_end(peer, b"\1")), TIMEOUT, PEER, timeout_s=SHORT_S)

    # ---- answers ----

    def test_answers_that_do_not_decode(self):
        for payload in (b"", bytes(7), b"\xff" * 200, text("1.0") + bytes(200)):
            client = self.meet(lambda peer: peer.send(message("STATS_REPLY", payload, peer.take())))
            self.fails((PEER,), client.stats)
        endless = self.meet(lambda peer: peer.send(struct.pack("<IHHQ", 2**31, TYPES["STATS_REPLY"], 0, peer.take())))
        self.fails((PEER,), endless.stats)

    def test_an_answer_of_another_kind(self):
        client = self.meet(lambda peer: peer.send(message("DESTROY_REPLY", b"", peer.take())))
        self.fails((PEER,), client.stats)

    def test_requests_that_nobody_answers(self):
        self.fails((TIMEOUT, TIMED_OUT), self.meet(lambda peer: None, SHORT_S).stats)

    def test_talk_of_other_things_without_end(self):
        for other in (message("DESTROY_REPLY", b"", 77), message("PING", bytes(8), 5), frame(99, b"")):
            self.fails((TIMEOUT, TIMED_OUT), self.meet(lambda peer: without_end(peer, other), SHORT_S).stats)

    def test_an_upload_that_is_lost(self):
        client = self.meet(lambda peer: peer.send(message("UPLOAD_REPLY", struct.pack("<IQ", 1, 3), peer.take())))
        self.fails((PEER,), lambda: client.restore(b"a snapshot"))

    # ---- frames ----

    def test_frames_that_cannot_be_read(self):
        glb = b"glTF" + struct.pack("<II", 2, 28) + struct.pack("<I4s", 8, b"JSON") + b"{}      "
        for kind, name in enumerate(("ribbon", "strands", "guides", "nodes")):
            for content in (b"", b"\xff" * 100, glb, glb[:13]):
                def script(peer):
                    if name == "guides":
                        peer.send(message("BINDING_REPLY", struct.pack("<QI", 1, 4) + b"AWTB", peer.take("BINDING")))
                    peer.send(frame(peer.take("QUERY"), content, kind))

                self.fails((PEER,), lambda: self.forest(script).latest(kind=name))

    def test_nodes_that_cannot_be(self):
        root, place = ((0, 0, 0), 1, 0, 0), (1, 2, 3)

        def latest(glb):
            return self.forest(lambda peer: peer.send(frame(peer.take("QUERY"), glb, 3))).latest(kind="nodes")

        fine = latest(nodes_glb([root, (place, 2, 0, 3)]))
        self.assertEqual(fine.positions[1].tolist(), [1, 2, 3])
        self.assertEqual((fine.radii[1], fine.parents[1], fine.levels[1]), (2, 0, 3))
        for wrong in ((place, 2, 2, 1), (place, 2, -1, 1), (place, 2, 0.5, 1), (place, 2, math.nan, 1), (place, 2, 0, 4),
                      (place, math.inf, 0, 1), ((0, math.nan, 0), 2, 0, 1)):
            self.fails((PEER,), lambda: latest(nodes_glb([root, wrong])))
        for extras in (dict(nodes=3), dict(nodes=0), dict(nodes=-1), dict(nodes=1e300), dict(nodes="two"),
                       dict(nodes=None), dict(kind="strands")):
            self.fails((PEER,), lambda: latest(nodes_glb([root], **extras)))

    def test_a_frame_of_another_kind(self):
        for kind in (0, 2, 3, 9):
            forest = self.forest(lambda peer: peer.send(frame(peer.take("QUERY"), b"", kind)))
            self.fails((PEER,), forest.latest)

    def test_streams_of_frames_that_cannot_be_read_say_so_each_time(self):
        def script(peer):
            request = peer.take("SUBSCRIBE")
            peer.send(message("SUBSCRIBE_REPLY", struct.pack("<Q", 5), request),
                      frame(request, b"\xff" * 50), frame(request, b"", base=7))
            for _ in range(2):
                peer.take("CREDIT")

        frames = self.forest(script, 5).subscribe(deltas=True)
        for _ in range(2):
            self.fails((PEER,), lambda: next(frames))

    def test_frames_without_credit_end_the_stream(self):
        def script(peer):
            request = peer.take("SUBSCRIBE")
            peer.send(message("SUBSCRIBE_REPLY", struct.pack("<Q", 5), request))
            peer.send(*[frame(request, b"")] * 100, message("SET_PARAMS_REPLY", b"", peer.take("SET_PARAMS")))

        forest = self.forest(script)
        frames = forest.subscribe()
        forest.set_params(drag=1)
        for _ in range(7):
            self.fails((PEER,), lambda: next(frames))
        with self.assertRaisesRegex(awtd.AwtError, "credit"):
            next(frames)
        self.assertEqual(list(frames), [])

    def test_streams_without_frames(self):
        def script(peer):
            request = peer.take("SUBSCRIBE")
            peer.send(message("SUBSCRIBE_REPLY", struct.pack("<Q", 5), request))
            without_end(peer, message("DESTROY_REPLY", b"", 77))

        frames = self.forest(script, SHORT_S).subscribe()
        self.fails((TIMEOUT,), lambda: next(frames))
