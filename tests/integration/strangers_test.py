"""Strangers at a router's door: each is refused, counted under a name of its own, distinguished in the log, and keeps
no good node out. The strangers are the tests' own client: router_client.py.
"""
import os
import secrets
import signal
import socket
import subprocess
import time
import unittest

import zmq

import support
import wire
from router_client import PLAIN_GREETING, TARGET, WAIT, Client, Member, make_context

BLOCK = 40
UDP_PORT = 50040


class Door(unittest.TestCase):
    """A router with a scheduler, a good node, and the keys of members that this file plays."""

    @classmethod
    def setUpClass(cls):
        make_context(cls)
        services = {TARGET: ["router", "scheduler"], "arm": ["router"], "belt": ["router"], "crane": ["router"],
                    "hoist": ["router"]}
        cls.fleet = support.make_fleet(cls, support.RouterFleet, services=services, block=BLOCK, udp_port=UDP_PORT)
        cls.fleet.bring_up(TARGET, "arm")
        cls.address = cls.fleet.address(TARGET)
        cls.server_key = Member(cls.fleet, TARGET).public
        cls.belt = Member(cls.fleet, "belt")
        cls.crane = Member(cls.fleet, "crane")

    def setUp(self):
        self.fleet.wait("arm is linked", lambda: self.route("arm")["state"] == "ONLINE", 60)
        self.watch = support.Watch(self.fleet, TARGET)
        self.assertTrue(self.watch.log_path.exists())

    def tearDown(self):
        """After any stranger: a good node that starts now is linked, and the router is the same process."""
        boot = self.route("arm")["boot"]
        self.fleet.trb("reload", self.fleet.dir("arm"))
        self.fleet.wait("a good node joins again", lambda: self.good_after(boot), 60)
        self.assertIn("peer_joined arm", self.watch.log())
        self.assertNotIn("router ended", "\n".join(self.fleet.nodes[TARGET].lines))

    def good_after(self, boot):
        row = self.route("arm")
        return row["state"] == "ONLINE" and int(row["boot"]) > int(boot)

    def route(self, node):
        rows = self.fleet.json("route", "list", node=TARGET)["routes"]
        return next((row for row in rows if row["id"] == node), {"state": "unknown", "boot": 0, "link": 0})

    def client(self, **more):
        client = Client(self.context, self.address, **more)
        self.addCleanup(client.close)
        return client

    def stranger(self):
        return self.client(server_key=self.server_key)

    def linked(self, member):
        """A proven link of a member, made by hand."""
        client = self.client(server_key=self.server_key, keys=(member.public, member.secret))
        client.hello(member.certificate, member.id)
        answer = client.receive()
        self.assertEqual((answer.subtype, answer.source, answer.link), ("hello", TARGET, client.link))
        self.assertEqual(answer.sequence, 1)
        return client

    def assert_alive(self, client, member):
        """The link still carries a request and its answer."""
        ident = client.send("route_list", member.id, type=wire.REQUEST, data=wire.pack([]))
        self.assertEqual(client.answer_to(ident).subtype, "route_table")

    def assert_closed_by_the_router(self, plain):
        """Once the handshake's two seconds are over; the router first sends its own greeting."""
        plain.settimeout(WAIT)
        try:
            while plain.recv(1000):
                pass
        except ConnectionResetError:
            pass

    def assert_refused(self, counter, logged, count=1, also=()):
        """That counter rose by this number and no other refusal did; the log has a line of its own for it."""
        self.watch.wait_counted(counter, count)
        risen = self.watch.rise()
        self.assertEqual(risen.pop(counter), count)
        self.assertLessEqual(set(risen), set(also))
        self.watch.wait_logged(logged)


