"""The life of a certificate, on real nodes: renewed and revoked while the fleet is up, and refused when not valid.
No process restarts in between.
"""
import collections
import fcntl
import itertools
import json
import os
import pathlib
import shutil
import socket
import tempfile
import time
import unittest

import zmq

import authority
import support
import trb_fleet
import wire
from router_client import Client, Member

BLOCK = 110
UDP_PORT = 50110
WAIT = 6
TARGET = "ant"
NODES = ("ant", "bee", "cat")
SPARE = ("dog", "elk")  # have keys and certificates, but do not run: the test plays them


def setUpModule():
    """One at a time on a machine: fleets of two checkouts on the same addresses would receive each other's beacons."""
    lock = open(pathlib.Path(tempfile.gettempdir()) / f"trb-certificates-{os.getuid()}.lock", "w")
    unittest.addModuleCleanup(lock.close)
    fcntl.flock(lock, fcntl.LOCK_EX)


class Life(unittest.TestCase):
    """A fleet of three that are up, new for each test: what a revocation does cannot be undone."""

    block = BLOCK

    def setUp(self):
        self.context = zmq.Context()
        self.addCleanup(self.context.term)
        services = {node: ["router"] for node in NODES + SPARE}
        self.fleet = support.make_fleet(self, support.RouterFleet, services=services, block=self.block, udp_port=UDP_PORT)
        self.fleet.bring_up(*NODES)
        self.fleet.wait("the three are linked", lambda: all(self.online(n) == set(NODES) - {n} for n in NODES), 15)
        self.pids = {node: self.fleet.pid(node, "router") for node in NODES}
        self.watches = {node: support.Watch(self.fleet, node) for node in NODES}
        self.watch = self.watches[TARGET]

    def routes(self, node=TARGET):
        return {row["id"]: row for row in self.fleet.json("route", "list", node=node)["routes"]}

    def online(self, node=TARGET):
        return {name for name, row in self.routes(node).items() if row["state"] == "ONLINE"}

    def authority(self):
        return authority.Authority(self.fleet.authority_dir(), self.fleet.passphrase())

    def assert_same_processes(self):
        self.assertEqual({node: self.fleet.pid(node, "router") for node in NODES}, self.pids)

    def client(self, member=None, node=TARGET, keys=None):
        server = Member(self.fleet, node).public
        if member is not None:
            keys = (member.public, member.secret)
        client = Client(self.context, self.fleet.address(node), server_key=server, keys=keys)
        self.addCleanup(client.close)
        return client

    def send(self, client, subtype, source, **more):
        return client.send(subtype, source, target=TARGET, **more)

    def hello(self, client, member, certificate=None, boot=None):
        boot = boot or time.time_ns() // 1_000_000_000
        self.send(client, "hello", member.id,
                  data=wire.hello(certificate or member.certificate, boot, f"127.0.{self.block}.99:45000"))

    def linked(self, member):
        client = self.client(member)
        self.hello(client, member)
        self.assertEqual(client.receive().subtype, "hello")
        return client

    def assert_alive(self, client, member):
        ident = self.send(client, "route_list", member.id, type=wire.REQUEST, data=wire.pack([]))
        self.assertEqual(client.answer_to(ident).subtype, "route_table")


