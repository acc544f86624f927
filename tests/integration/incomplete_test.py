"""Messages whose last part never comes, of which libzmq bounds neither number nor bytes: whoever sends them is cut, counted
and kept out, the router's memory stays bounded, and all others go on. The senders are raw_peer.py's.
"""
import contextlib
import itertools
import os
import socket
import threading
import time
import unittest

import zmq.utils.z85

import support
import wire
from raw_peer import RawPeer, pair
from router_client import Client, Member, make_context
from sealer import Sealer, Signer

BLOCK = 196
UDP_PORT = 50196
TARGET = "ant"
MEBIBYTE = 1 << 20
ENDLESS = 1024 * MEBIBYTE  # more than the bound, less than a machine has
BOUND = 250  # MiB: what this machine sends itself, without a network, between two looks
ids = itertools.count(1)


def raw(key):
    return zmq.utils.z85.decode(key)


def resident(pid):
    """MiB."""
    with open(f"/proc/{pid}/statm") as file:
        return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE") / MEBIBYTE


class Parts(unittest.TestCase):
    """Ant and bee are routers and linked; cat, dog, elk and fox are members that this file plays."""

    @classmethod
    def setUpClass(cls):
        make_context(cls)
        services = {name: ["router"] for name in (TARGET, "bee", "cat", "dog", "elk", "fox", "zebu")}
        cls.fleet = support.make_fleet(cls, support.RouterFleet, services=services, block=BLOCK, udp_port=UDP_PORT)
        cls.fleet.bring_up(TARGET, "bee")
        cls.address = cls.fleet.address(TARGET)
        cls.server_key = raw(Member(cls.fleet, TARGET).public)

    def setUp(self):
        self.fleet.wait("bee is linked", lambda: self.route("bee").get("state") == "ONLINE", 60)
        self.pid = self.fleet.pid(TARGET, "router")
        self.watch = support.Watch(self.fleet, TARGET)
        self.link = self.route("bee")["link"]
        self.begin = self.most = resident(self.pid)

    def tearDown(self):
        """The router is the same process, and the other link the same link."""
        self.assertEqual(self.fleet.pid(TARGET, "router"), self.pid)
        self.assertEqual(self.route("bee")["link"], self.link)

    def route(self, node):
        rows = self.fleet.json("route", "list", node=TARGET)["routes"]
        return next((row for row in rows if row["id"] == node), {})

    # ---- the attackers' ends

    def call(self, member=None, host=None, port=45000, kind=b"DEALER"):
        """A connection to the router, by a member's keys, or by nobody's."""
        keys = (raw(member.public), raw(member.secret)) if member else pair()
        source = ("127.0.197.7", 0)
        peer = RawPeer(socket.create_connection((host or self.address.split(":")[0], port), 20, source), *keys, kind,
                       self.server_key)
        self.addCleanup(peer.close)
        return peer

    def listen(self, host):
        door = socket.create_server((host, 0))
        self.addCleanup(door.close)
        door.settimeout(30)
        return door, f"{host}:{door.getsockname()[1]}"

    def taken(self, door, member, kind):
        """The router's connection to this door."""
        peer = RawPeer(door.accept()[0], raw(member.public), raw(member.secret), kind)
        self.addCleanup(peer.close)
        return peer

    def say(self, peer, subtype, member, link, sequence, data):
        peer.send(wire.Frame(subtype, member.id, TARGET, data=data, id=next(ids), link=link, sequence=sequence).encode())

    def greeting(self, member, address="", lane=""):
        profile = ["", "", "", "", "", [], [], [], [], "", "", False, ""]
        return wire.pack([member.certificate, next(Client.boots), address, "independent", time.time_ns(), True, profile, 0,
                          "behind", False, lane])

    def hello(self, peer, member, address="", link=None):
        link = link or next(ids) << 32
        self.say(peer, "hello", member, link, 1, self.greeting(member, address))
        return link

    def linked(self, member, **more):
        peer = self.call(member)
        peer.link_id = self.hello(peer, member, **more)
        self.assertEqual(wire.decode(peer.receive()).subtype, "hello")
        return peer

    @contextlib.contextmanager
    def kept_alive(self, link):
        """Meanwhile its lease does not end, however long a busy machine needs to send all parts."""
        ended = threading.Event()

        def go_on():
            while not ended.wait(0.3):
                for _ in link.drain():
                    pass  # what was heard is in the keep-alive
                link.live()

        thread = threading.Thread(target=go_on)
        thread.start()
        try:
            yield
        finally:
            ended.set()
            thread.join()

    # ---- what all see

    def send_parts(self, peer, size=MEBIBYTE):
        """In a thread, so that the router's memory can be looked at."""
        done = []
        thread = threading.Thread(target=lambda: done.append(peer.send_parts(size, ENDLESS)))
        thread.start()
        while thread.is_alive():
            self.most = max(self.most, resident(self.pid))
            thread.join(0.005)
        sent, ended = done[0]
        print(f"{sent / MEBIBYTE:.1f} MiB sent; {self.begin:.0f} MiB before, at most {self.most:.0f}", end=" ")
        self.assertTrue(ended, "its connection was not ended")
        self.watch.wait_counted("cut.incomplete", prefixes=("cut.",))
        if not support.is_sanitized():
            self.assertLess(self.most, self.begin + BOUND)
            # Last: it may take longer than what a test looks at next lasts, a lease or a time of being kept out.
            self.addCleanup(self.fleet.wait, "the memory comes back", lambda: resident(self.pid) < self.begin + 32, 15)

    def assert_listed(self, node):
        findings = self.fleet.json("doctor", node=TARGET, check=False)["findings"]
        self.assertIn(("incomplete", node), {(row["cause"], row["subject"]) for row in findings})
        self.watch.wait_logged(f"incomplete {node}: ")

    def assert_kept_out(self, member):
        with self.assertRaises((ConnectionError, socket.timeout)):
            self.call(member)
        self.watch.wait_counted("refused.noisy_key")

    def test_a_stranger(self):
        self.send_parts(self.call())
        self.watch.wait_logged("incomplete the connection of 127.0.197.7:")

    def test_a_stranger_with_small_parts(self):
        self.send_parts(self.call(), 100)

    def test_a_link_that_a_member_dialled(self):
        cat = Member(self.fleet, "cat")
        self.send_parts(self.linked(cat))
        self.assert_listed("cat")
        self.assert_kept_out(cat)
        # It may come back.
        self.fleet.wait("it is let in again", lambda: self.comes_back(cat), 30)

    def comes_back(self, member):
        try:
            self.linked(member)
            return True
        except (ConnectionError, socket.timeout):
            return False

    def test_a_link_that_a_member_dialled_with_small_parts(self):
        self.send_parts(self.linked(Member(self.fleet, "fox")), 200)

    def test_a_link_that_the_router_dialled(self):
        """The smaller id dials at once when it learns an address."""
        zebu = Member(self.fleet, "zebu")
        door, address = self.listen("127.0.197.8")
        first = self.linked(zebu, address=address)
        first.close()
        peer = self.taken(door, zebu, b"ROUTER")
        link = wire.decode(peer.receive()).link
        self.hello(peer, zebu, address=address, link=link)
        self.fleet.wait("zebu is linked", lambda: self.route("zebu").get("state") == "ONLINE", 30)
        self.send_parts(peer)
        # It is not dialled for a while. (The doctor looks whether somebody listens there.)
        door.settimeout(5)
        with self.assertRaises(socket.timeout):
            door.accept()
        door.settimeout(30)
        door.accept()[0].close()
        self.assert_listed("zebu")

    def test_the_lane_of_a_member(self):
        dog = Signer(self.fleet, "dog")
        door, address = self.listen("127.0.197.9")
        link = Sealer(self.context, self.fleet, dog)
        self.addCleanup(link.close)
        link.say("hello", self.greeting(dog, lane=address))
        link.receive_until(lambda frame: frame.subtype == "hello")
        lane = self.taken(door, dog, b"XPUB")
        with self.kept_alive(link):
            self.send_parts(lane)
            # The link goes on; the lane is not dialled again beside it.
            self.assertEqual(self.route("dog").get("state"), "ONLINE")
            door.settimeout(3)
            with self.assertRaises(socket.timeout):
                door.accept()
            self.assert_listed("dog")
            self.assertEqual(self.route("dog").get("state"), "ONLINE")

    def test_a_listener_of_the_router_s_own_lane(self):
        elk = Member(self.fleet, "elk")
        self.linked(elk)
        listener = self.call(elk, port=45001, kind=b"SUB")
        listener.send(b"\x01elk\0")
        self.send_parts(listener, 900)


if __name__ == "__main__":
    support.main()