class Crowd(Door):
    """Apart from the others: that many refusals use up the log's limit of ten seconds."""

    def test_forty_candidates_at_once_and_a_member(self):
        """A member that the router knows joins at once; an unknown one when the crowd is gone."""
        self.linked(self.belt)
        first = self.watch
        for _ in range(3):  # a busy machine lets the crowd's two seconds pass before the member comes
            ends, member, were_there = self.crowd_and_member()
            if were_there:
                break
            self.watch.wait_counted("refused.no_hello", ends.count(zmq.EVENT_HANDSHAKE_SUCCEEDED))
            self.watch = support.Watch(self.fleet, TARGET)
        self.assertTrue(were_there, "the crowd was gone before the member came")
        self.assert_alive(member, self.belt)
        self.assertEqual(ends.count(zmq.EVENT_HANDSHAKE_SUCCEEDED), 32)
        self.watch.wait_counted("refused.too_many_candidates", 8)
        self.watch.wait_counted("refused.no_hello", 32)
        risen = self.watch.rise()
        self.assertEqual((risen.pop("refused.too_many_candidates"), risen.pop("refused.no_hello")), (8, 32))
        self.assertLessEqual(set(risen), {"refused.key"})
        first.wait_logged("too_many_candidates no room")
        self.assert_alive(self.linked(self.crane), self.crane)

    def crowd_and_member(self):
        """How each handshake of the crowd ended, the member's link, and whether the crowd was there until then."""
        crowd = [self.stranger() for _ in range(40)]
        ends = [one.wait_event(zmq.EVENT_HANDSHAKE_SUCCEEDED, zmq.EVENT_HANDSHAKE_FAILED_AUTH) for one in crowd]
        member = self.linked(self.belt)
        return ends, member, self.watch.rise().get("refused.no_hello", 0) == 0


