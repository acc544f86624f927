"""Members that make their own seals (libsodium's Ed25519, hashlib's BLAKE2b, proto/README.md; no code of the
middleware), and the fleet in which seals_test.py and proof_test.py play them.
"""
import ctypes
import hashlib
import os
import time
import unittest

import zmq

import authority
import support
import trb_fleet
import wire
from router_client import Client, Member, make_context

BLOCK = 100
UDP_PORT = 50100
TARGET = "ant"
STRICT = "fox"  # wants messages sealed before they are delivered
MOST = 64
WAIT = 20  # a deadline, not a measurement: for a starved machine


def blake(data):
    return hashlib.blake2b(data, digest_size=32).digest()


class Signer(Member):
    """A member with its identity key, which signs as its router would."""

    def __init__(self, fleet, node):
        super().__init__(fleet, node)
        self.secret_key = bytes.fromhex((fleet.dir(node) / "keys" / "identity.key").read_text().strip())
        body, _ = wire.unpack(self.certificate[2])
        self.fleet, self.serial, self.identity = body[0], body[1], body[4]

    def sign(self, purpose, payload, key=None):
        message = b"talkrobots\0" + purpose.encode() + b"\0" + self.fleet + payload
        signature = ctypes.create_string_buffer(64)
        authority.SODIUM.crypto_sign_detached(signature, None, message, ctypes.c_ulonglong(len(message)),
                                              key or self.secret_key)
        return [purpose, self.id, payload, signature.raw]

    def has_signed(self, record):
        purpose, signer, payload, signature = record
        message = b"talkrobots\0" + purpose.encode() + b"\0" + self.fleet + payload
        return signer == self.id and 0 == authority.SODIUM.crypto_sign_verify_detached(
            signature, message, ctypes.c_ulonglong(len(message)), self.identity)


class Sealer(Client):
    """A member's end of a link that it dialled: it seals when told to, and checks the seals that it gets."""

    FIELDS = ("link", "serial", "peer_serial", "dialled", "first", "last", "previous", "hash", "utc")

    def __init__(self, context, fleet, member, target=TARGET):
        self.peer = Signer(fleet, target)
        super().__init__(context, fleet.address(target), self.peer.public, (member.public, member.secret))
        self.member = member
        self.open = []  # frames that are not sealed yet
        self.previous = bytes(32)
        self.heard_open = []
        self.heard_previous = bytes(32)
        self.seals_heard = 0

    def close(self):
        if not self.socket.closed:
            super().close()

    # ---- out

    def say(self, subtype, data=b"", **more):
        ident = next(self.ids)
        self.sequence += 1
        frame = wire.Frame(subtype, self.member.id, self.peer.id, data=data, id=ident, link=self.link,
                           sequence=self.sequence, **more).encode()
        self.socket.send(frame)
        self.open.append(frame)
        return ident

    def join(self, seal=None):
        """Sends Hello, as its router would, and receives the other side's."""
        body = [self.member.certificate, next(Client.boots), f"127.0.{BLOCK}.99:45000", "independent", time.time_ns(), True]
        if seal is not None:
            profile = ["", "", "", "", "", [], [], [], [], "", "", False, ""]
            body += [profile, 0, seal]
        self.say("hello", wire.pack(body))
        return self

    def range(self, **changes):
        """The contents of an honest seal over the open frames, except for the changes."""
        hashed = self.previous + b"".join(len(frame).to_bytes(4, "big") + frame for frame in self.open)
        honest = dict(link=self.link, serial=self.member.serial, peer_serial=self.peer.serial, dialled=True,
                      first=self.sequence - len(self.open) + 1, last=self.sequence, previous=self.previous,
                      hash=blake(hashed), utc=time.time_ns())
        return wire.pack([{**honest, **changes}[name] for name in self.FIELDS])

    def put_seal(self, record):
        """Sends a seal, good or not, with the next sequence."""
        self.sequence += 1
        frame = wire.Frame("seal", self.member.id, self.peer.id, data=wire.pack([record]), id=next(self.ids),
                           link=self.link, sequence=self.sequence).encode()
        self.socket.send(frame)
        self.previous = blake(record[2])
        self.open = []

    def seal(self, key=None, **changes):
        record = self.member.sign("seal", self.range(**changes), key)
        self.put_seal(record)
        return record

    def live(self):
        self.say("keep_alive", wire.keep_alive(self.heard))
        self.seal()

    # ---- in

    def receive(self, timeout=WAIT):
        if not self.socket.poll(int(timeout * 1000)):
            raise TimeoutError(f"nothing received in {timeout} s")
        raw = self.socket.recv()
        frame = wire.decode(raw)
        self.heard = frame.sequence
        if frame.subtype == "seal":
            self.check(frame)
        elif frame.subtype != "goodbye":
            self.heard_open.append(raw)
        return frame

    def check(self, frame):
        """The router's seal, by this file's own reading of the grammar."""
        record = frame.body()[0]
        stated = dict(zip(self.FIELDS, wire.unpack(record[2])[0]))
        hashed = self.heard_previous + b"".join(len(raw).to_bytes(4, "big") + raw for raw in self.heard_open)
        wanted = dict(link=self.link, serial=self.peer.serial, peer_serial=self.member.serial, dialled=False,
                      first=frame.sequence - len(self.heard_open), last=frame.sequence - 1, previous=self.heard_previous,
                      hash=blake(hashed))
        assert {name: stated[name] for name in wanted} == wanted, (stated, wanted)
        assert 0 < len(self.heard_open) <= MOST
        assert self.peer.has_signed(record), "the router's seal is not signed with its identity key"
        self.heard_previous, self.heard_open = blake(record[2]), []
        self.seals_heard += 1

    def receive_alive(self, good, timeout):
        """As receive_until, for what may take longer than a lease: a member that is silent meanwhile counts as gone."""
        end = time.monotonic() + timeout
        while time.monotonic() < end:
            self.live()
            try:
                return self.receive_until(good, 1)
            except TimeoutError:
                pass
        raise TimeoutError(f"not received in {timeout} s on a link that was kept alive")

    def drain(self):
        while self.socket.poll(0):
            yield self.receive(0)


