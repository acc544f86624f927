"""A client of the tests' own at a router's inbox (libzmq and wire.py, not the middleware's code), and a node's keys for it."""
import itertools
import json
import secrets
import time

import wire
import zmq
import zmq.utils.z85
from zmq.utils.monitor import parse_monitor_message

TARGET = "cloud"
WAIT = 20  # a deadline, not a measurement: for a starved machine
# Where such a client says that it can be dialled: nobody listens there.
NOBODY = "127.0.40.99:45000"
# ZMTP 3.0: signature, version, the mechanism NULL, not a server, filler.
PLAIN_GREETING = b"\xff" + bytes(7) + b"\x01\x7f" + b"\x03\x00" + b"NULL".ljust(20, b"\0") + b"\0" + bytes(31)


def make_context(case):
    """case.context: ZeroMQ's, for those that a test class plays; case: the class."""
    case.context = zmq.Context()
    case.addClassCleanup(case.context.term)


def to_z85(raw):
    return zmq.utils.z85.encode(raw)


class Member:
    """A node's keys and certificate, as in its folder."""

    def __init__(self, fleet, node):
        self.id = node
        keys = fleet.dir(node) / "keys"
        self.secret = to_z85(bytes.fromhex((keys / "link.key").read_text().strip()))
        self.public = zmq.curve_public(self.secret)
        self.certificate = wire.signed_record(json.loads((keys / "certificate.json").read_text())["certificate"])


class Client:
    """A DEALER that dials the target's inbox once."""

    boots = itertools.count(1)

    def __init__(self, context, address, server_key=None, keys=None, routing_id=None):
        self.socket = context.socket(zmq.DEALER)
        self.socket.setsockopt(zmq.LINGER, 0)
        self.socket.setsockopt(zmq.RECONNECT_IVL, -1)
        self.socket.setsockopt(zmq.SNDTIMEO, 10_000)  # without it a test would hang on an ended link
        if routing_id is not None:
            self.socket.setsockopt(zmq.ROUTING_ID, routing_id)
        if server_key is not None:
            public, secret = keys or zmq.curve_keypair()
            self.socket.curve_serverkey = server_key
            self.socket.curve_publickey, self.socket.curve_secretkey = public, secret
        self.events = self.socket.get_monitor_socket(
            zmq.EVENT_HANDSHAKE_SUCCEEDED | zmq.EVENT_DISCONNECTED | zmq.EVENT_HANDSHAKE_FAILED_AUTH |
            zmq.EVENT_HANDSHAKE_FAILED_PROTOCOL | zmq.EVENT_HANDSHAKE_FAILED_NO_DETAIL | zmq.EVENT_CLOSED)
        self.socket.connect("tcp://" + (address if ":" in address else f"{address}:45000"))
        self.link = secrets.randbits(63) | 1
        self.sequence = 0
        self.heard = 0
        self.ids = itertools.count(1)

    def close(self):
        self.socket.disable_monitor()
        self.events.close()
        self.socket.close()

    def wait_event(self, *wanted, timeout=WAIT):
        end = time.monotonic() + timeout
        while self.events.poll(max(0, int((end - time.monotonic()) * 1000))):
            event = parse_monitor_message(self.events.recv_multipart())["event"]
            if event in wanted:
                return event
        raise TimeoutError(f"none of the events {wanted} in {timeout} s")

    def send(self, subtype, source, target=TARGET, data=b"", link=None, sequence=None, **more):
        """The next frame of the link; returns its id. A foreign link or a given sequence leaves the own count alone."""
        ident = next(self.ids)
        if sequence is None and link is None:
            self.sequence += 1
        frame = wire.Frame(subtype, source, target, data=data, id=ident, link=self.link if link is None else link,
                           sequence=self.sequence if sequence is None else sequence, **more)
        self.socket.send(frame.encode())
        return ident

    def hello(self, certificate, source, boot=None):
        self.send("hello", source, data=wire.hello(certificate, boot or next(Client.boots), NOBODY))

    def receive(self, timeout=WAIT):
        if not self.socket.poll(int(timeout * 1000)):
            raise TimeoutError(f"nothing received in {timeout} s")
        frame = wire.decode(self.socket.recv())
        self.heard = frame.sequence
        return frame

    def receive_until(self, good, timeout=WAIT):
        end = time.monotonic() + timeout
        while True:
            frame = self.receive(max(0.0, end - time.monotonic()))
            if good(frame):
                return frame

    def wait_goodbye(self):
        return self.receive_until(lambda frame: frame.subtype == "goodbye").body()[0]

    def answer_to(self, ident):
        return self.receive_until(lambda frame: frame.reply_to == ident)
