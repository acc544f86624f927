"""One connection of ZMTP 3.1 with CURVE, spoken byte by byte (RFC 23, 26; libsodium, no libzmq and no code of the
middleware): libzmq sends no part of a message before its last part is there, this does.
"""
import ctypes
import secrets
import socket
import struct

from authority import SODIUM

MORE, COMMAND, LONG = 1, 4, 2
INNER_MORE = 1
MAC = 16


def greeting(is_server):
    return b"\xff" + bytes(8) + b"\x7f\x03\x01" + b"CURVE".ljust(20, b"\0") + bytes([is_server]) + bytes(31)


def pair():
    public, secret = ctypes.create_string_buffer(32), ctypes.create_string_buffer(32)
    SODIUM.crypto_box_keypair(public, secret)
    return public.raw, secret.raw


def box(plain, nonce, public, secret):
    out = ctypes.create_string_buffer(len(plain) + MAC)
    if SODIUM.crypto_box_easy(out, plain, ctypes.c_ulonglong(len(plain)), nonce, public, secret):
        raise ValueError("no key")
    return out.raw


def unbox(sealed, nonce, public, secret):
    out = ctypes.create_string_buffer(max(1, len(sealed) - MAC))
    if SODIUM.crypto_box_open_easy(out, sealed, ctypes.c_ulonglong(len(sealed)), nonce, public, secret):
        raise ValueError("a box that cannot be opened")
    return out.raw[:len(sealed) - MAC]


class RawPeer:
    """`stream`: a connected TCP socket; keys are raw, of 32 bytes. With `server_key` this is the client, else the server."""

    def __init__(self, stream, public, secret, kind, server_key=None):
        self.stream, self.public, self.secret, self.kind = stream, public, secret, kind
        self.is_server = server_key is None
        self.nonces = 0
        self.short_public, self.short_secret = pair()
        stream.settimeout(20)
        stream.sendall(greeting(self.is_server))
        self.read(64)
        self.serve() if self.is_server else self.call(server_key)
        self.common = ctypes.create_string_buffer(32)
        SODIUM.crypto_box_beforenm(self.common, self.other, self.short_secret)

    # ---- the wire

    def read(self, size):
        out = b""
        while len(out) < size:
            got = self.stream.recv(size - len(out))
            if not got:
                raise ConnectionResetError("the other side has closed the connection")
            out += got
        return out

    def read_frame(self):
        flags = self.read(1)[0]
        size = struct.unpack(">Q", self.read(8))[0] if flags & LONG else self.read(1)[0]
        return self.read(size)

    def send_frame(self, body, flags=0):
        size = bytes([flags, len(body)]) if len(body) < 256 else struct.pack(">BQ", flags | LONG, len(body))
        self.stream.sendall(size + body)

    def next_nonce(self):
        self.nonces += 1
        return struct.pack(">Q", self.nonces)

    # ---- the handshake

    def metadata(self):
        return b"".join(bytes([len(name)]) + name + struct.pack(">I", len(value)) + value
                        for name, value in ((b"Socket-Type", self.kind), (b"Identity", b"")))

    def command(self, name):
        body = self.read_frame()
        if not body.startswith(name):
            raise ConnectionError(f"{body[:16]} instead of {name}")
        return body[len(name):]

    def call(self, server_key):
        nonce = self.next_nonce()
        self.send_frame(b"\x05HELLO\x01\x00" + bytes(72) + self.short_public + nonce +
                        box(bytes(64), b"CurveZMQHELLO---" + nonce, server_key, self.short_secret), COMMAND)
        welcome = self.command(b"\x07WELCOME")
        opened = unbox(welcome[16:], b"WELCOME-" + welcome[:16], server_key, self.short_secret)
        self.other, cookie = opened[:32], opened[32:]
        long = secrets.token_bytes(16)
        vouch = long + box(self.short_public + server_key, b"VOUCH---" + long, self.other, self.secret)
        nonce = self.next_nonce()
        self.send_frame(b"\x08INITIATE" + cookie + nonce +
                        box(self.public + vouch + self.metadata(), b"CurveZMQINITIATE" + nonce, self.other,
                            self.short_secret), COMMAND)
        ready = self.command(b"\x05READY")
        unbox(ready[8:], b"CurveZMQREADY---" + ready[:8], self.other, self.short_secret)

    def serve(self):
        hello = self.command(b"\x05HELLO")
        self.other = hello[74:106]
        unbox(hello[114:], b"CurveZMQHELLO---" + hello[106:114], self.other, self.secret)
        long = secrets.token_bytes(16)
        self.send_frame(b"\x07WELCOME" + long + box(self.short_public + bytes(96), b"WELCOME-" + long, self.other,
                                                    self.secret), COMMAND)
        initiate = self.command(b"\x08INITIATE")
        unbox(initiate[104:], b"CurveZMQINITIATE" + initiate[96:104], self.other, self.short_secret)
        nonce = self.next_nonce()
        self.send_frame(b"\x05READY" + nonce + box(self.metadata(), b"CurveZMQREADY---" + nonce, self.other,
                                                   self.short_secret), COMMAND)

    # ---- messages

    def send(self, part, more=False):
        """One part of a message; with `more` it is not the last."""
        nonce = self.next_nonce()
        name = b"CurveZMQMESSAGES" if self.is_server else b"CurveZMQMESSAGEC"
        plain = bytes([INNER_MORE if more else 0]) + part
        out = ctypes.create_string_buffer(len(plain) + MAC)
        SODIUM.crypto_box_easy_afternm(out, plain, ctypes.c_ulonglong(len(plain)), name + nonce, self.common)
        self.send_frame(b"\x07MESSAGE" + nonce + out.raw)

    def receive(self):
        body = self.command(b"\x07MESSAGE")
        name = b"CurveZMQMESSAGEC" if self.is_server else b"CurveZMQMESSAGES"
        sealed = body[8:]
        out = ctypes.create_string_buffer(len(sealed))
        if SODIUM.crypto_box_open_easy_afternm(out, sealed, ctypes.c_ulonglong(len(sealed)), name + body[:8], self.common):
            raise ValueError("a box that cannot be opened")
        return out.raw[1:len(sealed) - MAC]

    def send_parts(self, size, most):
        """Parts of this size without a last one, until the other side ends the connection, or `most` bytes. Returns how
        many bytes were sent, and whether it was ended.
        """
        part, sent = bytes(size), 0
        try:
            while sent < most:
                self.send(part, more=True)
                sent += size
        except (ConnectionError, socket.timeout):
            return sent, True
        return sent, False

    def close(self):
        self.stream.close()