class Revoked(Life):
    def test_revoked_while_connected(self):
        """In force on every node within two seconds, sent by one of them; no process restarts."""
        links = {node: self.routes(node)[other]["link"] for node, other in (("ant", "bee"), ("bee", "ant"))}
        start = time.monotonic()
        said = self.fleet.trb("fleet", "revoke", self.fleet.authority_dir(), "cat", "--reason", "stolen", "--via",
                              self.fleet.dir("bee")).stdout
        self.assertIn("list 1, beacon key 2 for the 4 nodes that stay", said)
        told = time.monotonic()
        for node in ("ant", "bee"):
            self.fleet.wait(f"{node} has no cat", lambda: "cat" not in self.routes(node), 2)
        took = time.monotonic() - told
        print(f"revoked: {told - start:.2f} s to sign and hand over, {took:.2f} s more until every table shows it")
        self.assertLess(took, 2)
        for node in ("ant", "bee"):
            self.watches[node].wait_counted("refused.cert_revoked")
            self.watches[node].wait_logged("peer_revoked cat (serial 3): stolen")
            self.watches[node].wait_logged("beacon_key number 2 from now on")
        self.watches["cat"].wait_logged("own_certificate_over this node's certificate is revoked: stolen")
        self.assertIn("revoked: stolen", self.fleet.services("cat")["router"]["note"])
        self.assertEqual(self.online("cat"), set())
        self.assert_same_processes()
        for node, other in (("ant", "bee"), ("bee", "ant")):
            self.assertEqual(self.routes(node)[other]["link"], links[node], "the link of those that stay was lost")

    def test_a_revoked_node_s_key_knocks_in_vain(self):
        self.fleet.trb("fleet", "revoke", self.fleet.authority_dir(), "cat", "--via", self.fleet.dir("ant"))
        self.watch.wait_logged("peer_revoked cat")
        before = self.watch.rise().get("refused.cert_revoked", 0)
        client = self.client(Member(self.fleet, "cat"))
        client.wait_event(zmq.EVENT_HANDSHAKE_FAILED_AUTH)
        self.watch.wait_counted("refused.cert_revoked", before + 1)
        self.watch.wait_logged("revoked_key the revoked key of 'cat' knocked")

    def test_a_revoked_node_that_was_never_met(self):
        """It is refused at its Hello, and gets the list that revokes it."""
        self.fleet.trb("fleet", "revoke", self.fleet.authority_dir(), "dog", "--via", self.fleet.dir("ant"))
        dog = Member(self.fleet, "dog")
        client = self.client(dog)
        self.hello(client, dog)
        self.assertEqual(client.receive().subtype, "fleet_news")
        self.assertEqual(client.wait_goodbye(), "cert_revoked")
        self.watch.wait_counted("refused.cert_revoked")
        self.watch.wait_logged("candidate_refused cert_revoked: certificate of 'dog' (serial 4) is revoked by list 1")

    def test_the_beacon_key_is_another_one(self):
        """The revoked node's beacons under the old key are ignored; a node that is signed now joins by beacon."""
        listener = support.beacon_listener(self, UDP_PORT, 8)
        sender = None
        while sender != self.fleet.address("cat"):
            old, (sender, _) = listener.recvfrom(4096)
        self.fleet.trb("fleet", "revoke", self.fleet.authority_dir(), "cat", "--via", self.fleet.dir("ant"))
        self.watch.wait_logged("beacon_key number 2")
        before = self.watch.rise().get("beacon.wrong_key", 0)
        listener.sendto(old, ("127.255.255.255", UDP_PORT))
        self.watch.wait_counted("beacon.wrong_key", before + 1)
        self.fleet.trb("fleet", "sign", self.fleet.authority_dir(), self.fleet.dir("dog") / "keys" / "request.json")
        self.fleet.bring_up("dog")
        for node in ("ant", "bee"):
            self.fleet.wait(f"{node} has dog", lambda: "dog" in self.online(node), 8)
        self.fleet.wait("dog has both", lambda: self.online("dog") == {"ant", "bee"}, 8)
        self.assert_same_processes()

    def test_a_list_that_came_by_hand_and_a_restart(self):
        """news.json in one node's keys folder is enough; what is in force outlives every process."""
        said = self.fleet.trb("fleet", "revoke", self.fleet.authority_dir(), "cat").stdout
        self.assertIn("the fleet does not know it yet", said)
        self.assertIn("cat", self.online())
        shutil.copy(self.fleet.authority_dir() / "news.json", self.fleet.dir("bee") / "keys" / "news.json")
        for node in ("ant", "bee"):
            self.fleet.wait(f"{node} has no cat", lambda: "cat" not in self.routes(node), 3)
        self.assert_same_processes()
        self.fleet.trb("reload", self.fleet.dir("ant"))
        self.fleet.wait("ant is another process", lambda: self.fleet.pid("ant", "router") not in (None, self.pids["ant"]), 8)
        self.fleet.wait("ant and bee are linked", lambda: self.online("bee") == {"ant"}, 8)
        self.watch.wait_logged("revocations list 1")
        self.assertNotIn("cat", self.routes())
        client = self.client(Member(self.fleet, "cat"))
        self.hello(client, Member(self.fleet, "cat"))
        self.assertEqual(client.wait_goodbye(), "cert_revoked")

    def test_a_folder_put_back_from_an_older_copy(self):
        """It learns what the fleet knows: a renewal admits nothing again that was revoked since the copy."""
        folder, via = self.fleet.authority_dir(), self.fleet.dir("ant")
        copy = folder.with_name("copy")
        shutil.copytree(folder, copy)
        self.fleet.trb("fleet", "revoke", folder, "cat", "--via", via)
        shutil.rmtree(folder)
        copy.rename(folder)
        self.assertIn("was older than what", self.fleet.trb("fleet", "tell", folder, "--via", via).stdout)
        again = self.fleet.trb("fleet", "renew", folder, self.fleet.dir("cat") / "keys" / "certificate.json", "--via", via,
                               check=False)
        self.assertIn("cert_revoked", again.stderr)
        self.assertIn("list 2, beacon key 3 for the 3 nodes that stay",
                      self.fleet.trb("fleet", "revoke", folder, "elk", "--via", via).stdout)
        self.watches["bee"].wait_logged("revocations list 2")
        self.assertEqual(self.online("bee"), {"ant"})

    def test_lists_that_do_not_hold(self):
        """Forged, foreign, older, of the same number: each refused and counted by name; the links stay."""
        dog = Member(self.fleet, "dog")
        client = self.linked(dog)
        key = self.authority()
        good = key.revocations(5, [(5, "elk")])
        newer = key.revocations(6, [(5, "elk")])
        forged = good[:3] + [bytes([good[3][0] ^ 1]) + good[3][1:]]
        foreign = key.sign("revocation_list", wire.pack([bytes(16), 6, time.time_ns(), [], 1, []]))
        cases = [
            ("bad_signature", forged, "was not signed by this fleet's authority"),
            ("foreign_fleet", foreign, "revocation list of another fleet"),
            (None, good, "revocations list 5"),
            ("downgraded", key.revocations(4, [(2, "bee")]), "revocation list 4; list 5 is in force"),
            ("conflict", key.revocations(5, [(2, "bee")]), "another revocation list with number 5"),
            (None, newer, "revocations list 6"),
            ("downgraded", good, "revocation list 5; list 6 is in force"),
            ("malformed", key.sign("revocation_list", b"noise"), "news_refused of dog: malformed"),
        ]
        expected = collections.Counter()
        for code, record, logged in cases:
            with self.subTest(logged):
                self.send(client, "fleet_news", "dog", data=authority.news(record))
                self.watch.wait_logged(logged)
                if code:
                    expected[f"refused.{code}"] += 1
                    self.watch.wait_counted(f"refused.{code}", expected[f"refused.{code}"])
        self.assertEqual(self.watch.rise(), expected)
        self.assert_alive(client, dog)
        self.assertEqual(self.online(), {"bee", "cat", "dog"})

    def test_oversized_news(self):
        dog = Member(self.fleet, "dog")
        client = self.linked(dog)
        self.send(client, "fleet_news", "dog", data=bytes(600_000))
        self.watch.wait_counted("refused.too_large")
        self.assert_alive(client, dog)


