"""The lossy lane between real routers: streams go beside the links and never in their way, and a listener receives only
what is meant for it. The strangers are this file's own, the listeners lane_ends.py's; neither is the middleware's code.
"""
import os
import pathlib
import socket
import statistics
import sys
import threading
import time
import unittest

import zmq

import support
import wire
from lane_ends import LANE_PORT, LOSSY, Lanes, Listener, Probe
from router_client import PLAIN_GREETING, Client, Member, make_context
from sealer import Sealer, Signer

BLOCK = 160
UDP_PORT = 50160
TARGET = "cloud"
FLOOD = 100_000
MOST_RATIO = 20  # an alarm, not a measure: two cores are shared by both routers, this file, and whatever else runs


class Lane(unittest.TestCase):
    """Two routers and their link; belt is a member that this file plays, crane a member that is never linked."""

    @classmethod
    def setUpClass(cls):
        make_context(cls)
        services = {name: ["router"] for name in (TARGET, "arm", "belt", "crane")}
        services["arm"] = ["router", "sensor-bus"]
        cls.fleet = support.make_fleet(cls, Lanes, services=services, block=BLOCK, udp_port=UDP_PORT)
        for node in (TARGET, "arm"):
            cls.fleet.start_node(node)
        cls.sensors = Probe(cls.context, cls.fleet, "arm", "sensor-bus", ["sensor_read"])
        cls.addClassCleanup(cls.sensors.bus.close)
        for node in (TARGET, "arm"):
            cls.fleet.nodes[node].wait_line("ready", 60)
        cls.address = cls.fleet.address(TARGET)
        cls.server_key = Member(cls.fleet, TARGET).public
        cls.belt, cls.crane = Member(cls.fleet, "belt"), Member(cls.fleet, "crane")

    def setUp(self):
        self.fleet.wait("arm is linked", lambda: self.route("arm")["state"] == "ONLINE", 60)
        self.cloud, self.arm = self.probe(TARGET), self.probe("arm")
        self.cloud_asked, self.arm_asked = self.cloud.asks("arm"), self.arm.asks(TARGET)
        self.watch = support.Watch(self.fleet, TARGET)
        self.watch_arm = support.Watch(self.fleet, "arm")
        self.fleet.wait("each hears the other's lane", lambda: self.lane_is_there(), 60)

    def tearDown(self):
        for node in (TARGET, "arm"):
            self.assertNotIn("router ended", "\n".join(self.fleet.nodes[node].lines))

    def route(self, node):
        rows = self.fleet.json("route", "list", node=TARGET)["routes"]
        return next((row for row in rows if row["id"] == node), {"state": "unknown", "link": 0})

    def probe(self, node):
        probe = Probe(self.context, self.fleet, node)
        self.addCleanup(probe.bus.close)
        return probe

    def lane_is_there(self):
        """Messages are counted as sent by the lane."""
        before = (self.sent(self.watch), self.sent(self.watch_arm))
        self.cloud.stream("arm", reply_to=self.arm_asked)
        self.arm.stream(TARGET, reply_to=self.cloud_asked)
        there = (self.arm.receive().subtype, self.cloud.receive().subtype) == ("temperature", "temperature")
        return there and self.sent(self.watch) > before[0] and self.sent(self.watch_arm) > before[1]

    @staticmethod
    def sent(watch):
        return watch.rise(("lane.",)).get("lane.sent", 0)

    def listener(self, topic=None, kind=zmq.SUB, **more):
        listener = Listener(self.context, self.address, kind=kind, **more)
        self.addCleanup(listener.close)
        if topic is not None:
            listener.socket.setsockopt(zmq.SUBSCRIBE, topic)
        return listener

    def of_belt(self, topic=None, kind=zmq.SUB):
        return self.listener(topic, kind, server_key=self.server_key, keys=(self.belt.public, self.belt.secret))

    def linked(self, member):
        """A proven link of a member, made by hand; it lasts a lease."""
        client = Client(self.context, self.address, server_key=self.server_key, keys=(member.public, member.secret))
        self.addCleanup(client.close)
        client.hello(member.certificate, member.id)
        ident = client.send("route_list", member.id, type=wire.REQUEST, data=wire.pack([]))
        self.assertEqual(client.answer_to(ident).subtype, "route_table")
        return client

    def hears_own(self, listener):
        """Values for belt arrive by the lane."""
        def one():
            self.cloud.stream("belt")
            return listener.socket.poll(50)

        self.fleet.wait("belt hears its own", one, 60)
        topic, frame = listener.receive()
        self.assertEqual((topic, frame.source, frame.target), (b"belt\0", TARGET, "belt"))

    # ---- streams

    def test_a_stream_goes_beside_the_link(self):
        before = self.sent(self.watch_arm)
        values = []
        for _ in range(5):  # libzmq learns of room in halves of its bound of 256: all 200 at once might not fit
            self.arm.stream(TARGET, 40, reply_to=self.cloud_asked)
            values += [self.cloud.receive() for _ in range(40)]
        self.assertEqual({(value.subtype, value.source, value.flags, value.data) for value in values},
                         {("temperature", "arm", LOSSY, b"21.5")})
        self.fleet.wait("all are counted", lambda: self.sent(self.watch_arm) == before + 200, 60)
        self.assertEqual(self.watch.rise(("refused.", "dropped.")), {})

    def test_pictures_go_by_the_lane(self):
        """For longer than the router takes to look for messages without a last part."""
        picture = os.urandom(1_000_000)
        end, count = time.monotonic() + 1, 0
        while count < 20 or time.monotonic() < end:
            self.arm.stream(TARGET, data=picture, reply_to=self.cloud_asked)
            self.assertEqual(self.cloud.receive().data, picture)
            count += 1
        self.assertEqual(self.watch.rise(("cut.", "refused.")), {})

    def test_a_flood_is_not_in_the_way_of_control(self):
        asker = self.probe("arm")
        idle = [asker.ask(TARGET) for _ in range(300)]
        before = self.sent(self.watch_arm)
        frames = self.arm.value(TARGET, b"x" * 200, self.cloud_asked)
        ended = threading.Event()

        def flood():
            for _ in range(FLOOD):
                self.arm.bus.send(frames)

        def hear():
            while not ended.is_set():
                if self.cloud.bus.poll(20):
                    self.cloud.bus.recv()

        threads = [threading.Thread(target=work, daemon=True) for work in (flood, hear)]
        for thread in threads:
            thread.start()
        loaded = []
        while threads[0].is_alive() or len(loaded) < 100:
            loaded.append(asker.ask(TARGET))
        ended.set()
        threads[1].join(5)

        def where(watch, name, prefix):
            return watch.rise((prefix,)).get(name, 0)

        def gone():
            return self.sent(self.watch_arm) - before + where(self.watch_arm, "dropped.lane_full", "dropped.")

        self.fleet.wait("each was sent or counted", lambda: gone() == FLOOD, 60)
        ratio = statistics.median(loaded) / statistics.median(idle)
        print(f"{FLOOD} lossy messages beside {len(loaded)} questions: idle p50 {1e6 * statistics.median(idle):.0f} us, under "
              f"them p50 {1e6 * statistics.median(loaded):.0f} us (x {ratio:.1f}), max {1e3 * max(loaded):.0f} ms; "
              f"{self.watch_arm.rise(('lane.', 'dropped.'))}, {self.watch.rise(('lane.', 'dropped.'))}", file=sys.stderr)
        self.assertLess(ratio, MOST_RATIO)
        support.assert_quick(self, loaded, 2)
        self.assertEqual(self.watch_arm.rise(("refused.", "cut.")) | self.watch.rise(("refused.", "cut.")), {})

    # ---- strangers

    def test_strangers_do_not_get_in(self):
        stranger = self.listener(b"", server_key=self.server_key)
        stranger.wait_event(zmq.EVENT_HANDSHAKE_FAILED_AUTH)
        self.watch.wait_counted("refused.lane_key")
        # libzmq's own client may disconnect first, and the router would not know why: see strangers_test.
        bare = socket.create_connection((self.address, LANE_PORT))
        self.addCleanup(bare.close)
        bare.sendall(PLAIN_GREETING)
        self.watch.wait_counted("refused.lane_no_curve")
        plain = socket.create_connection((self.address, LANE_PORT))
        self.addCleanup(plain.close)
        plain.sendall(b"\xff" * 12)
        plain.shutdown(socket.SHUT_WR)
        self.watch.wait_counted("refused.lane_no_zmtp")
        wrong = self.listener(b"", server_key=Member(self.fleet, "arm").public)
        self.watch.wait_counted("refused.lane_wrong_server_key")
        for one in (stranger, wrong):
            self.assertTrue(one.hears_nothing())

    def test_a_member_without_a_link_does_not_get_in(self):
        crane = self.listener(b"crane\0", server_key=self.server_key, keys=(self.crane.public, self.crane.secret))
        crane.wait_event(zmq.EVENT_HANDSHAKE_FAILED_AUTH)
        self.watch.wait_counted("refused.lane_key")

    def test_connections_that_prove_nothing_are_bounded(self):
        """The 33rd of one source at a time: the inbox's door, with less room."""
        held = [socket.create_connection((self.address, LANE_PORT), 20, ("127.0.163.200", 0)) for _ in range(33)]
        self.addCleanup(lambda: [one.close() for one in held])
        self.watch.wait_counted("refused.lane_source_blocked")
        support.assert_quick(self, [self.arm.ask(TARGET) for _ in range(3)], 2)
        self.assertTrue(self.lane_is_there())

    def test_a_flood_of_the_lane_s_door_is_not_the_inbox_s(self):
        held = [socket.create_connection((self.address, LANE_PORT), 20, (f"127.0.163.{number}", 0))
                for number in range(1, 9) for _ in range(20)]
        self.addCleanup(lambda: [one.close() for one in held])
        self.linked(self.belt)
        self.assertTrue(self.lane_is_there())

    # ---- members

    def test_who_wants_to_hear_what_is_another_s_is_cut(self):
        for count, topic in enumerate((b"arm\0", b"", b"b", b"belt", b"cloud\0"), 1):
            self.linked(self.belt)
            thief = self.of_belt(topic)
            self.watch.wait_counted("refused.lane_topic", count)
            thief.wait_event(zmq.EVENT_DISCONNECTED)
            self.assertTrue(thief.hears_nothing(0))
        self.watch.wait_logged("lane_topic belt subscribes to what")
        self.linked(self.belt)
        self.hears_own(self.of_belt(b"belt\0"))

    def test_who_talks_to_the_lane_is_barred_and_hears_nothing_of_others(self):
        """libzmq alone would give a later subscription's place to the wrong connection."""
        self.linked(self.belt)
        talker = self.of_belt(kind=zmq.XSUB)
        talker.wait_event(zmq.EVENT_HANDSHAKE_SUCCEEDED)
        for word in (b"word", b"\x01arm\0", b"\x01belt\0", b"word", b"\x01arm\0"):
            talker.socket.send(word)
        self.watch.wait_counted("refused.lane_word")
        talker.wait_event(zmq.EVENT_DISCONNECTED)
        for _ in range(20):
            self.cloud.stream("arm", reply_to=self.arm_asked)
            self.assertEqual(self.arm.receive().subtype, "temperature")
        self.assertTrue(talker.hears_nothing(0))
        again = self.of_belt(b"belt\0")
        again.wait_event(zmq.EVENT_HANDSHAKE_FAILED_AUTH)
        self.fleet.wait("arm's lane is there", lambda: self.lane_is_there(), 60)

    def test_a_peer_that_stops_reading(self):
        """Others' messages and streams go on, its own control too; what it does not take is dropped and counted."""
        client = Sealer(self.context, self.fleet, Signer(self.fleet, "belt"), TARGET).join()
        self.addCleanup(client.close)
        self.assertEqual(client.receive().subtype, "hello")
        stuck = self.of_belt(b"belt\0")
        self.hears_own(stuck)
        idle = [self.cloud.ask("arm") for _ in range(100)]

        def live():
            """For another lease: this takes long on a slow machine."""
            for _ in client.drain():
                pass
            client.live()

        def full():
            live()
            self.cloud.stream("belt", 500, b"x" * 4000)
            return self.watch.rise(("dropped.",)).get("dropped.lane_full", 0) > 100

        self.fleet.wait("its queue is full", full, 60)
        self.assertTrue(self.lane_is_there())
        loaded = [self.cloud.ask("arm") for _ in range(100)]
        self.assertLess(statistics.median(loaded), MOST_RATIO * statistics.median(idle))
        live()
        ident = client.say("route_list", wire.pack([]), type=wire.REQUEST)
        client.seal()
        self.assertEqual(client.answer_to(ident).subtype, "route_table")

    def test_a_listener_that_stops_reading_pictures_holds_few(self):
        self.linked(self.belt)
        stuck = self.of_belt(b"belt\0")
        self.hears_own(stuck)
        memory = self.resident_mb()
        for _ in range(60):
            self.cloud.stream("belt", data=bytes(1_000_000))
        self.watch.wait_counted("dropped.lane_full", 40, prefixes=("dropped.",))
        self.assertLess(self.resident_mb() - memory, 30)

    def test_who_subscribes_again_and_again_has_one_share(self):
        self.linked(self.belt)
        stuck = self.of_belt(kind=zmq.XSUB)
        stuck.socket.send(b"\x01belt\0")
        self.hears_own(stuck)
        memory = self.resident_mb()
        for _ in range(60):
            stuck.socket.send(b"\x01belt\0")
            self.cloud.stream("belt", data=bytes(1_000_000))
        self.watch.wait_counted("dropped.lane_full", 40, prefixes=("dropped.",))
        self.assertLess(self.resident_mb() - memory, 30)

    def resident_mb(self):
        statm = pathlib.Path("/proc") / str(self.fleet.pid(TARGET, "router")) / "statm"
        return int(statm.read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE") / 2**20

    def test_the_lane_closes_with_its_link(self):
        client = self.linked(self.belt)
        listener = self.of_belt(b"belt\0")
        self.hears_own(listener)
        client.send("goodbye", "belt", data=wire.pack(["done"]))
        listener.wait_event(zmq.EVENT_DISCONNECTED)
        again = self.of_belt(b"belt\0")
        again.wait_event(zmq.EVENT_HANDSHAKE_FAILED_AUTH)

    def test_who_does_not_listen_gets_little_by_its_link(self):
        client = self.linked(self.belt)
        self.cloud.stream("belt", 100)
        values = 0
        while values < 20:
            values += client.receive().subtype == "temperature"
        self.watch.wait_counted("dropped.no_lane", 80, prefixes=("dropped.",))

    def test_lossy_words_of_one_s_own_node_need_no_lane(self):
        other = self.probe("arm")
        before = self.sent(self.watch_arm)
        other.send_request("arm", "sensor_read", ["temperature", "", 1.0])
        asked = self.sensors.receive()
        self.arm.stream("arm", 5, reply_to=asked.id)  # from a node that was not asked
        self.watch_arm.wait_counted("refused.not_asked", 5)
        self.sensors.stream("arm", 50, reply_to=asked.id)
        self.assertEqual([other.receive().data for _ in range(50)], [b"21.5"] * 50)
        self.arm.stream("nobody", 5)
        self.watch_arm.wait_counted("dropped.unknown_target", 5, prefixes=("dropped.",))
        self.assertTrue(self.arm.hears_nothing(), "a lossy message was Nacked")
        self.assertEqual(self.sent(self.watch_arm), before)

    def test_z_a_revoked_member_hears_no_more(self):
        """The last test: belt is revoked from here on."""
        self.linked(self.belt)
        listener = self.of_belt(b"belt\0")
        self.hears_own(listener)
        self.fleet.trb("fleet", "revoke", self.fleet.authority_dir(), "belt", "--via", self.fleet.dir(TARGET))
        listener.wait_event(zmq.EVENT_DISCONNECTED)
        self.of_belt(b"belt\0").wait_event(zmq.EVENT_HANDSHAKE_FAILED_AUTH)
        self.watch.wait_counted("refused.lane_key")

if __name__ == "__main__":
    support.main()
