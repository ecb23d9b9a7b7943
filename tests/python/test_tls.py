"""TLS under the protocol: a relay with a certificate before the daemon, and those that TLS is to keep out."""

import contextlib
import os
import select
import shutil
import socket
import ssl
import subprocess
import threading
import unittest

import awtd
import numpy as np
from harness import WithDaemon, ended
from test_state import hair_file

ADDRESS, CLOSED, TIMEOUT, PEER = -1, -3, -4, -5  # awtlink.h


class Listener:
    """A port on the loopback; whatever connects is given to `serve` in a thread of its own."""

    def __init__(self, serve):
        self.listener = socket.create_server(("127.0.0.1", 0))
        self.port = self.listener.getsockname()[1]
        self.sockets = []
        threading.Thread(target=self.run, args=(serve,), daemon=True).start()

    def run(self, serve):
        while True:
            try:
                peer, _ = self.listener.accept()
            except OSError:
                return
            self.sockets.append(peer)
            threading.Thread(target=serve, args=(peer,), daemon=True).start()

    def close(self):
        for one in [self.listener, *self.sockets]:
            try:
                one.shutdown(socket.SHUT_RDWR)
            except OSError:
                pass
            one.close()


def hand_on(inner, daemon):
    """Bytes both ways until either end is gone. In one thread: a connection of Python's ssl is not for two."""
    try:
        while True:
            ready = [inner] if inner.pending() else select.select([inner, daemon], [], [])[0]
            for one in ready:
                piece = one.recv(1 << 16)
                if not piece:
                    return
                (daemon if one is inner else inner).sendall(piece)
    except (OSError, ValueError):
        pass


@unittest.skipUnless(shutil.which("openssl"), "openssl is not here")
class Tls(WithDaemon):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.certificate, key = (os.path.join(cls.folder.name, name) for name in ("certificate", "key"))
        subprocess.run(["openssl", "req", "-x509", "-newkey", "rsa:2048", "-nodes", "-days", "2", "-subj",
                        "/CN=hair.test", "-addext", "subjectAltName=DNS:hair.test,IP:127.0.0.1", "-keyout", key, "-out",
                        cls.certificate], check=True, stderr=subprocess.DEVNULL)
        cls.serving = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
        cls.serving.load_cert_chain(cls.certificate, key)

    def listen(self, serve):
        listener = Listener(serve)
        self.addCleanup(listener.close)
        return listener

    def relay(self):
        """Takes TLS, and hands on plain bytes to the daemon."""
        host, port = self.address.rsplit(":", 1)

        def serve(peer):
            with contextlib.suppress(OSError), self.serving.wrap_socket(peer, server_side=True) as inner:
                listener.sockets.append(inner)
                with socket.create_connection((host, int(port))) as daemon:
                    hand_on(inner, daemon)

        listener = self.listen(serve)
        return listener

    def trusting(self):
        return ssl.create_default_context(cafile=self.certificate)

    def fails(self, port, code, **options):
        """The AwtError of connecting there, in the end."""
        options.setdefault("ssl", self.trusting())
        error = ended(lambda: awtd.connect(f"127.0.0.1:{port}", self.token, **options).close())
        self.assertIsInstance(error, awtd.AwtError)
        self.assertEqual(error.code, code, error)
        self.assertTrue(error.text)
        return error

    def test_hair_is_the_same_through_tls(self):
        address = f"127.0.0.1:{self.relay().port}"
        context = self.trusting()
        forest = self.connect(address, ssl=context).create("short", strands=300)
        viewer = self.connect(address, ssl=context, server_hostname="hair.test")
        watched = viewer.attach(forest.handle, forest.view_token)
        frames = watched.subscribe(kind="strands", deltas=True)
        plain = self.connect().attach(forest.handle, forest.drive_token)
        for step in range(1, 13):
            driven = forest.drive(step * 16667, awtd.Pose((0.01 * step, 0, 0)))
            seen = next(frames)
            self.assertEqual(seen.sequence, driven.sequence)
            np.testing.assert_array_equal(seen.positions, driven.positions)
            np.testing.assert_array_equal(plain.latest().positions, driven.positions)

    def test_megabytes_go_through_tls_both_ways(self):
        client = self.connect(f"127.0.0.1:{self.relay().port}", ssl=self.trusting())
        path = self.path("large.hair")
        with open(path, "wb") as file:
            file.write(hair_file(30000))
        forest = client.create(upload=client.upload(path), scale=0.01, up="z", head_radius=9)
        snapshot = forest.snapshot()
        self.assertGreater(len(snapshot), 1 << 20)
        again = client.restore(snapshot)
        np.testing.assert_array_equal(again.drive(16667).positions, forest.drive(16667).positions)

    def test_a_certificate_that_does_not_verify(self):
        error = self.fails(self.relay().port, PEER, ssl=ssl.create_default_context())
        self.assertIsInstance(error.__cause__, ssl.SSLCertVerificationError)
        error = self.fails(self.relay().port, PEER, server_hostname="other.test")
        self.assertIsInstance(error.__cause__, ssl.SSLCertVerificationError)

    def test_who_does_not_speak_tls(self):
        def garbage(peer):
            peer.sendall(b"HTTP/1.1 400 Bad Request\r\n\r\n")

        self.fails(self.listen(garbage).port, PEER)
        self.fails(int(self.address.rsplit(":", 1)[1]), PEER)  # the daemon itself

    def test_who_never_answers_the_handshake_of_tls(self):
        self.fails(self.listen(lambda peer: None).port, TIMEOUT, timeout_s=0.3)

    def test_who_shakes_hands_and_says_no_more(self):
        def serve(peer):
            listener.sockets.append(self.serving.wrap_socket(peer, server_side=True))

        listener = self.listen(serve)
        self.fails(listener.port, TIMEOUT, timeout_s=0.5)

    def test_nobody_is_there(self):
        listener = self.listen(lambda peer: None)
        listener.close()
        self.fails(listener.port, ADDRESS)
        for wrong in ("nowhere", "127.0.0.1:http", "127.0.0.1:70000"):
            with self.assertRaises(awtd.AwtError) as raised:
                awtd.connect(wrong, ssl=self.trusting())
            self.assertEqual(raised.exception.code, ADDRESS)
        with self.assertRaises(ValueError):
            awtd.connect(self.address, self.token, server_hostname="hair.test")

    def test_a_connection_that_is_cut(self):
        relay = self.relay()
        client = self.connect(f"127.0.0.1:{relay.port}", ssl=self.trusting())
        client.stats()
        relay.close()
        error = ended(client.stats)
        self.assertIsInstance(error, awtd.AwtError)
        self.assertIn(error.code, (CLOSED, PEER))
        self.assertIsInstance(ended(client.stats), awtd.AwtError)
        client.close()
        client.close()
