"""A small fleet under attack: two honest nodes exchange requests all the time, their links, memory and descriptors
watched; the attackers are members with valid keys, played by this folder's own client (wire.py, sealer.py).
"""
import itertools
import os
import threading
import time
import unittest

import zmq

import authority
import sealer
import support
import trb_fleet
import wire

TARGET, FRIEND = "ant", "bee"
ATTACKERS = ("cat", "dog", "elk", "fox", "gnu", "hen", "ibis", "jay", "kite", "lark")
SANITIZED = support.is_sanitized()
SLOWEST_S = 6 if SANITIZED else 1.5  # an honest answer, on a machine that others use too
MEMORY_MIB = 96  # what an attack may use while it lasts: see "Memory" in services/router/README.md
DESCRIPTORS = 64
RELAY_SERIAL = itertools.count(1000)


def resident(pid):
    """MiB."""
    with open(f"/proc/{pid}/status") as file:
        return next(int(line.split()[1]) for line in file if line.startswith("VmRSS:")) / 1024


def descriptors(pid):
    return len(os.listdir(f"/proc/{pid}/fd"))


class Service:
    """A DEALER on a node's bus: honest or not, depending on its messages."""

    def __init__(self, context, endpoint, name="cli", subtypes=(), server_key=None, keys=None, welcome=True, hears=()):
        self.socket = context.socket(zmq.DEALER)
        self.socket.setsockopt(zmq.LINGER, 0)
        self.socket.setsockopt(zmq.SNDTIMEO, 10_000)
        if server_key:
            self.socket.curve_serverkey = server_key
            self.socket.curve_publickey, self.socket.curve_secretkey = keys
        self.socket.connect(endpoint)
        self.name, self.count, self.slot = name, 0, 0
        if welcome:
            self.hello(name, subtypes, hears)
            self.slot = self.hear(lambda frame: frame.subtype == "service_welcome", 20).body()[2]

    def hello(self, name, subtypes=(), hears=()):
        body = wire.pack([name, list(subtypes), 1, os.getpid(), "independent", list(hears)])
        self.socket.send(wire.Frame("service_hello", "", "", type=wire.COMMAND, id=1, data=body).encode())

    def say(self, source, target, subtype, data=b"", kind=wire.COMMAND, **more):
        self.count += 1
        ident = more.pop("id", self.slot << 48 | self.count)
        self.socket.send(wire.Frame(subtype, source, target, type=kind, id=ident, data=data, **more).encode())
        return ident

    def hear(self, good, timeout=20):
        end = time.monotonic() + timeout
        while self.socket.poll(max(0, int((end - time.monotonic()) * 1000))):
            frame = wire.decode(self.socket.recv())
            if good(frame):
                return frame
        raise TimeoutError(f"{self.name} heard nothing of the kind in {timeout} s")

    def drain(self):
        frames = []
        while self.socket.poll(0):
            frames.append(wire.decode(self.socket.recv()))
        return frames

    def close(self):
        self.socket.close(0)


class Honest(threading.Thread):
    """Sends requests from one honest node to another, pauses 20 ms at most, keeps each answer's time."""

    def __init__(self, fleet, at=FRIEND, other=TARGET):
        super().__init__(daemon=True)
        self.fleet, self.at, self.other = fleet, at, other
        self.ended = threading.Event()
        self.times, self.fault = [], None

    def wait_answers(self, count):
        """Waits for this many more answers; `fault` holds the reason if they do not come."""
        count, end = count + len(self.times), time.monotonic() + 15
        while len(self.times) < count and self.is_alive() and time.monotonic() < end:
            self.ended.wait(0.01)

    def end(self):
        self.ended.set()
        self.join(15)

    def run(self):
        context = zmq.Context()
        try:
            asker = Service(context, f"ipc://{self.fleet.dir(self.at)}/bus/probe.ipc")
            while not self.ended.wait(0.02):
                began = time.monotonic()
                ident = asker.say(self.at, self.other, "echo_request", wire.pack([b"are you there"]), wire.REQUEST)
                answer = asker.hear(lambda frame: frame.reply_to == ident, 10)
                if answer.subtype != "echo":
                    raise AssertionError(f"{answer.subtype} {answer.data}")
                self.times.append(time.monotonic() - began)
            asker.close()
        except (TimeoutError, AssertionError, zmq.ZMQError) as fault:
            self.fault = fault
        finally:
            context.destroy(0)


