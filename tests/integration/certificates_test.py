"""The life of a certificate, on real nodes: renewed and revoked while the fleet is up, and refused when it does not hold.
No process is started again in between.
"""
import json
import os
import shutil
import socket
import time
import unittest

import zmq

import authority
import support
import wire
from strangers_test import Client, Member

BLOCK = 110
UDP_PORT = 50110
WAIT = 6
TARGET = "ant"
NODES = ("ant", "bee", "cat")
SPARE = ("dog", "elk")  # have keys and certificates, and are not up: the test plays them


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
        """In force on every node within two seconds, told by one of them; nobody is started again."""
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
        """It is refused at its Hello, and handed the list that says so."""
        self.fleet.trb("fleet", "revoke", self.fleet.authority_dir(), "dog", "--via", self.fleet.dir("ant"))
        dog = Member(self.fleet, "dog")
        client = self.client(dog)
        self.hello(client, dog)
        self.assertEqual(client.receive().subtype, "fleet_news")
        self.assertEqual(client.wait_goodbye(), "cert_revoked")
        self.watch.wait_counted("refused.cert_revoked")
        self.watch.wait_logged("candidate_refused cert_revoked: certificate of 'dog' (serial 4) is revoked by list 1")

    def test_the_beacon_key_is_another_one(self):
        """What the revoked node shouts under the old key is ignored; a node that is signed now joins by beacon."""
        listener = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.addCleanup(listener.close)
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_BROADCAST, 1)
        listener.bind(("127.255.255.255", UDP_PORT))
        listener.settimeout(8)
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

    def test_lists_that_do_not_hold(self):
        """Forged, foreign, older, of the same number: each refused, counted, told apart; the links stay."""
        dog = Member(self.fleet, "dog")
        client = self.linked(dog)
        key = self.authority()
        good = key.revocations(5, [(5, "elk")])
        forged = good[:3] + [bytes([good[3][0] ^ 1]) + good[3][1:]]
        foreign = key.sign("revocation_list", wire.pack([bytes(16), 6, time.time_ns(), [], 1, []]))
        cases = [
            ("bad_signature", forged, "was not signed by this fleet's authority"),
            ("foreign_fleet", foreign, "revocation list of another fleet"),
            (None, good, "revocations list 5"),
            ("downgraded", key.revocations(4, [(2, "bee")]), "revocation list 4; list 5 is in force"),
            ("conflict", key.revocations(5, [(2, "bee")]), "another revocation list with number 5"),
            ("malformed", key.sign("revocation_list", b"noise"), "news_refused of dog: malformed"),
        ]
        for code, record, logged in cases:
            with self.subTest(code):
                self.send(client, "fleet_news", "dog", data=authority.news(record))
                self.watch.wait_logged(logged)
                if code:
                    self.watch.wait_counted(f"refused.{code}")
        self.assertEqual(self.watch.rise(), {f"refused.{code}": 1 for code, _, _ in cases if code})
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

    def test_certificates_out_of_their_time(self):
        """Expired, not yet valid, an older one: refused, counted, told apart."""
        key, dog = self.authority(), Member(self.fleet, "dog")
        day = authority.DAY
        cases = [
            ("cert_expired", key.certificate(dog.certificate, begins=-2 * day, ends=-1), "certificate of 'dog' ended"),
            ("cert_not_yet_valid", key.certificate(dog.certificate, begins=day, ends=2 * day), "'dog' is valid from"),
        ]
        for code, certificate, logged in cases:
            with self.subTest(code):
                # One stranger's key each: one that was refused stays out for a while.
                public, secret = zmq.curve_keypair()
                raw = zmq.utils.z85.decode(public)
                body, _ = wire.unpack(certificate[2])
                body[5] = raw
                client = self.client(keys=(public, secret))
                self.hello(client, dog, key.sign("certificate", wire.pack(body)))
                self.assertEqual(client.wait_goodbye(), code)
                self.watch.wait_counted(f"refused.{code}")
                self.watch.wait_logged(logged)

    def test_an_older_certificate(self):
        """Refused as downgraded, and handed the newer one, so that a node that was away while it was renewed can join."""
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

    def test_a_weaker_mechanism(self):
        """PLAIN against CURVE, NULL in strangers_test: the router speaks CURVE alone."""
        plain = self.context.socket(zmq.DEALER)
        self.addCleanup(plain.close, 0)
        plain.plain_username, plain.plain_password = b"dog", b"dog"
        plain.connect(f"tcp://{self.fleet.address(TARGET)}:45000")
        self.fleet.wait("it is counted", lambda: self.watch.rise(), WAIT)
        self.assertLessEqual(set(self.watch.rise()), {"refused.no_curve", "refused.no_zmtp"})

    def test_a_certificate_that_ends_while_connected(self):
        key, dog = self.authority(), Member(self.fleet, "dog")
        client = self.client(dog)
        self.hello(client, dog, key.certificate(dog.certificate, serial=90, ends=2 * authority.SECOND))
        self.assertEqual(client.receive().subtype, "hello")
        self.assertIn("certificate has ended", client.wait_goodbye())
        self.watch.wait_logged("link_closed dog: its certificate has ended")


if __name__ == "__main__":
    unittest.main(verbosity=2)
