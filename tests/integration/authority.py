"""A fleet authority's key in the hands of a test: signs what `trb fleet` never would. Independent of the C++ code, by
libsodium itself and proto/README.md.
"""
import ctypes
import ctypes.util
import hashlib
import json
import secrets
import time

import wire

SODIUM = ctypes.CDLL(ctypes.util.find_library("sodium") or "libsodium.so.23")
SODIUM.sodium_init()
SALT, NONCE, MAC, KEY = 16, 24, 16, 32
SECOND = 1_000_000_000
DAY = 86_400 * SECOND


def sign_with(secret, purpose, signer, fleet, payload):
    """A SignedRecord, as a body, made with an Ed25519 key of 64 bytes."""
    message = b"talkrobots\0" + purpose.encode() + b"\0" + fleet + payload
    signature = ctypes.create_string_buffer(64)
    SODIUM.crypto_sign_detached(signature, None, message, ctypes.c_ulonglong(len(message)), secret)
    return [purpose, signer, payload, signature.raw]


def box(own_secret, other_public, plain):
    """What only the other side can open: a nonce and a box, made with raw link keys of 32 bytes."""
    nonce = secrets.token_bytes(24)
    out = ctypes.create_string_buffer(len(plain) + MAC)
    if SODIUM.crypto_box_easy(out, plain, ctypes.c_ulonglong(len(plain)), nonce, other_public, own_secret):
        raise ValueError("no key")
    return nonce + out.raw


def unbox(own_secret, other_public, sealed):
    out = ctypes.create_string_buffer(max(len(sealed) - 24 - MAC, 1))
    size = ctypes.c_ulonglong(len(sealed) - 24)
    if SODIUM.crypto_box_open_easy(out, sealed[24:], size, sealed[:24], other_public, own_secret):
        raise ValueError("it does not open")
    return out.raw[:len(sealed) - 24 - MAC]


class Authority:
    def __init__(self, folder, passphrase):
        raw = bytes.fromhex((folder / "authority.key").read_text().strip())
        salt, nonce, box = raw[:SALT], raw[SALT:SALT + NONCE], raw[SALT + NONCE:]
        key = ctypes.create_string_buffer(KEY)
        limits = (ctypes.c_ulonglong(3), ctypes.c_size_t(64 << 20), 2)  # MODERATE, INTERACTIVE, argon2id 1.3
        word = passphrase.encode()
        if SODIUM.crypto_pwhash(key, ctypes.c_ulonglong(KEY), word, ctypes.c_ulonglong(len(word)), salt, *limits):
            raise MemoryError
        plain = ctypes.create_string_buffer(len(box) - MAC)
        if SODIUM.crypto_secretbox_open_easy(plain, box, ctypes.c_ulonglong(len(box)), nonce, key):
            raise ValueError("the passphrase is wrong")
        self.secret, self.beacon_key = plain.raw[:64], plain.raw[64:]
        public = bytes.fromhex(json.loads((folder / "fleet.json").read_text())["authority_key"])
        self.fleet = hashlib.blake2b(public, digest_size=32).digest()[:16]

    def sign(self, purpose, payload, fleet=None):
        """A SignedRecord of the authority, as a body."""
        return sign_with(self.secret, purpose, "", fleet or self.fleet, payload)

    def certificate(self, old, serial=None, begins=-DAY, ends=DAY, role=None, link_key=None, relay=None):
        """A certificate like `old` (a SignedRecord as a body); times from now."""
        body, _ = wire.unpack(old[2])
        now = time.time_ns()
        body[1] = body[1] if serial is None else serial
        body[3] = body[3] if role is None else role
        body[5] = link_key or body[5]
        body[6:8] = now + begins, now + ends
        body[8] = body[8] if relay is None else relay
        return self.sign("certificate", wire.pack(body))

    def revocations(self, number, revoked=(), beacon_number=1):
        rows = [[serial, ident, "a test", time.time_ns()] for serial, ident in revoked]
        payload = wire.pack([self.fleet, number, time.time_ns(), rows, beacon_number, []])
        return self.sign("revocation_list", payload)


def news(revocations=None, certificates=()):
    """A fleet_news body."""
    return wire.pack([revocations or ["", "", b"", b""], list(certificates)])


def seal_beacon(key, number, fleet, plain):
    """A beacon's datagram: magic, key number, fleet hint, nonce, box."""
    nonce = bytes(NONCE)
    box = ctypes.create_string_buffer(len(plain) + MAC)
    SODIUM.crypto_secretbox_easy(box, plain, ctypes.c_ulonglong(len(plain)), nonce, key)
    return b"TRBB" + number.to_bytes(4, "big") + fleet[:4] + nonce + box.raw