class Dates(Life):
    block = BLOCK + 2

    def of_another_fleet(self, member):
        """Signed with the same authority's key, so that only its fleet is wrong."""
        body, _ = wire.unpack(self.authority().certificate(member.certificate)[2])
        body[0] = bytes(16)
        return self.authority().sign("certificate", wire.pack(body), fleet=body[0])

    def test_certificates_that_do_not_hold(self):
        """Expired, not yet valid, of another fleet: refused and counted by name."""
        key, dog = self.authority(), Member(self.fleet, "dog")
        day = authority.DAY
        cases = [
            ("cert_expired", key.certificate(dog.certificate, begins=-2 * day, ends=-1), "certificate of 'dog' ended"),
            ("cert_not_yet_valid", key.certificate(dog.certificate, begins=day, ends=2 * day), "'dog' is valid from"),
            ("foreign_fleet", self.of_another_fleet(dog), "certificate of 'dog' is of another fleet"),
        ]
        for code, certificate, logged in cases:
            with self.subTest(code):
                # One stranger's key each: one that was refused stays out for a while.
                public, secret = zmq.curve_keypair()
                raw = zmq.utils.z85.decode(public)
                body, _ = wire.unpack(certificate[2])
                body[5] = raw
                client = self.client(keys=(public, secret))
                self.hello(client, dog, key.sign("certificate", wire.pack(body), fleet=body[0]))
                self.assertEqual(client.wait_goodbye(), code)
                self.watch.wait_counted(f"refused.{code}")
                self.watch.wait_logged(logged)

    def test_an_older_certificate(self):
        """Refused as downgraded, and given the newer one, so that a node that was away during its renewal can join."""
        key, dog = self.authority(), Member(self.fleet, "dog")
        newer = key.certificate(dog.certificate, serial=90)
        client = self.client(dog)
        self.hello(client, dog, newer)
        self.assertEqual(client.receive().subtype, "hello")
        again = self.client(dog)
        self.hello(again, dog)
        answer = again.receive()
        self.assertEqual((answer.subtype, answer.body()[1]), ("fleet_news", [newer]))
        self.assertEqual(again.wait_goodbye(), "downgraded")
        self.watch.wait_counted("refused.downgraded")
        self.watch.wait_logged("downgraded: an older certificate of 'dog': serial 4, 90 is known")
        self.assertEqual(self.watch.rise(), {"refused.downgraded": 1})
        self.assert_alive(client, dog)

    def test_renewals_that_do_not_hold(self):
        """What a member passes on is accepted only for the authority's signature; the link that brought it stays."""
        key, dog = self.authority(), Member(self.fleet, "dog")
        client = self.linked(dog)
        bee = Member(self.fleet, "bee").certificate
        good = key.certificate(bee, serial=70)
        body, _ = wire.unpack(key.certificate(Member(self.fleet, TARGET).certificate, serial=71)[2])
        body[4] = bytes(32)
        cases = [
            ("bad_signature", good[:3] + [bytes([good[3][0] ^ 1]) + good[3][1:]], "of 'bee' was not signed"),
            ("foreign_fleet", self.of_another_fleet(dog), "of 'dog' is of another fleet"),
            ("cert_expired", key.certificate(bee, serial=72, ends=-1), "of 'bee' ended"),
            ("cert_not_yet_valid", key.certificate(bee, serial=73, begins=authority.DAY), "of 'bee' is valid from"),
            ("downgraded", key.certificate(bee, serial=1), "an older certificate of 'bee': serial 1"),
            ("wrong_key", key.sign("certificate", wire.pack(body)), f"of '{TARGET}' for other keys than this node's"),
        ]
        for code, record, logged in cases:
            with self.subTest(code):
                self.send(client, "fleet_news", "dog", data=authority.news(certificates=[record]))
                self.watch.wait_counted(f"refused.{code}")
                self.watch.wait_logged(logged)
        self.assertEqual(self.watch.rise(), {f"refused.{code}": 1 for code, _, _ in cases})
        self.assert_alive(client, dog)
        self.assertEqual(self.online(), {"bee", "cat", "dog"})

    def test_a_weaker_mechanism(self):
        """PLAIN against CURVE, NULL in strangers_test: the router allows only CURVE."""
        plain = self.context.socket(zmq.DEALER)
        self.addCleanup(plain.close, 0)
        plain.plain_username, plain.plain_password = b"dog", b"dog"
        plain.connect(f"tcp://{self.fleet.address(TARGET)}:45000")
        self.fleet.wait("it is counted", lambda: self.watch.rise(), WAIT)
        self.assertLessEqual(set(self.watch.rise()), {"refused.no_curve", "refused.no_zmtp"})

    def test_an_older_protocol(self):
        """ZMTP 1.0 and 2.0 have no CURVE: the connection ends before its first message."""
        hello = wire.Frame("hello", "dog", TARGET, link=7, sequence=1).encode()
        greetings = {"1.0": b"\x01\x00", "2.0": b"\xff" + bytes(7) + b"\x01\x7f" + b"\x01" + b"\x05" + bytes(2)}
        for count, (version, greeting) in enumerate(greetings.items(), 1):
            with self.subTest(version):
                plain = socket.create_connection((self.fleet.address(TARGET), 45000), timeout=WAIT)
                self.addCleanup(plain.close)
                plain.sendall(greeting + b"\x00" + bytes([min(len(hello), 255)]) + hello)
                try:
                    while plain.recv(1000):
                        pass
                except ConnectionResetError:
                    pass
                self.fleet.wait("it is counted", lambda: self.watch.rise(("ended.",)) == {"ended.no_link": count}, WAIT)
        self.assertEqual(self.watch.rise(), {})

    def test_another_version_of_the_wire(self):
        dog = Member(self.fleet, "dog")
        for count, version in enumerate((1, 3), 1):
            client = self.linked(dog)
            frame = wire.Frame("route_list", "dog", TARGET, type=wire.REQUEST, id=9, link=client.link, sequence=2)
            client.socket.send(bytes([version]) + frame.encode()[1:])
            self.assertIn("version_mismatch", client.wait_goodbye())
            self.watch.wait_counted("refused.version_mismatch", count)
            self.watch.wait_logged(f"frame_refused version_mismatch: wire version {version}")
        self.assertEqual(self.watch.rise(), {"refused.version_mismatch": 2})

    def test_a_certificate_that_ends_while_connected(self):
        key, dog = self.authority(), Member(self.fleet, "dog")
        client = self.client(dog)
        self.hello(client, dog, key.certificate(dog.certificate, serial=90, ends=2 * authority.SECOND))
        self.assertEqual(client.receive().subtype, "hello")
        self.assertIn("certificate has ended", client.wait_goodbye())
        self.watch.wait_logged("link_closed dog: its certificate has ended")
        self.watch.wait_counted("refused.cert_expired")
        self.assertEqual(set(self.watch.rise()), {"refused.cert_expired"})


