"""A program on a node's own bus is hostile: a compromised service, or a holder of trb's key. It may harm its own
node's robot, but not other nodes' links, nor may it have records signed in another's name.
"""
import secrets
import time
import unittest

import dbus.bus
import dbus.lowlevel

import support
import private_bus
import wire
import zmq
from attack_fleet import FRIEND, SANITIZED, SLOWEST_S, TARGET, Case, Honest, PlayedFleet, Service, resident
from router_client import to_z85

ESCAPES = "\x1b]0;owned\x07\x1b[2J"


class Bus(Case):
    """The sensor-bus of the target is the attacker."""

    BLOCK, UDP_PORT = 188, 50188
    services = {TARGET: ["router", "sensor-bus"], FRIEND: ["router"]}
    kind = PlayedFleet

    @classmethod
    def play(cls):
        cls.endpoint = f"ipc://{cls.fleet.dir(TARGET)}/bus/sensor-bus.ipc"
        cls.service = Service(cls.context, cls.endpoint, "sensor-bus", ["sensor_list"], welcome=False)
        cls.service.hello("sensor-bus", ["sensor_list"])
        cls.addClassCleanup(cls.service.close)

    def setUp(self):
        self.service.drain()
        self.service.hello("sensor-bus", ["sensor_list"])
        self.service.slot = self.service.hear(lambda frame: frame.subtype == "service_welcome", 20).body()[2]

    def codes(self, least=0):
        """The codes of the Nacks, until nothing more comes for 0.3 s; for the first ones there is more time."""
        out = []
        while self.service.socket.poll(20_000 if len(out) < least else 300):
            frame = wire.decode(self.service.socket.recv())
            if frame.subtype == "nack":
                out.append(wire.nack(frame)["code"])
        return out

    def test_it_claims_another_service_s_name(self):
        """The names of services that this node does not have; for one that it has: bus_test.py `test_impersonation`."""
        with self.attempt("refused.not_permitted"):
            for name in ("scheduler", "mode-adapter", "router", "resilience"):
                self.service.hello(name, ["stop", "execute", "baton"])
            self.assertEqual(len(self.codes(least=4)), 4)

    def test_it_says_the_words_of_the_others(self):
        words = ("execute", "outcome", "adapter_state", "bridge_command", "execution_state", "cancel_execution", "release_tasks",
                 "run_decision", "run_submit", "alert_decide", "node_profile", "fleet_news", "peer_expired", "service_welcome",
                 "signed_record")
        with self.attempt("refused.not_permitted"):
            for word in words:
                self.service.say(TARGET, TARGET, word, wire.pack([]))
            self.assertEqual(set(self.codes(least=1)), {"not_permitted"})

    def test_it_wants_the_records_of_others_signed(self):
        kinds = ("result", "choice", "run_start", "run_abort", "run_pause", "decision", "beacon", "seal", "relayed", "certificate",
                 "certificate_request", "revocation_list", "", "x" * 64)
        with self.attempt("refused.not_permitted"):
            for kind in kinds:
                ident = self.service.say(TARGET, TARGET, "sign_request", wire.pack([kind, b"payload"]), wire.REQUEST)
                answer = self.service.hear(lambda frame, ident=ident: frame.reply_to == ident)
                self.assertEqual(answer.subtype, "nack", kind)

    def test_a_probe_wants_a_record_signed_that_names_another_node(self):
        probe = Service(self.context, f"ipc://{self.fleet.dir(TARGET)}/bus/probe.ipc")
        self.addCleanup(probe.close)
        order = wire.pack([secrets.token_bytes(16), FRIEND, "in its name", time.time_ns()])
        with self.attempt():
            for kind in ("run_abort", "run_pause", "run_start"):
                ident = probe.say(TARGET, TARGET, "sign_request", wire.pack([kind, order]), wire.REQUEST)
                answer = probe.hear(lambda frame, ident=ident: frame.reply_to == ident)
                self.assertEqual(answer.subtype, "nack", kind)

    def test_it_answers_what_others_were_asked(self):
        asker = Service(self.context, f"ipc://{self.fleet.dir(TARGET)}/bus/probe.ipc")
        self.addCleanup(asker.close)
        with self.attempt("refused.not_asked"):
            for _ in range(50):
                ident = asker.say(TARGET, FRIEND, "echo_request", wire.pack([b""]), wire.REQUEST)
                for target in (TARGET, FRIEND):
                    for word, body in (("nack", ["queue_full", "", "", "", ""]), ("echo", [b"forged"])):
                        self.service.say(TARGET, target, word, wire.pack(body), wire.INFORMATION, reply_to=ident)
        heard = [(frame.subtype, frame.source, frame.body()) for frame in asker.drain()]
        self.assertEqual(heard, [("echo", FRIEND, [b""])] * 50)

    def test_it_says_hello_a_thousand_times(self):
        with self.attempt():
            for _ in range(1000):
                self.service.hello("sensor-bus", [f"word_{number}" for number in range(40)])
            self.codes()

    def test_it_comes_and_goes_two_hundred_times(self):
        with self.attempt():
            for _ in range(200):
                one = self.context.socket(zmq.DEALER)
                one.connect(self.endpoint)
                one.send(wire.Frame("service_hello", "", "", type=wire.COMMAND, id=1,
                                    data=wire.pack(["sensor-bus", [], 1, 1, "x"])).encode())
                one.close(0)

    def test_it_speaks_as_another_node(self):
        with self.attempt("dropped.source_mismatch"):
            for target in (TARGET, FRIEND):
                self.service.say(FRIEND, target, "stop", wire.pack([""]))
            self.assertEqual(set(self.codes(least=1)), {"source_mismatch"})

    def test_it_speaks_as_another_connection(self):
        with self.attempt("dropped.malformed"):
            for slot in range(0, 200):
                self.service.say(TARGET, FRIEND, "echo_request", wire.pack([b""]), wire.REQUEST, id=(slot + 7) << 48 | 1)
            self.codes()

    def test_it_says_a_link_s_words_to_other_nodes(self):
        with self.attempt("refused.not_permitted"):
            for word in ("hello", "keep_alive", "goodbye", "neighbours", "relayed", "relay_refused", "seal", "fleet_news",
                         "node_profile"):
                self.service.say(TARGET, FRIEND, word, wire.pack(["bye"]))
                self.service.say(TARGET, "*", word, wire.pack(["bye"]), wire.INFORMATION)
            self.assertEqual(set(self.codes(least=1)), {"not_permitted"})

    def test_it_tells_every_node_without_end(self):
        with self.attempt():
            for number in range(5000):
                self.service.say(TARGET, "*", "noise", b"x" * 200, wire.INFORMATION)
                if number % 50 == 0:
                    time.sleep(0.005)
            self.codes()

    def test_it_stops_every_node_at_once(self):
        """There is no command for all: each node is named."""
        with self.attempt("dropped.bad_value"):
            self.service.say(TARGET, "*", "stop", wire.pack([""]))
            self.assertEqual(self.codes(least=1), ["bad_value"])

    def test_it_asks_its_router_with_a_megabyte(self):
        with self.attempt():
            for _ in range(30):
                self.service.say(TARGET, TARGET, "echo_request", wire.pack([bytes(1_000_000)]), wire.REQUEST)
                self.service.say(TARGET, TARGET, "service_alive", bytes(1_000_000))
            self.codes()

    def test_sensors_that_command_terminals(self):
        """255 sensors, their names and units full of escapes, a hundred times: passed on or refused, harmless."""
        with self.attempt():
            for number in range(50):
                rows = [[(f"{number}_{row}" + ESCAPES)[:64], ESCAPES, ESCAPES[:16], ESCAPES, ESCAPES, 0, ESCAPES]
                        for row in range(100)]
                self.service.say(TARGET, TARGET, "node_sensors", wire.pack([rows]))
                self.service.say(TARGET, TARGET, "node_sensors", wire.pack([[[ESCAPES, ESCAPES]]]))
            self.codes()
            for words in (("route", "list"), ("robot", "list"), ("doctor",), ("sensor", "list")):
                done = self.fleet.trb(*words, node=FRIEND, check=False)
                self.assertNotIn("\x1b", done.stdout + done.stderr)


