"""A client of awtd in another language, written from PROTOCOL.md alone with Python's standard library."""

import hashlib
import hmac
import os
import socket
import time

from document import HEADER


class DaemonError(Exception):
    """An ERROR that the daemon sent."""

    def __init__(self, fields):
        super().__init__(f"{fields['code']}: {fields['text']}")
        self.code = fields["code"]
        self.fields = fields


class Closed(Exception):
    """The connection has ended."""


class Client:
    """One connection. `token` None: whatever comes, no AUTH is sent."""

    def __init__(self, document, address, token=None, timeout_s=60.0):
        self.document = document
        self.socket = socket.create_connection(address, timeout_s)
        self.socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self.token = token
        self.last_request = 0
        self.waiting = []  # messages that came while another one's answer was awaited

    def close(self):
        self.socket.close()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    # ---- messages ----

    def send(self, name, request=0, /, **fields):
        self.socket.sendall(self.document.encode(name, request, fields))

    def take_bytes(self, size):
        pieces = bytearray()
        while len(pieces) < size:
            piece = self.socket.recv(min(size - len(pieces), 1 << 20))
            if not piece:
                raise Closed()
            pieces += piece
        return bytes(pieces)

    def receive_any(self):
        """The next message: (name, request, fields). PINGs are answered on the way."""
        while True:
            length, kind, _, request = HEADER.unpack(self.take_bytes(HEADER.size))
            payload = self.take_bytes(length)
            name = self.document.names[kind]
            fields = self.document.decode(name, payload)
            if name != "PING":
                return name, request, fields
            now_us = time.monotonic_ns() // 1000
            self.send("PONG", request, sent_us=fields["sent_us"], received_us=now_us, answered_us=now_us)

    def receive(self):
        return self.waiting.pop(0) if self.waiting else self.receive_any()

    def next_request(self):
        self.last_request += 1
        return self.last_request

    def call(self, name, /, **fields):
        """Sends a request and returns its answer's fields; what else comes meanwhile waits for `receive`."""
        request = self.next_request()
        self.send(name, request, **fields)
        return self.answer(request)

    def answer(self, request):
        while True:
            name, about, fields = self.receive_any()
            if about != request or name == "PROGRESS":
                self.waiting.append((name, about, fields))
            elif name == "ERROR":
                raise DaemonError(fields)
            else:
                return fields

    # ---- the handshake ----

    def greet(self, lowest=1, highest=1, magic=b"AWTD"):
        name = "stranger 1"
        length = 4 + 1 + 1 + 2 + 16 + 2 + len(name)
        self.send("HELLO", self.next_request(), magic=magic, lowest_version=lowest, highest_version=highest,
                  length=length, routing_key=os.urandom(16), client=name)
        name, _, fields = self.receive_any()
        if name == "ERROR":
            raise DaemonError(fields)
        return fields

    def prove(self, text, first, second):
        return hmac.new(self.token, text + first + second, hashlib.sha256).digest()

    def open(self):
        """HELLO and, where the daemon wants it, AUTH; checks that the daemon holds the token too."""
        welcome = self.welcome = self.greet()
        if welcome["auth_required"]:
            nonce = os.urandom(32)
            reply = self.call("AUTH", nonce=nonce, proof=self.prove(b"awtd auth 1", welcome["nonce"], nonce))
            if not hmac.compare_digest(reply["proof"], self.prove(b"awtd server 1", nonce, welcome["nonce"])):
                raise Closed()
        return self

    # ---- longer conversations ----

    def upload(self, number, content, piece_size=4096):
        sha256 = hashlib.sha256(content).digest()
        for at in range(0, len(content), piece_size):
            reply = self.call("UPLOAD", upload=number, total=len(content), offset=at, sha256=sha256,
                              piece=content[at:at + piece_size])
            assert reply["received"] == min(at + piece_size, len(content))