class Renewed(Life):
    block = BLOCK + 3

    def until(self, node):
        return self.fleet.json("fleet", "show", self.fleet.dir(node))["not_after"]

    def test_a_renewal_spreads_and_no_link_is_lost(self):
        links = {node: {n: row["link"] for n, row in self.routes(node).items()} for node in NODES}
        before = {node: self.until(node) for node in NODES}
        said = self.fleet.trb("fleet", "renew", self.fleet.authority_dir(), *NODES, "--days", "700", "--via",
                              self.fleet.dir("cat")).stdout
        self.assertIn("3 renewed certificates, told to 2 nodes", said)
        for node in NODES:
            self.watches[node].wait_logged("certificate_renewed serial")
            self.fleet.wait(f"{node} has it on disk",
                            lambda: int(self.until(node)) > int(before[node]) + 300 * authority.DAY, 3)
            for other in set(NODES) - {node}:
                certificate = bytes.fromhex(self.routes(node)[other]["certificate"]["payload"])
                self.assertGreaterEqual(wire.unpack(certificate)[0][1], 6, "the serial that others know")
        self.assertEqual({node: {n: row["link"] for n, row in self.routes(node).items()} for node in NODES}, links)
        self.assert_same_processes()
        self.assertEqual(self.watch.rise(), {})

    def test_a_node_that_was_off_while_it_was_renewed(self):
        """It comes with its old certificate, is refused, gets the new one, and joins with it."""
        self.fleet.nodes["cat"].stop()
        self.fleet.trb("fleet", "renew", self.fleet.authority_dir(), "cat", "--via", self.fleet.dir("ant"))
        self.fleet.bring_up("cat")
        self.fleet.wait("cat is back", lambda: self.online("cat") == {"ant", "bee"}, 10)
        self.assertIn("certificate_renewed serial 6", self.watches["cat"].log())

    def renew(self, node, days):
        self.fleet.trb("fleet", "renew", self.fleet.authority_dir(), node, "--days", days, "--via", self.fleet.dir(node))

    def ends_soon(self, node):
        """What trb doctor shows of it."""
        report = json.loads(self.fleet.trb("doctor", "--json", node=node, check=False).stdout)
        return [row for row in report["findings"] if row["cause"] == "cert_ends_soon"]

    def test_a_certificate_that_ends_soon(self):
        """Warnings from 30 days before: in the log, in trb service list, in trb doctor; none once renewed."""
        self.renew(TARGET, 31)
        self.watch.wait_logged("certificate_renewed serial 6")
        self.assertEqual(self.ends_soon(TARGET), [])
        self.assertNotIn("certificate ends", self.fleet.trb("service", "list", node=TARGET).stdout)
        self.renew(TARGET, 29)
        self.watch.wait_logged("certificate_ends certificate ends")
        self.watch.wait_logged(f"in 28 days: trb fleet renew FLEET_DIR {TARGET}")
        self.assertIn(f"in 28 days: trb fleet renew FLEET_DIR {TARGET}",
                      self.fleet.trb("service", "list", node=TARGET).stdout)
        row, = self.ends_soon(TARGET)
        self.assertEqual((row["subject"], row["severity"]), (TARGET, "note"))
        self.assertIn("28 days", row["what"])
        self.assertIn(f"trb fleet renew FLEET_DIR {TARGET}", row["cure"])
        self.assertEqual(self.watch.log().count("certificate_ends"), 1)
        self.renew(TARGET, 365)
        self.watch.wait_logged("certificate_renewed serial 8")
        self.assertEqual(self.ends_soon(TARGET), [])
        self.assertNotIn("certificate ends", self.fleet.trb("service", "list", node=TARGET).stdout)
        self.assert_same_processes()