class OverTcp(unittest.TestCase):
    """A bus over TCP: trb's key is stolen."""

    @classmethod
    def setUpClass(cls):
        class TcpFleet(support.RouterFleet):
            def node_json(self, node):
                out = super().node_json(node)
                return dict(out, bus=f"tcp://{self.address(node)}:46000") if node == TARGET else out

        cls.context = zmq.Context()
        cls.addClassCleanup(cls.context.destroy, 0)
        cls.fleet = support.make_fleet(cls, TcpFleet, services={TARGET: ["router"], FRIEND: ["router"]}, block=190,
                                       udp_port=50190)
        cls.fleet.bring_up(TARGET, FRIEND)
        cls.fleet.wait("the honest are linked", lambda: cls.fleet.formed(FRIEND), 60)

    def thief(self):
        keys = self.fleet.dir(TARGET) / "keys" / "bus"
        pair = [to_z85(bytes.fromhex((keys / f"probe.{end}").read_text().strip())) for end in ("pub", "key")]
        router = to_z85(bytes.fromhex((keys / "router.pub").read_text().strip()))
        one = Service(self.context, f"tcp://{self.fleet.address(TARGET)}:46000", server_key=router, keys=pair)
        self.addCleanup(one.close)
        return one

    def under(self, attack):
        pid = self.fleet.pid(TARGET, "router")
        before, honest = resident(pid), Honest(self.fleet)
        honest.start()
        attack()
        honest.wait_answers(5)
        honest.end()
        self.assertIsNone(honest.fault)
        support.assert_quick(self, honest.times, SLOWEST_S)
        self.assertEqual(self.fleet.pid(TARGET, "router"), pid)
        if not SANITIZED:
            self.assertLess(resident(pid) - before, 160)  # 128 MiB of a service that floods: see the README

    def test_the_key_of_a_probe_floods(self):
        def attack():
            one = self.thief()
            for _ in range(3000):
                one.say(TARGET, TARGET, "router_counters", wire.pack([]), wire.REQUEST)
            for _ in range(50):
                one.say(TARGET, FRIEND, "echo_request", wire.pack([bytes(500_000)]), wire.REQUEST)
            one.drain()

        self.under(attack)

    def test_the_key_of_a_probe_comes_as_a_crowd(self):
        def attack():
            crowd = [Service(self.context, "tcp://127.0.0.1:1", welcome=False) for _ in range(2)]
            for one in crowd:
                one.close()
            for _ in range(30):
                self.thief().say(TARGET, TARGET, "route_list", wire.pack([]), wire.REQUEST)

        self.under(attack)