class Attacker(sealer.Sealer):
    """A member's link, correctly sealed, whatever else it sends."""

    def __init__(self, case, name, target=TARGET, certificate=None):
        member = sealer.Signer(case.fleet, name)
        if certificate:
            member.certificate = certificate
            member.serial = wire.unpack(certificate[2])[0][1]
        super().__init__(case.context, case.fleet, member, target)
        self.socket.setsockopt(zmq.SNDTIMEO, 5_000)
        self.hello_tail = {}

    def join(self, **changes):
        """`changes`: by the names of Hello's fields."""
        body = dict(certificate=self.member.certificate, boot=next(sealer.Client.boots), address="127.0.180.99:45000",
                    version="independent", utc=time.time_ns(), clock_verified=True,
                    profile=["", "", "", "", "", [], [], [], [], "", "", False, ""], revocations=0, seal="behind",
                    relay=False, lane="")
        self.say("hello", wire.pack(list({**body, **changes}.values())))
        return self

    def put(self, subtype, data=b"", **more):
        """As say(), and a seal behind each 32nd."""
        ident = self.say(subtype, data, **more)
        if len(self.open) >= 32:
            self.seal()
        return ident

    def nacks(self, wait=0.5, least=0):
        """The codes of what came back, until nothing more comes for so long; for the first ones there is more time."""
        codes = []
        while True:
            try:
                frame = self.receive(20 if len(codes) < least else wait)
            except TimeoutError:
                return codes
            if frame.subtype == "nack":
                codes.append(wire.nack(frame)["code"])


class Case(unittest.TestCase):
    """Each test is one attempt, made inside `with self.attempt(...)`."""

    BLOCK, UDP_PORT = 180, 50180
    services = {name: ["router"] for name in (TARGET, FRIEND, *ATTACKERS)}
    kind = support.RouterFleet

    @classmethod
    def setUpClass(cls):
        cls.context = zmq.Context()
        cls.addClassCleanup(cls.context.destroy, 0)
        cls.fleet = support.make_fleet(cls, cls.kind, services=cls.services, block=cls.BLOCK, udp_port=cls.UDP_PORT)
        cls.play()
        cls.fleet.bring_up(TARGET, FRIEND)
        cls.fleet.wait("the honest are linked", lambda: cls.row(FRIEND)["state"] == "ONLINE", 60)
        cls.pids = {node: cls.fleet.pid(node, "router") for node in (TARGET, FRIEND)}

    @classmethod
    def play(cls):
        """Services that this file plays, before the nodes start."""

    @classmethod
    def row(cls, node, at=TARGET):
        rows = cls.fleet.json("route", "list", node=at)["routes"]
        return next((row for row in rows if row["id"] == node), {"state": "unknown", "link": 0})

    def attacker(self, name, **hello):
        """A member's link that is up."""
        one = Attacker(self, name, certificate=hello.pop("certificate", None))
        self.addCleanup(one.close)
        one.join(**hello)
        one.receive_until(lambda frame: frame.subtype == "hello")
        return one

    def relay(self, name):
        """The same with the right to relay."""
        key = authority.Authority(self.fleet.authority_dir(), self.fleet.passphrase())
        certificate = key.certificate(sealer.Signer(self.fleet, name).certificate, serial=next(RELAY_SERIAL), relay=True)
        return self.attacker(name, certificate=certificate, relay=True)

    def attempt(self, *counted, prefixes=("refused.", "dropped.")):
        return Attempt(self, counted, prefixes)


class Attempt:
    """While it lasts the honest nodes go on; at its end no other node is harmed, and each named refusal was counted."""

    def __init__(self, case, counted, prefixes):
        self.case, self.counted, self.prefixes = case, counted, prefixes

    def links(self):
        return {at: self.case.row(other, at)["link"] for at, other in ((TARGET, FRIEND), (FRIEND, TARGET))}

    def __enter__(self):
        fleet = self.case.fleet
        self.pids = self.case.pids
        self.before = self.links()
        self.memory = {node: resident(pid) for node, pid in self.pids.items()}
        self.open = {node: descriptors(pid) for node, pid in self.pids.items()}
        self.watch = support.Watch(fleet, TARGET)
        self.honest = Honest(fleet)
        self.honest.start()
        self.honest.wait_answers(1)
        return self

    def __exit__(self, kind, *_):
        self.honest.wait_answers(10)
        self.honest.end()
        if kind is not None:
            return
        case = self.case
        case.assertIsNone(self.honest.fault, "an honest node was not answered")
        support.assert_quick(case, self.honest.times, SLOWEST_S)
        case.assertEqual(self.links(), self.before, "an honest link was lost")
        for node, pid in self.pids.items():
            case.assertTrue(os.path.exists(f"/proc/{pid}"), f"the router of {node} has ended")
            if not SANITIZED:
                case.assertLess(resident(pid) - self.memory[node], MEMORY_MIB)
            case.assertLess(descriptors(pid) - self.open[node], DESCRIPTORS)
        for name in self.counted:
            self.watch.wait_counted(name, prefixes=self.prefixes)
        worst = max(self.honest.times)
        print(f"honest: {len(self.honest.times)} answers, worst {worst * 1000:.0f} ms; "
              f"{self.watch.rise(self.prefixes) or 'nothing refused'};", end=" ", flush=True)


class PlayedFleet(support.RouterFleet):
    """The sensor-bus of a node that has one is played by a test."""

    def start_node(self, node):
        without = ["--without", "sensor-bus"] if "sensor-bus" in self.services_of[node] else []
        up = [self.programs / "trb", "up", self.dir(node), *without, "--die-with-parent"]
        self.nodes[node] = trb_fleet.Process(up, self.root / f"up-{node}.log")
