"""The codec of awtd's messages, made from the tables of PROTOCOL.md and from nothing else of this repository.

Whoever reads the page can write a client: this file is the proof, since what the page does not say, it cannot encode.
A message's fields are a dict, name to value: integers, floats, bytes (raw and blob), str, lists of dicts (records);
a pose is a tuple of seven floats, position and orientation.
"""

import re
import struct

HEADER = struct.Struct("<IHHQ")
MUST_UNDERSTAND = 1
INTEGERS = {"u8": "<B", "u16": "<H", "u32": "<I", "u64": "<Q", "i64": "<q", "f32": "<f", "f64": "<d"}
POSE = struct.Struct("<7d")
AT_REST = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0)


class Malformed(Exception):
    """Bytes that the page's tables do not describe."""


class Reader:
    """Takes fields from a payload, never beyond its end."""

    def __init__(self, payload):
        self.payload = payload
        self.at = 0

    def take(self, size):
        if size > len(self.payload) - self.at:
            raise Malformed(f"{size} bytes at {self.at} of {len(self.payload)}")
        self.at += size
        return self.payload[self.at - size:self.at]

    def number(self, form):
        return struct.unpack(form, self.take(struct.calcsize(form)))[0]


def section_tables(text):
    """Yields (heading, rows) of each section of the page; rows are the cells of its first table, without its head."""
    for part in re.split(r"^### ", text, flags=re.M)[1:]:
        heading, _, body = part.partition("\n")
        table = re.search(r"^\| offset \|.*\n\|[-| ]*\n((?:\|.*\n)*)", body, flags=re.M)
        lines = table.group(1).splitlines() if table else []
        yield heading.strip(), [[cell.strip() for cell in line.strip("|").split("|")] for line in lines]


class Document:
    """Messages, records and error numbers of the page at `path`."""

    def __init__(self, path):
        with open(path, encoding="utf-8") as file:
            text = file.read()
        self.types, self.names, self.fields, self.records = {}, {}, {}, {}
        for heading, rows in section_tables(text):
            fields = [(row[1].strip("`"), row[2]) for row in rows]
            message = re.fullmatch(r"([A-Z_]+) \((0x[0-9a-f]{4}), \w+\)", heading)
            record = re.fullmatch(r"record (\w+)", heading)
            if message:
                self.types[message[1]] = int(message[2], 16)
                self.names[int(message[2], 16)] = message[1]
                self.fields[message[1]] = fields
            elif record:
                self.records[record[1]] = fields
        rows = re.findall(r"^\| (\d{3}) \| ([A-Z_]+) \| (yes|no) \| (yes|no) \|", text, flags=re.M)
        self.errors = {name: int(number) for number, name, _, _ in rows}
        self.closing = {int(number) for number, _, _, closes in rows if closes == "yes"}
        self.exchange = self.read_exchange(text)

    @staticmethod
    def read_exchange(text):
        """The worked exchange: (sender, message's name, bytes) in order."""
        found = []
        for sender, name, lines in re.findall(r"^(client|daemon): ([A-Z_]+),.*\n((?:[0-9a-f]{4}  .*\n)+)", text,
                                              flags=re.M):
            found.append((sender, name, bytes.fromhex("".join(line[6:] for line in lines.splitlines()))))
        return found

    # ---- writing ----

    def put(self, kind, value):
        """A field's bytes; `value` None: what is zero, empty or at rest."""
        if kind in INTEGERS:
            return struct.pack(INTEGERS[kind], value or 0)
        if kind == "pose":
            return POSE.pack(*(value or AT_REST))
        if kind.startswith("raw["):
            size = int(kind[4:-1])
            raw = value or bytes(size)
            assert len(raw) == size
            return raw
        what, greatest = kind.split(" <= ")
        assert len(value or "") <= int(greatest)
        if what == "str":
            encoded = (value or "").encode()
            return struct.pack("<H", len(encoded)) + encoded
        if what == "blob":
            return struct.pack("<I", len(value or b"")) + (value or b"")
        record = self.records[what.removeprefix("list of ")]
        items = [b"".join(self.put(k, item.get(n)) for n, k in record) for item in value or []]
        return struct.pack("<H", len(items)) + b"".join(items)

    def encode(self, name, request, fields):
        """A whole message, header and payload. Unknown field names are the caller's error."""
        assert not set(fields) - {field for field, _ in self.fields[name]}, f"{name} has no such field"
        payload = b"".join(self.put(kind, fields.get(field)) for field, kind in self.fields[name])
        return HEADER.pack(len(payload), self.types[name], MUST_UNDERSTAND, request) + payload

    # ---- reading ----

    def get(self, reader, kind):
        if kind in INTEGERS:
            return reader.number(INTEGERS[kind])
        if kind == "pose":
            return POSE.unpack(reader.take(POSE.size))
        if kind.startswith("raw["):
            return reader.take(int(kind[4:-1]))
        what, greatest = kind.split(" <= ")
        count = reader.number("<I" if what == "blob" else "<H")
        if count > int(greatest):
            raise Malformed(f"{count} is more than {greatest} of {what}")
        if what == "str":
            return reader.take(count).decode()
        if what == "blob":
            return reader.take(count)
        record = self.records[what.removeprefix("list of ")]
        return [{name: self.get(reader, k) for name, k in record} for _ in range(count)]

    def decode(self, name, payload):
        reader = Reader(payload)
        fields = {field: self.get(reader, kind) for field, kind in self.fields[name]}
        if reader.at != len(payload):
            raise Malformed(f"{name}: {len(payload) - reader.at} bytes are left")
        return fields