class Strangers(Door):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.foreign = support.make_fleet(cls, support.RouterFleet, services={"intruder": ["router"]}, block=BLOCK + 1,
                                         udp_port=UDP_PORT, name="other")

    # ---- who does not get through the handshake

    def test_a_client_without_curve(self):
        plain = socket.create_connection((self.address, 45000), timeout=WAIT)
        self.addCleanup(plain.close)
        plain.sendall(PLAIN_GREETING)
        self.assert_closed_by_the_router(plain)
        self.assert_refused("refused.no_curve", "no_curve a client without CURVE")

    def test_libzmq_without_curve(self):
        """It sees the router's mechanism and disconnects; which side is first decides what the router can know."""
        client = self.client()
        client.wait_event(zmq.EVENT_HANDSHAKE_FAILED_PROTOCOL, zmq.EVENT_HANDSHAKE_FAILED_NO_DETAIL, zmq.EVENT_DISCONNECTED,
                          zmq.EVENT_CLOSED)
        self.fleet.wait("it is counted", self.watch.rise, WAIT)
        self.assertLessEqual(set(self.watch.rise()), {"refused.no_curve", "refused.no_zmtp"})

    def test_a_wrong_server_key(self):
        self.client(server_key=zmq.curve_keypair()[0])
        self.assert_refused("refused.wrong_server_key", "wrong_server_key a client dialled with a wrong server key")

    def test_garbage_and_half_open_connections(self):
        sockets = [socket.create_connection((self.address, 45000), timeout=WAIT) for _ in range(12)]
        for index, plain in enumerate(sockets):
            self.addCleanup(plain.close)
            if index % 3 == 1:
                plain.sendall(b"GET / HTTP/1.1\r\nHost: robot\r\n\r\n")
            elif index % 3 == 2:
                plain.sendall(b"\xff" + secrets.token_bytes(200))
        client = self.linked(self.belt)
        self.assert_alive(client, self.belt)
        for plain in sockets:
            self.assert_closed_by_the_router(plain)
        self.watch.wait_counted("refused.no_zmtp", 4)
        self.watch.wait_logged("no_zmtp a client that does not speak ZMTP")
        self.assertLessEqual(set(self.watch.rise()), {"refused.no_zmtp", "refused.no_curve"})

    # ---- candidates

    def test_an_unknown_key_that_says_nothing(self):
        start = time.monotonic()
        client = self.stranger()
        client.wait_event(zmq.EVENT_HANDSHAKE_SUCCEEDED)
        self.assert_refused("refused.no_hello", "no_hello the unknown key ")
        self.assertGreater(time.monotonic() - start, 1.0)

    def test_an_unknown_key_whose_first_word_is_no_hello(self):
        client = self.stranger()
        client.send("move", "belt", type=wire.COMMAND, data=b"[0]")
        self.assertEqual(client.wait_goodbye(), "unknown_peer_key")
        self.assert_refused("refused.unknown_peer_key", "candidate_refused unknown_peer_key")
        self.assertIn("sent move", self.watch.log())

    def test_a_refused_key_stays_out(self):
        keys = zmq.curve_keypair()
        client = self.client(server_key=self.server_key, keys=keys)
        client.send("move", "belt")
        client.wait_goodbye()
        again = self.client(server_key=self.server_key, keys=keys)
        again.wait_event(zmq.EVENT_HANDSHAKE_FAILED_AUTH)
        self.assert_refused("refused.denied_key", "denied_key the key ", also=("refused.unknown_peer_key", "refused.key"))
        try:
            client.hello(self.belt.certificate, "belt")  # on the connection that was refused, too
        except zmq.Again:  # on a slow machine the router has cut it first
            client.wait_event(zmq.EVENT_DISCONNECTED)
        else:
            self.fleet.wait("it is not read", lambda: self.watch.counters().get("dropped.closed_link", 0) >= 1, WAIT)

    def test_a_certificate_of_another_fleet(self):
        intruder = Member(self.foreign, "intruder")
        client = self.client(server_key=self.server_key, keys=(intruder.public, intruder.secret))
        client.hello(intruder.certificate, "intruder")
        self.assertEqual(client.wait_goodbye(), "foreign_fleet")
        self.assert_refused("refused.foreign_fleet", "candidate_refused foreign_fleet: certificate of 'intruder'")

    def test_a_certificate_changed_by_one_byte(self):
        kind, signer, payload, signature = self.crane.certificate
        at = payload.index(b"crane")
        changed = {
            "its payload": [kind, signer, payload[:at] + b"crone" + payload[at + 5:], signature],
            "its signature": [kind, signer, payload, bytes([signature[0] ^ 1]) + signature[1:]],
        }
        for count, (what, certificate) in enumerate(changed.items(), 1):
            with self.subTest(what):
                client = self.stranger()
                client.hello(certificate, "crane")
                self.assertEqual(client.wait_goodbye(), "bad_signature")
                self.assert_refused("refused.bad_signature", "candidate_refused bad_signature", count)

    def test_a_certificate_on_the_connection_of_another_key(self):
        client = self.stranger()
        client.hello(self.crane.certificate, "crane")
        self.assertEqual(client.wait_goodbye(), "wrong_key")
        self.assert_refused("refused.wrong_key", "candidate_refused wrong_key: certificate of 'crane'")

    # ---- members that overstep

    def test_a_member_that_claims_another_source(self):
        client = self.linked(self.belt)
        client.send("greeting", "arm", data=b"it is me")
        self.assert_refused("refused.source_mismatch", "source_mismatch link of belt carried source arm")
        self.assert_alive(client, self.belt)

    def test_a_hello_under_another_name(self):
        hoist = Member(self.fleet, "hoist")
        client = self.client(server_key=self.server_key, keys=(hoist.public, hoist.secret))
        client.hello(hoist.certificate, "belt")
        self.assertEqual(client.wait_goodbye(), "source_mismatch")
        self.assert_refused("refused.source_mismatch", "Hello of 'belt' with the certificate of 'hoist'")

    def test_a_member_that_names_another_link(self):
        arm = self.route("arm")
        for count, name in enumerate(("belt", "arm"), 1):
            belt, crane = self.linked(self.belt), self.linked(self.crane)
            link = belt.link if name == "belt" else int(arm["link"])
            crane.send("greeting", "belt", link=link, sequence=2, data=b"it is me")
            self.watch.wait_counted("refused.link_theft", count)
            self.assert_alive(belt, self.belt)
            self.assert_alive(crane, self.crane)
            self.assert_refused("refused.link_theft", "link_theft a connection used another one's link id", count)
        self.assertEqual(self.route("arm")["link"], arm["link"])

    def test_a_gap_in_the_sequence(self):
        for step in (2, 0):
            with self.subTest(step=step):
                self.watch = support.Watch(self.fleet, TARGET)
                client = self.linked(self.belt)
                client.send("route_list", "belt", type=wire.REQUEST, sequence=client.sequence + step)
                self.assertIn("sequence", client.wait_goodbye())
                self.assert_refused("refused.sequence", f"sequence_gap belt: sequence {1 + step} after 1")
        self.assert_alive(self.linked(self.belt), self.belt)

    def test_words_that_are_the_node_s_own(self):
        for count, subtype in enumerate(("execute", "sign_request", "run_submit", "service_hello"), 1):
            client = self.linked(self.belt)  # for each one: it lasts a lease
            ident = client.send(subtype, "belt", type=wire.COMMAND, data=wire.pack([]))
            answer = client.answer_to(ident)
            self.assertEqual((answer.subtype, wire.nack(answer)["code"]), ("nack", "not_permitted"))
            self.assert_alive(client, self.belt)
            self.assert_refused("refused.not_permitted", f"not_permitted belt sent {subtype}", count)

    def test_an_oversized_frame(self):
        client = self.linked(self.belt)
        large = bytes((1 << 20) + 1)
        client.send("greeting", "belt", data=large)  # one byte over the limit of the data
        self.assertEqual(client.wait_goodbye(), "sent a frame that is none: too_large")
        self.assert_refused("refused.too_large", "frame_refused too_large")
        client = self.linked(self.belt)
        client.send("greeting", "belt", data=bytes(2 << 20))  # not even read: libzmq ends the connection
        client.wait_event(zmq.EVENT_DISCONNECTED)
        self.assert_alive(self.linked(self.belt), self.belt)

    def test_an_oversized_hello_of_a_stranger(self):
        client = self.stranger()
        client.send("hello", "crane", data=wire.hello(self.crane.certificate, 1, "x" * 4096))
        self.assertEqual(client.wait_goodbye(), "too_large")
        self.assert_refused("refused.too_large", "candidate_refused too_large: Hello over 4 kB")

    def test_a_malformed_request_of_a_member(self):
        client = self.linked(self.belt)
        ident = client.send("route_list", "belt", type=wire.REQUEST, data=b"\xc1")
        self.assertEqual(wire.nack(client.answer_to(ident))["code"], "malformed")
        self.assert_refused("refused.malformed", "message_refused belt sent route_list: malformed")
        self.assert_alive(client, self.belt)

    # ---- beacons

    def beacon_from(self, plain, address):
        while True:
            datagram, sender = plain.recvfrom(4096)
            if sender[0] == address:
                return datagram

    def test_beacons(self):
        plain = support.beacon_listener(self, UDP_PORT, 60)
        sender = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.addCleanup(sender.close)
        sender.setsockopt(socket.SOL_SOCKET, socket.SO_BROADCAST, 1)

        def shout(datagram):
            sender.sendto(datagram, ("127.255.255.255", UDP_PORT))

        boot = self.route("arm")["boot"]
        self.fleet.trb("reload", self.fleet.dir("arm"))
        good = self.beacon_from(plain, self.fleet.address("arm"))
        self.fleet.wait("arm is linked", lambda: self.good_after(boot), 60)
        with self.subTest("replayed"):
            shout(good)
            self.assert_refused("beacon.replayed", "beacon_refused replayed: of 'arm'")
        with self.subTest("does not open"):
            shout(good[:-1] + bytes([good[-1] ^ 1]))
            self.assert_refused("beacon.bad_signature", "beacon_refused bad_signature: beacon does not open",
                                also=("beacon.replayed",))
        with self.subTest("garbage"):
            for garbage in (b"", b"\0", b"TRBB", secrets.token_bytes(600), secrets.token_bytes(5000), good[:40]):
                shout(garbage)
            self.watch.wait_counted("beacon.malformed", 6)
            self.watch.wait_logged("beacon_refused malformed")
        with self.subTest("another fleet's"):
            self.foreign.bring_up("intruder")
            self.watch.wait_counted("beacon.foreign_fleet")
            self.watch.wait_logged("beacon_refused foreign_fleet")
            self.foreign.stop()
        self.assertEqual(self.route("intruder")["state"], "unknown")

    # ---- the node's own bus

    def test_a_second_claimant_of_a_service(self):
        first = self.fleet.services(TARGET)["scheduler"]
        with self.subTest("an independent process"):
            bus = self.context.socket(zmq.DEALER)
            self.addCleanup(bus.close, 0)
            bus.connect(f"ipc://{self.fleet.dir(TARGET)}/bus/scheduler.ipc")
            claim = wire.pack(["scheduler", ["baton"], 7, os.getpid(), "independent"])
            bus.send(wire.Frame("service_hello", "", "", type=wire.COMMAND, id=1, data=claim).encode())
            self.assertTrue(bus.poll(WAIT * 1000))
            answer = wire.decode(bus.recv())
            self.assertEqual(wire.nack(answer)["code"], "already_claimed")
            self.assert_refused("refused.already_claimed", f"service_refused scheduler (pid {os.getpid()})")
        with self.subTest("a second scheduler"):
            second = subprocess.Popen([str(support.PROGRAMS / "trb-scheduler"), str(self.fleet.dir(TARGET))],
                                      stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
            self.addCleanup(second.stderr.close)
            self.addCleanup(second.wait)
            self.addCleanup(second.kill)
            words = second.stderr.readline()  # a line of its refusal, or the end of its output
            self.assertRegex(words, "already|in use|running|locked")
            self.assertEqual(self.fleet.services(TARGET)["scheduler"]["instance"], first["instance"])
        second.kill()
        second.wait()
        with self.subTest("one that is started again"):
            os.kill(int(first["pid"]), signal.SIGKILL)
            self.fleet.wait("the scheduler is back", lambda: self.is_back(first), 60)

    def test_a_crowd_of_probes_that_have_ended(self):
        """More in a few seconds than the bus has room for: each is accepted, because the ones before it are gone."""
        first = self.fleet.services(TARGET)["scheduler"]
        for count in range(80):
            with self.context.socket(zmq.DEALER) as bus:
                bus.setsockopt(zmq.LINGER, 0)
                bus.connect(f"ipc://{self.fleet.dir(TARGET)}/bus/probe.ipc")
                hello = wire.pack(["cli", [], count + 1, os.getpid(), "independent"])
                bus.send(wire.Frame("service_hello", "", "", type=wire.COMMAND, id=1, data=hello).encode())
                self.assertTrue(bus.poll(WAIT * 1000))
                self.assertEqual(wire.decode(bus.recv()).subtype, "service_welcome", f"probe {count + 1}")
        os.kill(int(first["pid"]), signal.SIGKILL)
        self.fleet.wait("the scheduler is back", lambda: self.is_back(first), 60)
        self.assertEqual(self.watch.rise(), {})

    def is_back(self, first):
        row = self.fleet.services(TARGET)["scheduler"]
        return row["state"] == "up" and row["pid"] != first["pid"]


if __name__ == "__main__":
    support.main()