class Rights(Life):
    block = BLOCK + 4

    def robot_node(self):
        """ur3's node, and a probe on its bus that is this file's own: ask(subtype, body, type) returns the answer."""
        fleet = support.make_fleet(self, block=BLOCK + 5, udp_port=UDP_PORT + 5, cloud=False,
                                   robots={"ur3": trb_fleet.ROBOTS["ur3"]})
        fleet.start_node("ur3")
        fleet.nodes["ur3"].wait_line("ready", 20)
        bus = self.context.socket(zmq.DEALER)
        self.addCleanup(bus.close, 0)
        bus.connect(f"ipc://{fleet.dir('ur3')}/bus/probe.ipc")
        hello = wire.Frame("service_hello", "", "", type=wire.COMMAND, id=1,
                           data=wire.pack(["scheduler", [], 1, os.getpid(), "independent"]))
        bus.send(hello.encode())
        self.assertTrue(bus.poll(WAIT * 1000))
        slot = wire.decode(bus.recv()).body()[2]
        ids = itertools.count((slot << 48) + 1)

        def ask(subtype, body, kind):
            frame = wire.Frame(subtype, "ur3", "ur3", type=kind, id=next(ids), data=wire.pack(body))
            bus.send(frame.encode())
            self.assertTrue(bus.poll(WAIT * 1000))
            answer = wire.decode(bus.recv())
            self.assertEqual(answer.reply_to, frame.id)
            return answer

        return support.Watch(fleet, "ur3"), ask

    def assert_not_permitted(self, answer):
        refusal = wire.nack(answer)
        self.assertEqual(refusal["code"], "not_permitted")
        self.assertIn("trb help rights", refusal["cure"])

    def test_a_robot_s_node_signs_no_decision(self):
        watch, ask = self.robot_node()
        for count, purpose in enumerate(("decision", "result", "certificate", "revocation_list", "seal"), 1):
            self.assert_not_permitted(ask("sign_request", [purpose, b"x"], wire.REQUEST))
            watch.wait_counted("refused.not_permitted", count)
            watch.wait_logged(f"of a robot node may not have a '{purpose}' signed")

    def test_a_probe_that_calls_itself_the_scheduler(self):
        """It cannot command a skill past the control lease, nor send the router's own subtypes."""
        watch, ask = self.robot_node()
        for count, subtype in enumerate(("execute", "cancel_execution", "adapter_state_request", "peer_expired", "hello"), 1):
            self.assert_not_permitted(ask(subtype, [], wire.COMMAND))
            watch.wait_counted("refused.not_permitted", count)
            watch.wait_logged(f"service 'scheduler' (pid {os.getpid()}) said {subtype}, which is not its word")
        self.assertEqual(ask("route_list", [], wire.REQUEST).subtype, "route_table")

    def test_a_role_without_the_right(self):
        """robot_fault is a robot's; the same member may send it once its certificate has that role."""
        key, dog = self.authority(), Member(self.fleet, "dog")
        client = self.linked(dog)
        self.send(client, "robot_fault", "dog", data=wire.pack([]))
        self.watch.wait_counted("refused.not_permitted")
        self.watch.wait_logged("not_permitted dog sent robot_fault, which a cloud node may not send")
        self.assert_alive(client, dog)
        robot = self.client(dog)
        self.hello(robot, dog, key.certificate(dog.certificate, serial=60, role=0))
        self.assertEqual(robot.receive().subtype, "hello")
        self.send(robot, "robot_fault", "dog", data=wire.pack([]))
        self.assert_alive(robot, dog)
        self.assertEqual(self.watch.rise(), {"refused.not_permitted": 1})


if __name__ == "__main__":
    support.main()