class Programs(unittest.TestCase):
    """A hostile program on the D-Bus to which a node's sensor-bus listens."""

    @classmethod
    def setUpClass(cls):
        folder = support.temporary_folder(cls)
        cls.bus = bus = private_bus.PrivateBus(folder)
        cls.bus.start()
        cls.addClassCleanup(cls.bus.stop)

        class Fleet(support.RouterFleet):
            def node_json(self, node):
                return dict(super().node_json(node), dbus=bus.address)

        cls.fleet = support.make_fleet(cls, Fleet, services={TARGET: ["router", "sensor-bus"], FRIEND: ["router"]}, block=192,
                                       udp_port=50192)
        cls.fleet.bring_up(TARGET, FRIEND)
        cls.fleet.wait("the sensor-bus is up", lambda: cls.fleet.services(TARGET)["sensor-bus"]["state"] == "up", 60)
        cls.fleet.wait("the honest are linked", lambda: cls.fleet.formed(FRIEND), 60)

    def setUp(self):
        self.pid = self.fleet.pid(TARGET, "sensor-bus")
        self.before = resident(self.pid)
        self.honest = Honest(self.fleet)
        self.honest.start()
        self.program = dbus.bus.BusConnection(self.bus.address)
        self.addCleanup(self.program.close)

    def tearDown(self):
        self.fleet.wait("the sensor-bus answers", lambda: self.fleet.trb("sensor", "list", node=TARGET, check=False).returncode == 0, 60)
        self.honest.wait_answers(5)
        self.honest.end()
        self.assertIsNone(self.honest.fault)
        support.assert_quick(self, self.honest.times, SLOWEST_S)
        self.assertEqual(self.fleet.pid(TARGET, "sensor-bus"), self.pid)
        if not SANITIZED:
            self.assertLess(resident(self.pid) - self.before, 48)
        listed = self.fleet.trb("sensor", "list", node=FRIEND, check=False)
        self.assertNotIn("\x1b", listed.stdout + listed.stderr)

    def emit(self, name, *values, signature=None, interface=None):
        message = dbus.lowlevel.SignalMessage(f"/trbots/{name}", interface or f"trbots.{name}", "value")
        message.append(*values, signature=signature)
        self.program.send_message(message)

    def test_a_hundred_thousand_signals(self):
        for number in range(100_000):
            self.emit("flood", float(number), signature="d")
            if number % 1000 == 0:
                self.program.flush()
        self.program.flush()

    def test_ten_thousand_names(self):
        for number in range(10_000):
            self.emit(f"n{number}", 1.0, signature="d")
        self.program.flush()

    def test_texts_of_megabytes_and_with_escapes(self):
        for _ in range(8):
            self.emit("huge", "\x1b[2J" + "x" * 4_000_000, signature="s")
            self.emit("escape", ESCAPES, signature="s")
            self.emit("nan", float("nan"), signature="d")
            self.emit("inf", float("-inf"), signature="d")
        self.program.flush()

    def test_another_s_sensor_under_the_wrong_interface(self):
        for _ in range(500):
            self.emit("flood", 1.0, signature="d", interface="trbots.other")
            self.emit("flood", [1.0] * 1000, signature="ad")
            self.emit("flood", "text", 1, 2.0, signature="sid")
        self.program.flush()


if __name__ == "__main__":
    support.main()
