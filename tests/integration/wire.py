"""The wire of proto/README.md, written from its grammar alone, deliberately without the C++ code: 24 bytes of prefix, a
msgpack header of six, then the data. Only what the grammar needs of msgpack is here.
"""
import dataclasses
import struct

VERSION = 2
COMMAND, REQUEST, INFORMATION = 1, 2, 3
PREFIX = struct.Struct(">BBHIQQ")


class WireError(ValueError):
    """Bytes that violate the grammar."""


# ---- msgpack

def pack(value):
    if value is None:
        return b"\xc0"
    if isinstance(value, bool):
        return b"\xc3" if value else b"\xc2"
    if isinstance(value, int):
        return _pack_integer(value)
    if isinstance(value, float):
        return b"\xcb" + struct.pack(">d", value)
    if isinstance(value, str):
        raw = value.encode()
        return _head(len(raw), ((0xA0, 31), (0xD9, 0xFF), (0xDA, 0xFFFF), (0xDB, 0xFFFFFFFF))) + raw
    if isinstance(value, (bytes, bytearray)):
        return _head(len(value), ((None, -1), (0xC4, 0xFF), (0xC5, 0xFFFF), (0xC6, 0xFFFFFFFF))) + bytes(value)
    if isinstance(value, (list, tuple)):
        head = _head(len(value), ((0x90, 15), (None, -1), (0xDC, 0xFFFF), (0xDD, 0xFFFFFFFF)))
        return head + b"".join(pack(item) for item in value)
    raise TypeError(f"no msgpack for {type(value)}")


def _head(size, forms):
    """The smallest form that fits: in the tag itself, or one, two or four bytes after it."""
    for (tag, most), width in zip(forms, (0, 1, 2, 4)):
        if size <= most:
            return bytes([tag | size]) if width == 0 else bytes([tag]) + size.to_bytes(width, "big")
    raise WireError(f"{size} is too long")


def _pack_integer(value):
    if 0 <= value < 128 or -32 <= value < 0:
        return struct.pack(">b", value)
    signed = value < 0
    for tag, form in zip((0xD0, 0xD1, 0xD2, 0xD3) if signed else (0xCC, 0xCD, 0xCE, 0xCF), "bhiq" if signed else "BHIQ"):
        try:
            return bytes([tag]) + struct.pack(">" + form, value)
        except struct.error:
            continue
    raise WireError(f"{value} has over 64 bits")


NUMBERS = {0xCA: "f", 0xCB: "d", 0xCC: "B", 0xCD: "H", 0xCE: "I", 0xCF: "Q", 0xD0: "b", 0xD1: "h", 0xD2: "i", 0xD3: "q"}
LENGTHS = {0xC4: (bytes, 1), 0xC5: (bytes, 2), 0xC6: (bytes, 4), 0xD9: (str, 1), 0xDA: (str, 2), 0xDB: (str, 4),
           0xDC: (list, 2), 0xDD: (list, 4)}


def unpack(data, at=0):
    """The value that begins at `at`, and where it ends."""
    tag, at = _take(data, at, 1)[0], at + 1
    if tag < 0x80:
        return tag, at
    if tag >= 0xE0:
        return tag - 0x100, at
    if tag in (0xC0, 0xC2, 0xC3):
        return {0xC0: None, 0xC2: False, 0xC3: True}[tag], at
    if tag in NUMBERS:
        form = ">" + NUMBERS[tag]
        size = struct.calcsize(form)
        return struct.unpack(form, _take(data, at, size))[0], at + size
    if 0x90 <= tag < 0xA0:
        return _unpack_list(data, at, tag & 15)
    if 0xA0 <= tag < 0xC0:
        kind, width, size = str, 0, tag & 31
    elif tag in LENGTHS:
        kind, width = LENGTHS[tag]
        size = int.from_bytes(_take(data, at, width), "big")
    else:
        raise WireError(f"tag {tag:#x} has no place on this wire")
    if kind is list:
        return _unpack_list(data, at + width, size)
    raw = _take(data, at + width, size)
    return (raw.decode() if kind is str else raw), at + width + size


def _unpack_list(data, at, count):
    items = []
    for _ in range(count):
        item, at = unpack(data, at)
        items.append(item)
    return items, at


def _take(data, at, size):
    if at + size > len(data):
        raise WireError("cut off")
    return data[at:at + size]


# ---- frames

@dataclasses.dataclass
class Frame:
    subtype: str
    source: str
    target: str
    type: int = INFORMATION
    flags: int = 0
    remaining_ms: int = 10_000
    link: int = 0
    sequence: int = 0
    id: int = 0
    reply_to: int = 0
    data: bytes = b""

    def encode(self):
        prefix = PREFIX.pack(VERSION, self.type, self.flags, self.remaining_ms, self.link, self.sequence)
        header = [self.subtype, self.source, self.target, self.id, self.reply_to, len(self.data)]
        return prefix + pack(header) + self.data

    def body(self):
        value, end = unpack(self.data)
        if end != len(self.data):
            raise WireError("bytes after the body")
        return value


def decode(frame):
    if len(frame) < PREFIX.size:
        raise WireError("shorter than its prefix")
    version, kind, flags, remaining, link, sequence = PREFIX.unpack_from(frame)
    if version != VERSION or kind not in (COMMAND, REQUEST, INFORMATION):
        raise WireError(f"version {version}, type {kind}")
    header, end = unpack(frame, PREFIX.size)
    if not isinstance(header, list) or len(header) < 6:
        raise WireError("the header is no array of six")
    subtype, source, target, ident, reply_to, size = header[:6]
    if len(frame) - end != size:
        raise WireError(f"{len(frame) - end} bytes of data, the header says {size}")
    return Frame(subtype, source, target, kind, flags, remaining, link, sequence, ident, reply_to, frame[end:])


# ---- bodies: msgpack arrays in the order of proto/bodies

def signed_record(record):
    """A SignedRecord from its JSON, as a body."""
    return [record["kind"], record["signer"], bytes.fromhex(record["payload"]), bytes.fromhex(record["signature"])]


def hello(certificate, boot, address):
    """Without its tail (utc, clock_verified, profile): a shorter array leaves those at their defaults."""
    return pack([certificate, boot, address, "independent"])


def keep_alive(heard):
    return pack([heard])


NACK_FIELDS = ("code", "subtype", "target", "what", "cure")


def nack(frame):
    return dict(zip(NACK_FIELDS, frame.body()))
