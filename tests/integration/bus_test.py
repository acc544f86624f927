"""A node whose bus is TCP: the key proves the service. A whole small node runs over it; strangers with no or a wrong
key and with another service's are refused, counted under names of their own, and disturb no service.
"""
import contextlib
import json
import os
import shutil
import signal
import socket
import stat
import subprocess
import time
import unittest

import zmq
import zmq.utils.z85

import support
import trb_fleet
import wire
from raw_peer import RawPeer
from router_client import PLAIN_GREETING, WAIT, make_context, to_z85

BLOCK = 136
UDP_PORT = 50136
PORT = 46000


class TcpFleet(trb_fleet.Fleet):
    """A cloud and a robot, each with its bus over TCP."""

    def bus(self, node):
        return f"tcp://{self.address(node)}:{PORT}"

    def node_json(self, node):
        return dict(super().node_json(node), bus=self.bus(node))


class Service:
    """A DEALER on a node's bus, with or without keys: this file's own client."""

    def __init__(self, case, endpoint, server_key=None, keys=None, routing_id=None):
        self.socket = case.context.socket(zmq.DEALER)
        self.socket.setsockopt(zmq.SNDTIMEO, WAIT * 1000)  # without it a test would hang on a refused link
        case.addCleanup(self.socket.close, 0)
        if routing_id:
            self.socket.setsockopt(zmq.ROUTING_ID, routing_id)
        if server_key:
            self.socket.curve_serverkey = server_key
            self.socket.curve_publickey, self.socket.curve_secretkey = keys or zmq.curve_keypair()
        self.socket.connect(endpoint)

    def hello(self, service, subtypes=()):
        claim = wire.pack([service, list(subtypes), 7, os.getpid(), "independent"])
        self.send("service_hello", "", "", type=wire.COMMAND, id=1, data=claim)

    def send(self, subtype, source, target, **more):
        self.socket.send(wire.Frame(subtype, source, target, **more).encode())

    def receive(self, timeout=WAIT):
        if not self.socket.poll(int(timeout * 1000)):
            raise TimeoutError(f"nothing received in {timeout} s")
        return wire.decode(self.socket.recv())