class Case(unittest.TestCase):
    """A target with a scheduler, a good node, one that wants seals before delivery; cat and dog are played."""

    @classmethod
    def setUpClass(cls):
        make_context(cls)
        services = {TARGET: ["router", "scheduler"], "bee": ["router"], STRICT: ["router", "scheduler", "sensor-bus"],
                    "cat": ["router"], "dog": ["router"], "elk": ["router"], "gnu": ["router"]}
        cls.fleet = support.make_fleet(cls, Sealing, services=services, block=BLOCK, udp_port=UDP_PORT)
        cls.ear = cls.listen("task_progress")
        cls.fleet.bring_up(TARGET, "bee", STRICT)
        cls.cat, cls.dog = Signer(cls.fleet, "cat"), Signer(cls.fleet, "dog")

    @classmethod
    def listen(cls, *subtypes):
        """The strict node's sensor-bus, which wants copies of these."""
        ear = cls.context.socket(zmq.DEALER)
        cls.addClassCleanup(ear.close, 0)
        ear.connect(f"ipc://{cls.fleet.dir(STRICT)}/bus/sensor-bus.ipc")
        hello = wire.pack(["sensor-bus", [], 1, os.getpid(), "independent", list(subtypes)])
        ear.send(wire.Frame("service_hello", "", "", type=wire.COMMAND, id=1, data=hello).encode())
        return ear

    def setUp(self):
        self.fleet.wait("the fleet is linked", lambda: {"bee", STRICT} <= self.online(), 60)
        self.links = {name: self.routes()[name]["link"] for name in ("bee", STRICT)}
        self.pid = self.fleet.pid(TARGET, "router")
        self.watch = support.Watch(self.fleet, TARGET)

    def tearDown(self):
        """After any member's act: no other link was lost, and the router is the same process."""
        self.assertEqual({name: self.routes()[name]["link"] for name in self.links}, self.links)
        self.assertEqual(self.fleet.pid(TARGET, "router"), self.pid)

    def routes(self, node=TARGET):
        return {row["id"]: row for row in self.fleet.json("route", "list", node=node)["routes"]}

    def online(self, node=TARGET):
        return {name for name, row in self.routes(node).items() if row["state"] == "ONLINE"}

    def dial(self, member=None, target=TARGET):
        client = Sealer(self.context, self.fleet, member or self.cat, target)
        self.addCleanup(client.close)
        return client

    def joined(self, member=None, target=TARGET, seal=None):
        client = self.dial(member, target).join(seal)
        self.assertEqual(client.receive().subtype, "hello")
        return client

    def ask_router(self, client):
        return client.say("route_list", wire.pack([]), type=wire.REQUEST)

    def ask_scheduler(self, client):
        return client.say("run_list", wire.pack([]), type=wire.REQUEST)

    def assert_good(self, client):
        """Its message arrives, its seal is accepted, and it gets a seal over the answer."""
        ident = self.ask_router(client)
        client.seal()
        self.assertEqual(client.answer_to(ident).subtype, "route_table")
        before = client.seals_heard
        client.receive_until(lambda frame: frame.subtype == "seal")
        self.assertEqual(client.seals_heard, before + 1)

    def assert_alarm(self, client, reason, watch=None):
        """Refused under its own name and no other, reported to the peer and in the log; and it may come back."""
        watch = watch or self.watch
        self.assertEqual(client.wait_goodbye(), f"seal_broken: {reason}")
        watch.wait_counted(f"refused.seal_{reason}")
        watch.wait_logged(f"seal_alarm_{reason} link {client.link} of {client.member.id}, after sequence ")
        self.assertEqual(watch.rise(), {f"refused.seal_{reason}": 1})
        self.assertEqual(watch.log().count("seal_alarm_"), 1)
        self.assert_good(self.joined(client.member, client.peer.id))


class Sealing(support.RouterFleet):
    """The strict node's sensor-bus is played by a test."""

    def start_node(self, node):
        without = ["--without", "sensor-bus"] if node == STRICT else []
        up = [self.programs / "trb", "up", self.dir(node), *without, "--die-with-parent"]
        self.nodes[node] = trb_fleet.Process(up, self.root / f"up-{node}.log")

    def node_json(self, node):
        more = {"seal": "before_delivery"} if node == STRICT else {}
        return {**super().node_json(node), **more}
