"""Hostile robots: the peer at the robot's address is no robot. Each of the makers' protocols gets lines without an end,
lengths of gigabytes, unrequested answers and one byte at a time; the adapter stays the same process, small, and its
node answers the others.
"""
import os
import select
import socket
import struct
import threading
import time
import unittest

import support
import trb_fleet
from attack_fleet import SANITIZED, SLOWEST_S, Honest, resident

BLOCK = 186
ROUND_S = 1.5
LONGEST_S = 20
MEMORY_MIB = 32
# framework: (description, ports, bytes that announce far more than follows)
ROBOTS = {
    "ur": ("ur3", (29999, 30001, 30002), struct.pack(">IB", 0x7FFFFFFF, 16) + struct.pack(">IB", 0xFFFFFFF0, 0)),
    "kuka": ("kuka", (7000,), struct.pack(">HHBH", 1, 0xFFFF, 0, 0xFFFF)),
    "abb": ("abb", (5000, 5001), b"9" * 4000),
    "pioneer": ("pioneer", (8101,), b"\xfa\xfb\xff" + bytes(255)),
    "plc": ("conveyor", (trb_fleet.plc_port(),), struct.pack(">HHHB", 1, 0, 0xFFFF, 1)),
    "ardrone": ("drone", (), struct.pack("<4IHH", 0x55667788, 1, 1, 0, 0, 0xFFFF)),
    "lines": ("turtlebot", (), b"information\nposition\n\n999999999999\n" + b"x" * 4000),
}


class HostileFleet(trb_fleet.Fleet):
    """A router and a mode-adapter for each protocol; this file plays the robots."""

    def __init__(self, root, programs, **more):
        robots = {framework: (framework, description, []) for framework, (description, *_) in ROBOTS.items()}
        super().__init__(root, programs, block=BLOCK, udp_port=50000 + BLOCK, robots=robots, **more)
        self.node_names = [*robots, trb_fleet.CLOUD]

    def node_json(self, node):
        out = super().node_json(node)
        return dict(out, services=[name for name in out["services"] if name in ("router", "mode-adapter")])


class Robot(threading.Thread):
    """Accepts any connection, and sends the round's bytes. `dials`: the robot dials the node."""

    def __init__(self, fleet, framework):
        super().__init__(daemon=True)
        self.fleet, self.framework = fleet, framework
        self.ports, self.huge = ROBOTS[framework][1:]
        self.address = fleet.robot_address(framework)
        self.round, self.ended = "silent", threading.Event()
        self.said = {}
        self.peers = []
        self.doors = [socket.create_server((self.address, port)) for port in self.ports]
        self.plain = []
        if framework == "ardrone":
            for port in (5554, 5556):
                self.plain.append(socket.socket(socket.AF_INET, socket.SOCK_DGRAM))
                self.plain[-1].bind((self.address, port))
                self.plain[-1].setblocking(False)
        self.callers = {}

    def piece(self):
        return {"silent": b"", "a line without an end": b"A" * 16384, "a length of gigabytes": self.huge * 4,
                "answers to nothing": os.urandom(8192), "one byte at a time": os.urandom(1)}[self.round]

    def run(self):
        while not self.ended.is_set():
            if self.framework == "lines" and not self.peers:
                try:
                    self.peers.append(socket.create_connection((self.fleet.address("lines"), 40000), 1, (self.address, 0)))
                    self.peers[-1].setblocking(False)
                except OSError:
                    self.ended.wait(0.1)
            readable, _, _ = select.select(self.doors + self.peers + self.plain, [], [], 0.01)
            for one in readable:
                self.hear(one)
            piece = self.piece()
            if piece:
                for one in list(self.peers):
                    self.tell(one, piece)
                for door, caller in self.callers.items():
                    for _ in range(20 if len(piece) > 1 else 1):
                        self.tell(door, piece[:1400], caller)
            if len(piece) == 1:
                self.ended.wait(0.05)

    def hear(self, one):
        if one in self.doors:
            peer, _ = one.accept()
            peer.setblocking(False)
            return self.peers.append(peer)
        try:
            if one in self.plain:
                self.callers[one] = one.recvfrom(4096)[1]
            elif not one.recv(65536):
                self.drop(one)
        except BlockingIOError:
            pass
        except OSError:
            self.drop(one)

    def tell(self, one, piece, caller=None):
        try:
            size = one.sendto(piece, caller) if caller else one.send(piece)
            self.said[self.round] = self.said.get(self.round, 0) + size
        except BlockingIOError:
            pass
        except OSError:
            if caller is None:
                self.drop(one)

    def drop(self, one):
        if one in self.peers:
            self.peers.remove(one)
            one.close()

    def stop(self):
        self.ended.set()
        self.join(5)
        for one in self.doors + self.peers + self.plain:
            one.close()


class Robots(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.fleet = support.make_fleet(cls, HostileFleet)
        cls.robots = {}
        for framework in ROBOTS:
            cls.robots[framework] = Robot(cls.fleet, framework)
            cls.robots[framework].start()
            cls.addClassCleanup(cls.robots[framework].stop)
        for node in cls.fleet.node_names:
            cls.fleet.start_node(node)
        cls.fleet.wait("the nodes meet", lambda: len(cls.online()) == len(ROBOTS), 60)

    @classmethod
    def online(cls):
        rows = cls.fleet.json("route", "list", node=trb_fleet.CLOUD)["routes"]
        return {row["id"]: row["link"] for row in rows if row["state"] == "ONLINE"}

    def unheard(self, what):
        """Those that could not send it yet: an adapter that got garbage dials less and less often."""
        return [framework for framework, robot in self.robots.items() if what not in robot.said]

    def test_hostile_robots(self):
        pids = {node: self.fleet.pid(node, "mode-adapter") for node in ROBOTS}
        memory = {node: resident(pid) for node, pid in pids.items()}
        links = self.online()
        for what in ("a line without an end", "a length of gigabytes", "answers to nothing", "one byte at a time"):
            honest = Honest(self.fleet, at="ur", other="kuka")
            honest.start()
            for robot in self.robots.values():
                robot.round = what
            began = time.monotonic()
            most = dict.fromkeys(ROBOTS, 0.0)
            while time.monotonic() < began + ROUND_S or (self.unheard(what) and time.monotonic() < began + LONGEST_S):
                for node, pid in pids.items():
                    most[node] = max(most[node], resident(pid))
                time.sleep(0.05)
            for robot in self.robots.values():
                robot.round = "silent"
            honest.wait_answers(5)
            honest.end()
            self.assertIsNone(honest.fault)
            print(f"\n{what}: worst answer {max(honest.times) * 1000:.0f} ms", end=" ")
            for framework, robot in self.robots.items():
                with self.subTest(protocol=framework, says=what):
                    self.assertGreater(robot.said.get(what, 0), 0, "nothing could be said")
                    self.assertTrue(os.path.exists(f"/proc/{pids[framework]}"), "the adapter has ended")
                    if not SANITIZED:
                        self.assertLess(most[framework] - memory[framework], MEMORY_MIB)
            with self.subTest(says=what):
                support.assert_quick(self, honest.times, SLOWEST_S)
                self.assertEqual(self.online(), links)


if __name__ == "__main__":
    support.main()