class Bus(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        make_context(cls)
        robots = {"pioneer1": trb_fleet.ROBOTS["pioneer1"]}
        cls.fleet = support.make_fleet(cls, TcpFleet, block=BLOCK, udp_port=UDP_PORT, robots=robots)
        cls.fleet.start()
        cls.fleet.wait_formed(60)
        cls.endpoint = cls.fleet.bus("cloud")
        cls.keys = cls.fleet.dir("cloud") / "keys" / "bus"
        cls.server_key = cls.public("router")

    @classmethod
    def public(cls, name):
        return to_z85(bytes.fromhex((cls.keys / f"{name}.pub").read_text().strip()))

    def pair(self, name):
        return self.public(name), to_z85(bytes.fromhex((self.keys / f"{name}.key").read_text().strip()))

    def setUp(self):
        self.watch = support.Watch(self.fleet, "cloud")
        self.before = self.fleet.services("cloud")["scheduler"]

    def tearDown(self):
        """After any attempt: the service is the same, and a command goes from the cloud to the robot's node."""
        self.wait_up("cloud", "scheduler")
        self.assertEqual(self.fleet.services("cloud")["scheduler"]["instance"], self.before["instance"])
        self.fleet.trb("robot", "list", node="cloud")
        self.assertNotIn("router ended", "\n".join(self.fleet.nodes["cloud"].lines))

    def wait_up(self, node, *services):
        """One that a stalled machine has kept silent for 3 s is not."""
        def up():
            return {name for name, row in self.fleet.services(node).items() if row["state"] == "up"}
        self.fleet.wait(f"{services} of {node} are up", lambda: up() >= set(services), 60)

    def service(self, *arguments, **more):
        return Service(self, self.endpoint, *arguments, **more)

    def assert_unheard(self, client):
        client.socket.setsockopt(zmq.SNDTIMEO, 0)
        with contextlib.suppress(zmq.Again):  # it was refused before it could say anything
            client.hello("scheduler", ["baton"])
        self.assertFalse(client.socket.poll(700), "the stranger was told something")

    def assert_refused(self, counter, logged):
        self.watch.wait_counted(counter)
        self.watch.wait_logged(logged)

    # ---- the node works

    def test_messages_and_the_command_line(self):
        self.assertFalse((self.fleet.dir("cloud") / "bus").exists(), "the bus has sockets in the folder, too")
        self.wait_up("pioneer1", "router", "mode-adapter", "scheduler")
        self.fleet.trb("stop", "pioneer1", node="cloud")
        self.fleet.trb("release", "pioneer1", node="cloud")
        tap = trb_fleet.Process([support.PROGRAMS / "trb", "tap", "--node", self.fleet.dir("cloud"), "--all", "--json"],
                                self.fleet.root / "tap.log")
        self.addCleanup(tap.stop)
        tap.wait_line('"subtype"', 60)
        findings = self.fleet.json("doctor", node="cloud", check=False)["findings"]
        self.assertEqual([row for row in findings if row["cause"].startswith(("bus", "router", "service"))], [])

    def test_the_keys_are_their_owners_alone(self):
        for name in ("router", "scheduler", "probe"):
            self.assertEqual(stat.S_IMODE((self.keys / f"{name}.key").stat().st_mode), 0o600)
        self.assertEqual(stat.S_IMODE(self.keys.stat().st_mode), 0o700)

    # ---- a service's doctor

    def apart(self, service):
        """The node's folder as a container of that service has it."""
        folder = self.fleet.root / f"apart-{service}"
        self.addCleanup(shutil.rmtree, folder)
        shutil.copytree(self.fleet.dir("cloud"), folder, ignore=shutil.ignore_patterns("keys", "log", "state"))
        (folder / "keys" / "bus").mkdir(parents=True)
        for name in ("certificate.json", f"bus/{service}.key", "bus/router.pub"):
            shutil.copy2(self.fleet.dir("cloud") / "keys" / name, folder / "keys" / name)
        return folder

    def ask(self, folder, *words):
        return subprocess.run([support.PROGRAMS / "trb", *words, "--node", folder], capture_output=True, text=True, timeout=30)

    def test_a_services_key_shows_its_doctor_how_it_is_and_opens_nothing_else(self):
        folder = self.apart("scheduler")
        done = self.ask(folder, "doctor", "--service", "scheduler")
        self.assertEqual(done.returncode, 0, done.stdout)
        self.assertIn("scheduler is up, no problem found", done.stdout)
        done = self.ask(folder, "doctor", "--service", "resilience", "--json")
        self.assertEqual([row["cause"] for row in json.loads(done.stdout)["findings"] if row["severity"] == "problem"], ["router_down"])
        for words in (("route", "list"), ("stop", "pioneer1"), ("doctor",)):
            self.assertNotEqual(self.ask(folder, *words).returncode, 0, words)

    def test_a_services_doctor_sees_that_it_hangs(self):
        folder = self.apart("scheduler")
        pid = self.before["pid"]
        os.kill(pid, signal.SIGSTOP)
        try:
            self.fleet.wait("it is seen", lambda: "silent" in self.ask(folder, "doctor", "--service", "scheduler").stdout, 60)
        finally:
            os.kill(pid, signal.SIGCONT)
        self.fleet.wait("it is up", lambda: self.ask(folder, "doctor", "--service", "scheduler").returncode == 0, 60)

    # ---- refused connections

    def test_without_a_key(self):
        self.assert_unheard(self.service())
        self.fleet.wait("it is counted", lambda: set(self.watch.rise()) & {"refused.bus_no_curve", "refused.bus_no_zmtp"}, WAIT)
        plain = socket.create_connection((self.fleet.address("cloud"), PORT), timeout=WAIT)
        self.addCleanup(plain.close)
        plain.sendall(PLAIN_GREETING)
        self.assert_refused("refused.bus_no_curve", "bus_no_curve a client without CURVE")

    def test_a_key_of_nobody(self):
        self.assert_unheard(self.service(self.server_key))
        self.assert_refused("refused.bus_key", "bus_key the key ")

    def test_a_wrong_key_of_the_router(self):
        self.assert_unheard(self.service(zmq.curve_keypair()[0], self.pair("scheduler")))
        self.assert_refused("refused.bus_wrong_server_key", "bus_wrong_server_key a client came")

    def test_a_key_of_the_inbox_is_none_of_the_bus(self):
        secret = to_z85(bytes.fromhex((self.fleet.dir("pioneer1") / "keys" / "link.key").read_text().strip()))
        self.assert_unheard(self.service(self.server_key, (zmq.curve_public(secret), secret)))
        self.assert_refused("refused.bus_key", "bus_key the key ")

    def test_a_key_of_the_bus_is_none_of_the_inbox(self):
        secret = to_z85(bytes.fromhex((self.fleet.dir("cloud") / "keys" / "link.key").read_text().strip()))
        client = Service(self, f"tcp://{self.fleet.address('cloud')}:45000", zmq.curve_public(secret), self.pair("scheduler"))
        client.send("move", "cloud", "cloud", link=7, sequence=1, id=1)
        self.assertEqual(client.receive().subtype, "goodbye")
        self.watch.wait_counted("refused.unknown_peer_key")

    def test_the_tap_is_not_for_strangers(self):
        tap = self.context.socket(zmq.SUB)
        self.addCleanup(tap.close, 0)
        tap.setsockopt(zmq.SUBSCRIBE, b"")
        tap.curve_serverkey = self.server_key
        tap.curve_publickey, tap.curve_secretkey = zmq.curve_keypair()
        tap.connect(f"tcp://{self.fleet.address('cloud')}:{PORT + 1}")
        self.assertFalse(tap.poll(1000), "a stranger heard the tap")
        self.watch.wait_counted("refused.bus_key")

    # ---- accepted connections that claim another name

    def test_another_service_s_key(self):
        """With trb's key it is no service; with a service's key it is that service and no other."""
        asked = self.service(self.server_key, self.pair("probe"))
        asked.hello("scheduler", ["baton"])
        welcome = asked.receive()
        self.assertEqual(welcome.subtype, "service_welcome")
        result = wire.pack(["result", b"forged"])
        asked.send("sign_request", "cloud", "cloud", type=wire.REQUEST, id=welcome.body()[2] << 48 | 1, data=result)
        self.assertEqual(wire.nack(asked.receive())["code"], "not_permitted")
        self.assertEqual(self.fleet.services("cloud")["scheduler"]["pid"], self.before["pid"])

    def test_impersonation(self):
        robot = support.Watch(self.fleet, "pioneer1")
        keys = self.fleet.dir("pioneer1") / "keys" / "bus"
        public, secret = (to_z85(bytes.fromhex((keys / f"mode-adapter.{end}").read_text().strip())) for end in ("pub", "key"))
        router = to_z85(bytes.fromhex((keys / "router.pub").read_text().strip()))
        thief = Service(self, self.fleet.bus("pioneer1"), router, (public, secret))
        thief.hello("scheduler", ["baton"])
        self.assertEqual(wire.nack(thief.receive())["code"], "source_mismatch")
        robot.wait_counted("refused.impersonation")
        robot.wait_logged("it comes as 'mode-adapter' and says that it is 'scheduler'")
        other = Service(self, self.fleet.bus("pioneer1"), router, self.pair("scheduler"))  # of the cloud's bus
        self.assert_unheard(other)
        robot.wait_counted("refused.bus_key")

    def test_the_second_of_a_service(self):
        second = self.service(self.server_key, self.pair("scheduler"))
        second.hello("scheduler", ["baton"])
        self.assertEqual(wire.nack(second.receive())["code"], "already_claimed")
        self.watch.wait_counted("refused.already_claimed")

    def test_words_without_a_hello(self):
        client = self.service(self.server_key, self.pair("scheduler"))
        client.send("sign_request", "cloud", "cloud", type=wire.REQUEST, id=1, data=wire.pack(["result", b"x"]))
        self.assertEqual(client.receive().subtype, "hello_wanted")

    def test_silence_after_the_handshake(self):
        client = self.service(self.server_key, self.pair("scheduler"))
        events = client.socket.get_monitor_socket(zmq.EVENT_DISCONNECTED)
        self.addCleanup(client.socket.disable_monitor)
        self.addCleanup(events.close)
        self.watch.wait_counted("cut.no_service", prefixes=("cut.",))
        self.assertTrue(events.poll(WAIT * 1000), "the silent connection was not cut")

    def test_who_listens_to_the_tap_is_not_cut(self):
        """It says nothing after the handshake but what it subscribes to; another one that says nothing is cut."""
        tap = self.context.socket(zmq.SUB)
        self.addCleanup(tap.close, 0)
        tap.curve_serverkey = self.server_key
        tap.curve_publickey, tap.curve_secretkey = self.pair("probe")
        events = tap.get_monitor_socket(zmq.EVENT_DISCONNECTED)
        self.addCleanup(tap.disable_monitor)
        self.addCleanup(events.close)
        tap.setsockopt(zmq.SUBSCRIBE, b"")
        tap.connect(f"tcp://{self.fleet.address('cloud')}:{PORT + 1}")
        self.assertTrue(tap.poll(WAIT * 1000), "the tap shows nothing")
        self.service(self.server_key, self.pair("scheduler"))
        self.watch.wait_counted("cut.no_service", prefixes=("cut.",))
        self.assertFalse(events.poll(0), "the tap's listener was cut")

    def test_parts_of_a_message_without_end(self):
        """By a program with a key of this bus."""
        public, secret = (zmq.utils.z85.decode(key) for key in self.pair("probe"))
        address = (self.fleet.address("cloud"), PORT)
        peer = RawPeer(socket.create_connection(address, WAIT), public, secret, b"DEALER",
                       zmq.utils.z85.decode(self.server_key))
        self.addCleanup(peer.close)
        self.assertTrue(peer.send_parts(1 << 20, 1 << 30)[1], "its connection was not ended")
        self.watch.wait_counted("cut.incomplete", prefixes=("cut.",))

    def test_megabytes_are_complete(self):
        """Faster than the router takes them, and before the Hello, which has four seconds."""
        client = self.service(self.server_key, self.pair("scheduler"))
        for _ in range(64):
            client.send("picture", "cloud", "cloud", id=1, data=bytes(1_000_000))
        client.hello("scheduler", ["baton"])  # its answer is the last: they were all read
        answers = [client.receive()]
        while answers[-1].subtype == "hello_wanted":
            answers.append(client.receive())
        self.assertEqual(wire.nack(answers[-1])["code"], "already_claimed")
        self.assertGreater(len(answers), 1)
        self.assertNotIn("cut.incomplete", self.watch.rise(("cut.",)))

    def test_a_flood(self):
        """Many silent connections: the bus's services go on, and descriptors stay bounded."""
        router = f"/proc/{self.fleet.pid('cloud', 'router')}/fd"
        before = len(os.listdir(router))
        held = []
        for number in range(600):
            one = socket.socket()
            self.addCleanup(one.close)
            one.setblocking(False)
            one.bind((f"127.0.137.{1 + number % 200}", 0))
            one.connect_ex((self.fleet.address("cloud"), PORT))
            held.append(one)
        most, begin = 0, time.monotonic()
        while time.monotonic() < begin + (20 if most <= before + 30 else 2):
            most = max(most, len(os.listdir(router)))
        self.assertGreater(most, before + 30)
        self.assertLess(most, before + 64 + 200)
        for one in held:
            one.close()
        self.watch.wait_counted("refused.bus_no_zmtp")

    # ---- trb and its keys

    def test_doctor_names_what_is_wrong(self):
        key = self.keys / "probe.key"
        before = key.read_text()

        def restore():
            key.chmod(0o600)
            key.write_text(before)

        self.addCleanup(restore)
        key.write_text(os.urandom(32).hex() + "\n")

        def causes():
            return {(row["cause"], row["subject"]) for row in self.fleet.json("doctor", node="cloud", check=False)["findings"]}

        found = causes()
        self.assertIn(("bus_key", "keys/bus/probe.key"), found)
        self.assertIn(("node_folder", "keys/bus/probe.pub"), found)
        done = self.fleet.trb("route", "list", node="cloud", check=False)
        self.assertIn("does not take the key", done.stderr)
        key.chmod(0o644)
        self.assertIn(("node_folder", "keys/bus/probe.key"), causes())
        restore()
        file = self.fleet.dir("cloud") / "node.json"
        node = json.loads(file.read_text())
        self.addCleanup(file.write_text, file.read_text())
        address = f"{self.fleet.address('cloud')}:{PORT + 7}"
        file.write_text(json.dumps(dict(node, bus=f"tcp://{address}")))
        self.assertIn(("bus_socket_missing", f"tcp://{address}"), causes())
        file.write_text(json.dumps(node))


if __name__ == "__main__":
    support.main()
