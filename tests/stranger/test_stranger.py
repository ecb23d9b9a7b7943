"""test_stranger.py BUILD: the client of client.py talks to the daemon in folder BUILD, as PROTOCOL.md says it may."""

import json
import math
import os
import shutil
import struct
import subprocess
import sys
import tempfile
import unittest

from client import Client, Closed, DaemonError
from document import HEADER, Document

HERE = os.path.dirname(os.path.abspath(__file__))
PAGE = Document(os.path.join(HERE, "..", "..", "proto", "PROTOCOL.md"))
RIBBON, STRANDS, GUIDES, NODES = range(4)
FRAME_US = 16667


class Daemon:
    """An awtd of its own, on a port of its own."""

    def __init__(self, build):
        self.state = tempfile.mkdtemp(prefix="awtd-stranger-")
        self.process = subprocess.Popen([os.path.join(build, "awtd"), "--listen", "127.0.0.1:0", "--state-dir",
                                         self.state], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        host, port = self.process.stdout.readline().removeprefix("listening on ").rsplit(":", 1)
        self.address = (host, int(port))
        with open(os.path.join(self.state, "token"), encoding="ascii") as file:
            self.token = bytes.fromhex(file.read().strip())

    def stop(self):
        self.process.terminate()
        code = self.process.wait(30)
        self.process.stdout.close()
        shutil.rmtree(self.state)
        return code


def glb_json(glb):
    """The JSON chunk of a GLB file."""
    magic, version, length, size, kind = struct.unpack_from("<4sIII4s", glb)
    assert (magic, version, length, kind) == (b"glTF", 2, len(glb), b"JSON")
    return json.loads(glb[20:20 + size])


def hair_file(strands, points):
    """A cyHair file: straight strands that hang from a cap of 10 cm, in centimetres, Z up."""
    header = struct.pack("<4sIIIIfff3f", b"HAIR", strands, strands * points, 2, points - 1, 0.01, 0.0, 0.5, .5, .4, .3)
    body = bytearray(header.ljust(128, b"\0"))
    for s in range(strands):
        turn = s * 2.399963
        out = math.sqrt((s + 0.5) / strands)
        root = (9 * out * math.cos(turn), 9 * out * math.sin(turn), 10 * math.sqrt(1 - 0.8 * out * out))
        for p in range(points):
            body += struct.pack("<3f", root[0] * (1 + 0.02 * p), root[1] * (1 + 0.02 * p), root[2] - 2.0 * p)
    return bytes(body)


class Stranger(unittest.TestCase):
    def open(self, token="right"):
        client = Client(PAGE, DAEMON.address, DAEMON.token if token == "right" else token)
        self.addCleanup(client.close)
        return client

    def create(self, client, **fields):
        wanted = {"source": 0, "style": "long", "name": "stranger", "strands": 300, "seed": 7} | fields
        return client.call("CREATE", **wanted)

    def advance(self, client, forest, frame, kind=STRANDS):
        """Moves the head to where it is at that frame and asks for the hair there."""
        time_us = frame * FRAME_US
        angle = 0.4 * math.sin(frame * 0.3)
        pose = (0.05 * math.sin(frame * 0.2), 1.7, 0.0, 0.0, math.sin(angle / 2), 0.0, math.cos(angle / 2))
        client.send("MOTION", 0, forest=forest, epoch=1, sequence=frame, time_us=time_us, head=pose, body=pose)
        return client.call("QUERY", forest=forest, time_us=time_us, kind=kind)

    def refused(self, code, call, *arguments, **fields):
        with self.assertRaises(DaemonError) as caught:
            call(*arguments, **fields)
        self.assertEqual(caught.exception.code, PAGE.errors[code], caught.exception)
        return caught.exception.fields

    def closed(self, client):
        with self.assertRaises((Closed, ConnectionError)):
            client.receive_any()

    # ---- the page ----

    def test_worked_exchange_is_what_the_tables_say(self):
        self.assertGreaterEqual(len(PAGE.exchange), 9)
        for _, name, message in PAGE.exchange:
            length, kind, flags, request = HEADER.unpack_from(message)
            self.assertEqual(PAGE.names[kind], name)
            if name != "FRAME":  # its GLB is left out
                fields = PAGE.decode(name, message[HEADER.size:])
                self.assertEqual(length, len(message) - HEADER.size)
                again = PAGE.encode(name, request, fields)
                self.assertEqual(again[HEADER.size:], message[HEADER.size:])
                self.assertEqual(flags & 1, 0 if kind & 0x8000 or name in ("WELCOME", "MOTION") else 1, name)

    # ---- the door ----

    def test_handshake_proves_both_sides(self):
        client = self.open().open()
        stats = client.call("STATS")
        self.assertGreaterEqual(stats["connections"], 1)

    def test_wrong_token_is_refused_and_the_connection_closed(self):
        client = self.open(token=bytes(16))
        self.refused("WRONG_TOKEN", client.open)
        self.closed(client)

    def test_request_without_token_is_refused(self):
        client = self.open()
        client.greet()
        self.refused("NO_TOKEN", client.call, "STATS")
        self.closed(client)

    def test_version_that_does_not_exist_is_refused(self):
        client = self.open()
        self.refused("BAD_VERSION", client.greet, lowest=200, highest=201)
        self.closed(client)

    def test_wrong_magic_is_refused(self):
        client = self.open()
        self.refused("BAD_MAGIC", client.greet, magic=b"HTTP")
        self.closed(client)

    def test_long_payload_before_the_door_is_refused(self):
        client = self.open()
        client.socket.sendall(HEADER.pack(513, PAGE.types["HELLO"], 1, 1))
        name, _, fields = client.receive_any()
        self.assertEqual((name, fields["code"]), ("ERROR", PAGE.errors["TOO_LONG"]))
        self.closed(client)

    def test_session_that_was_cut_off_is_resumed(self):
        first = self.open().open()
        made = self.create(first)
        first.close()
        second = self.open().open()
        reply = second.call("RESUME", session=first.welcome["session"])
        self.assertEqual(reply["forests"], [{"forest": made["forest"], "may_drive": 1}])
        self.advance(second, made["forest"], 1)
        self.refused("NO_SESSION", self.open().open().call, "RESUME", session=first.welcome["session"])

    # ---- requests ----

    def test_ping_is_answered_with_the_times(self):
        client = self.open().open()
        pong = client.call("PING", sent_us=123456)
        self.assertEqual(pong["sent_us"], 123456)
        self.assertLessEqual(pong["received_us"], pong["answered_us"])

    def test_unknown_message_is_named_and_the_connection_goes_on(self):
        client = self.open().open()
        client.socket.sendall(HEADER.pack(3, 0x7777, 1, 77) + b"abc" + HEADER.pack(3, 0x7778, 0, 78) + b"abc")
        self.refused("UNKNOWN_MESSAGE", client.answer, 77)
        client.call("STATS")

    def test_styles_and_parameters_are_listed(self):
        reply = self.open().open().call("LIST_STYLES")
        self.assertEqual([style["name"] for style in reply["styles"]], ["short", "short-curly", "long", "long-curly"])
        for param in reply["params"]:
            self.assertLessEqual(param["least"], param["value"], param["name"])
            self.assertLessEqual(param["value"], param["greatest"], param["name"])

    def test_payload_cut_inside_of_a_field_ends_the_connection(self):
        client = self.open().open()
        whole = PAGE.encode("QUERY", 5, {"forest": 1})
        client.socket.sendall(HEADER.pack(len(whole) - HEADER.size - 1, PAGE.types["QUERY"], 1, 5) + whole[16:-1])
        self.refused("BAD_FRAME", client.answer, 5)
        self.closed(client)

    def test_not_a_number_is_refused_and_the_connection_goes_on(self):
        client = self.open().open()
        made = self.create(client)
        pose = (math.nan, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0)
        client.send("MOTION", 31, forest=made["forest"], epoch=1, sequence=1, time_us=FRAME_US, head=pose)
        self.refused("BAD_VALUE", client.answer, 31)
        self.advance(client, made["forest"], 1)

    # ---- hair ----

    def test_hair_of_every_kind_follows_the_head(self):
        client = self.open().open()
        made = self.create(client)
        self.assertEqual(made["strands"], 300)
        for kind in (RIBBON, STRANDS, GUIDES, NODES):
            frame = self.advance(client, made["forest"], kind + 1, kind)
            self.assertEqual((frame["kind"], frame["time_us"], frame["base"]), (kind, (kind + 1) * FRAME_US, 0))
            self.assertEqual(frame["clamped_points"], 0)
            gltf = glb_json(frame["glb"])
            self.assertEqual(gltf["asset"]["version"], "2.0")
            if kind in (RIBBON, STRANDS):
                self.assertEqual(gltf["nodes"][0]["extras"]["strands"], 300)

    def test_same_inputs_give_the_same_bytes(self):
        client = self.open().open()
        forests = [self.create(client)["forest"] for _ in range(2)]
        for frame in range(1, 20):
            first, second = (self.advance(client, forest, frame) for forest in forests)
            self.assertEqual(first["glb"], second["glb"])
        self.assertGreater(first["kinetic_energy_j"], 0)

    def test_time_does_not_run_backwards(self):
        client = self.open().open()
        forest = self.create(client)["forest"]
        self.advance(client, forest, 3)
        self.refused("BAD_TIME", client.call, "QUERY", forest=forest, time_us=FRAME_US, kind=STRANDS)

    def test_parameters_are_taken_together_or_not_at_all(self):
        client = self.open().open()
        forest = self.create(client)["forest"]
        client.call("SET_PARAMS", forest=forest, params=[{"name": "wind_x", "value": 2.0}])
        self.refused("NO_PARAM", client.call, "SET_PARAMS", forest=forest,
                     params=[{"name": "wind_x", "value": 1.0}, {"name": "windy", "value": 1.0}])

    def test_uploaded_strands_become_hair(self):
        client = self.open().open()
        client.upload(4, hair_file(strands=200, points=12))
        made = client.call("CREATE", source=1, upload=4, name="cap", scale=0.01, up=2, head_x=0.0, head_y=0.0,
                           head_z=0.0, head_radius=10.0, progress=1)
        self.assertEqual((made["strands"], made["points_per_strand"], made["skipped_strands"]), (200, 12, 0))
        self.assertLess(made["rebuilt_max_m"], 0.01)
        self.assertEqual(self.advance(client, made["forest"], 1)["clamped_points"], 0)

    def test_upload_that_is_no_hair_is_refused(self):
        client = self.open().open()
        client.upload(1, b"not hair at all" * 100)
        self.refused("BAD_STRANDS", client.call, "CREATE", source=1, upload=1)

    # ---- several connections ----

    def test_viewer_sees_what_the_driver_moves_and_may_not_move_it(self):
        driver, viewer = self.open().open(), self.open().open()
        made = self.create(driver)
        forest = made["forest"]
        self.refused("NOT_ALLOWED", viewer.call, "QUERY", forest=forest, latest=1)
        reply = viewer.call("ATTACH", forest=forest, token=made["view_token"])
        self.assertEqual((reply["may_drive"], reply["strands"]), (0, 300))
        self.refused("NOT_ALLOWED", viewer.call, "QUERY", forest=forest, time_us=FRAME_US)
        request = viewer.next_request()
        viewer.send("SUBSCRIBE", request, forest=forest, kind=STRANDS, credit=1)
        subscription = viewer.answer(request)["subscription"]
        for frame in range(1, 4):
            driven = self.advance(driver, forest, frame)
            name, about, seen = viewer.receive()
            self.assertEqual((name, about), ("FRAME", request))
            self.assertEqual((seen["sequence"], seen["glb"]), (driven["sequence"], driven["glb"]))
            viewer.send("CREDIT", 0, subscription=subscription, frames=1)
            viewer.call("STATS")  # so that the credit has come before the next frame is made
        driver.call("DESTROY", forest=forest)
        name, about, fields = viewer.receive()
        self.assertEqual((name, about, fields["code"]), ("ERROR", request, PAGE.errors["NO_FOREST"]))

    def test_frames_without_credit_are_left_out_and_counted(self):
        client = self.open().open()
        forest = self.create(client)["forest"]
        request = client.next_request()
        client.send("SUBSCRIBE", request, forest=forest, kind=STRANDS, credit=1)
        subscription = client.answer(request)["subscription"]
        for frame in range(1, 6):
            last = self.advance(client, forest, frame)
        client.send("CREDIT", 0, subscription=subscription, frames=1)
        client.call("STATS")
        frames = [fields for name, about, fields in client.waiting if (name, about) == ("FRAME", request)]
        while len(frames) < 2:
            frames.append(client.receive_any()[2])
        self.assertEqual(frames[1]["sequence"], last["sequence"])
        self.assertEqual(frames[1]["skipped"], last["sequence"] - frames[0]["sequence"] - 1)

    def test_deltas_name_a_frame_that_was_acknowledged(self):
        client = self.open().open()
        forest = self.create(client)["forest"]
        request = client.next_request()
        client.send("SUBSCRIBE", request, forest=forest, kind=STRANDS, credit=1, deltas=1)
        subscription = client.answer(request)["subscription"]
        have, bases = [0], []
        for frame in range(1, 8):
            self.advance(client, forest, frame)
            name, _, seen = client.receive()
            self.assertEqual(name, "FRAME")
            self.assertIn(seen["base"], have)
            bases.append(seen["base"])
            have.append(seen["sequence"])
            client.send("CREDIT", 0, subscription=subscription, frames=1, have=seen["sequence"])
            client.call("STATS")
        self.assertEqual(bases[0], 0)
        self.assertTrue(all(bases[1:]), bases)

    def test_bye_ends_the_connection_and_leaves_the_forest(self):
        first, second = self.open().open(), self.open().open()
        made = self.create(first)
        first.send("BYE", reason="done")
        self.closed(first)
        second.call("ATTACH", forest=made["forest"], token=made["drive_token"])
        self.advance(second, made["forest"], 1)
        self.assertIn(made["forest"], [info["forest"] for info in second.call("LIST")["forests"]])


def main():
    global DAEMON
    if len(sys.argv) != 2:
        sys.exit("usage: test_stranger.py BUILD")
    DAEMON = Daemon(sys.argv[1])
    result = unittest.TextTestRunner(stream=sys.stdout, verbosity=1).run(
        unittest.defaultTestLoader.loadTestsFromTestCase(Stranger))
    code = DAEMON.stop()
    failed = len(result.failures) + len(result.errors) + (code != 0)
    if code != 0:
        print(f"FAIL: the daemon ended with {code}")
    print(f"{result.testsRun - failed} passed, {failed} failed, 0 skipped")
    sys.exit(failed != 0)


main()
