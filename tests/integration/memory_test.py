"""What waits in a router's queues, in bytes: a sender of much to a receiver that does not read gets a Nack, all others
go on, and the memory comes back.
"""
import os
import signal
import time
import unittest

import zmq

import support
import trb_fleet
import wire
from router_client import make_context
from sealer import Sealer, Signer

BLOCK = 176
UDP_PORT = 50176
TARGET = "ant"
SLOW = [f"slow{number}" for number in range(12)]
MEGABYTE = 1 << 20
PICTURE = MEGABYTE - 256  # with its header below 1 MiB
DESTINATION = 8  # MiB that may wait for one receiver; see shell_context.cpp
NODE = 64
RECEIVED = 128  # of one connection of the bus; see socket.hpp
LINK_RECEIVED = 256  # of one link; how much of it is used depends on which of two threads a machine lets run faster
REST = 32  # the log of proof's queue, a message of each link that is being encrypted, the heaps
SANITIZED = b"__asan_init" in (support.PROGRAMS / "trb-router").read_bytes()


def resident(pid):
    """MiB."""
    with open(f"/proc/{pid}/status") as file:
        line = next(line for line in file if line.startswith("VmRSS:"))
    return int(line.split()[1]) / 1024


class Narrow:
    """A context whose sockets hold two messages: further ones stay at the router until they are read."""

    def __init__(self, context):
        self.context = context

    def socket(self, kind):
        made = self.context.socket(kind)
        made.setsockopt(zmq.RCVHWM, 2)
        made.setsockopt(zmq.RCVBUF, 64 << 10)
        return made


class Member(Sealer):
    """Seals behind each eighth message, and reads when told to."""

    def __init__(self, context, fleet, name, target=TARGET):
        super().__init__(context, fleet, Signer(fleet, name), target)
        self.nacks = {}

    def put(self, subtype, data=b"", **more):
        ident = self.say(subtype, data, **more)
        if len(self.open) >= 8:
            self.seal()
        return ident

    def hear(self):
        for frame in self.drain():
            if frame.subtype == "nack":
                code = wire.nack(frame)["code"]
                self.nacks[code] = self.nacks.get(code, 0) + 1


class Service:
    """A played service of the target: keeps everything that it receives, and can send anything."""

    def __init__(self, case, name, subtypes):
        self.socket = case.context.socket(zmq.DEALER)
        case.addClassCleanup(self.socket.close, 0)
        self.socket.connect(f"ipc://{case.fleet.dir(TARGET)}/bus/{name}.ipc")
        hello = wire.pack([name, subtypes, 1, os.getpid(), "independent", []])
        self.socket.send(wire.Frame("service_hello", "", "", type=wire.COMMAND, id=1, data=hello).encode())
        self.count = 0

    def welcomed(self):
        self.slot = self.hear("service_welcome", 20).body()[2]

    def say(self, target, subtype, data, kind=wire.COMMAND):
        self.count += 1
        self.socket.send(wire.Frame(subtype, TARGET, target, type=kind, id=self.slot << 48 | self.count,
                                    data=data).encode())

    def hear(self, subtype, timeout):
        end = time.monotonic() + timeout
        while self.socket.poll(max(0, int((end - time.monotonic()) * 1000))):
            frame = wire.decode(self.socket.recv())
            if frame.subtype == subtype:
                return frame
        raise TimeoutError(f"no {subtype} in {timeout} s")


class Fleet(support.RouterFleet):
    def start_node(self, node):
        up = [self.programs / "trb", "up", self.dir(node), "--without", "sensor-bus", "--die-with-parent"]
        self.nodes[node] = trb_fleet.Process(up, self.root / f"up-{node}.log")


class Memory(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        make_context(cls)
        services = {TARGET: ["router", "scheduler", "sensor-bus"]}
        services.update({name: ["router"] for name in ["cat", "dog", *SLOW]})
        cls.fleet = support.make_fleet(cls, Fleet, services=services, block=BLOCK, udp_port=UDP_PORT)
        cls.service = Service(cls, "sensor-bus", ["sensor_list"])
        cls.fleet.bring_up(TARGET)
        cls.service.welcomed()

    def setUp(self):
        self.pid = self.fleet.pid(TARGET, "router")
        self.watch = support.Watch(self.fleet, TARGET)
        self.begin = resident(self.pid)
        self.most = self.begin

    def tearDown(self):
        """However much waits, it is complete: nobody is cut for messages without a last part."""
        self.assertNotIn("cut.incomplete", self.watch.rise(("cut.",)))

    def joined(self, name, narrow=False):
        member = Member(Narrow(self.context) if narrow else self.context, self.fleet, name)
        self.addCleanup(member.close)
        member.join()
        self.assertEqual(member.receive().subtype, "hello")
        return member

    def look(self):
        self.most = max(self.most, resident(self.pid))

    def assert_bounded(self, mebibytes):
        print(f"{self.begin:.0f} MiB, at most {self.most:.0f}, bound {self.begin + mebibytes:.0f}", end=" ")
        if not SANITIZED:  # it keeps freed memory
            self.assertLess(self.most, self.begin + mebibytes)

    def assert_given_back(self):
        if not SANITIZED:
            self.fleet.wait("the memory comes back", lambda: resident(self.pid) < self.begin + 16, 15)

    def stop_process(self, service):
        pid = self.fleet.pid(TARGET, service)
        os.kill(pid, signal.SIGSTOP)
        self.addCleanup(os.kill, pid, signal.SIGCONT)
        return pid

    def test_a_megabyte_at_a_time_to_a_service_that_stands_still(self):
        dog = self.joined("dog")
        cat = self.joined("cat")
        scheduler = self.stop_process("scheduler")
        data = os.urandom(PICTURE)
        sent, took, end = 0, [], time.monotonic() + 5
        while time.monotonic() < end:
            for size in (PICTURE, 60_000, PICTURE, 5_000):
                cat.put("run_list", data[:size], type=wire.REQUEST)
                sent += 1
            cat.hear()
            cat.live()
            began = time.monotonic()
            dog.put("sensor_list", wire.pack([]), type=wire.REQUEST)
            self.service.hear("sensor_list", 20)
            took.append(time.monotonic() - began)
            dog.live()
            self.look()
        self.assertGreater(sent, 5 * DESTINATION)
        self.assert_bounded(DESTINATION + REST)
        # All were refused by name, except what its budget, the kernel and its own queue hold.
        self.fleet.wait("Nacks", lambda: cat.hear() or cat.live() or sum(cat.nacks.values()) >= sent // 3, 60)
        self.assertEqual(set(cat.nacks), {"queue_full"})
        self.fleet.wait("each refusal is told", lambda: cat.hear() or cat.live() or sum(cat.nacks.values()) ==
                        self.watch.rise(("dropped.",))["dropped.queue_full"], 60)
        print(f"{sent} sent, {sum(cat.nacks.values())} refused; another service heard within {max(took) * 1000:.0f} ms", end=" ")
        support.assert_quick(self, took, 2)
        # A control message is small: it is queued behind what waits, and not refused.
        cat.say("run_list", wire.pack([]), type=wire.REQUEST)
        ident = cat.say("route_list", wire.pack([]), type=wire.REQUEST)
        cat.seal()
        self.assertEqual(cat.answer_to(ident).subtype, "route_table")
        self.assertEqual(self.watch.rise(("dropped.",))["dropped.queue_full"], sum(cat.nacks.values()))
        os.kill(scheduler, signal.SIGCONT)
        self.assert_given_back()

    def flood(self, names, bound):
        """The service sends a picture to each of these, which do not read, as fast as it can; dog reads."""
        slow = {name: self.joined(name, narrow=True) for name in names}
        dog = self.joined("dog")
        data = os.urandom(PICTURE)
        # Less than a lease: a receiver that does not read sends no confirmation.
        nacks, heard, end = 0, 0, time.monotonic() + 3
        while time.monotonic() < end:
            for name in names:
                self.service.say(name, "picture", data)
            self.service.say("dog", "picture", data[:MEGABYTE // 2])
            heard += sum(frame.subtype == "picture" for frame in dog.drain())
            dog.live()
            nacks += self.refused()
            self.look()
        print(f"{len(names)} links: {nacks} refused, dog heard {heard};", end=" ")
        self.assertGreater(nacks, 0)
        self.assertGreater(heard, 3)
        self.assert_bounded(bound + RECEIVED + REST)
        # Small messages still leave for a receiver whose budget is used up.
        self.service.say(names[0], "note", b"stop")
        slow[names[0]].receive_alive(lambda frame: frame.subtype == "note", 30)
        for one in slow.values():
            one.close()
        self.assert_given_back()

    def refused(self):
        nacks = 0
        while self.service.socket.poll(0):
            frame = wire.decode(self.service.socket.recv())
            nacks += frame.subtype == "nack" and wire.nack(frame)["code"] == "queue_full"
        return nacks

    def test_a_service_that_floods_a_link_that_does_not_read(self):
        self.flood(SLOW[:1], DESTINATION)

    def test_a_service_that_floods_many_links(self):
        """Together they use the node's budget, and leave some of it to the one that reads."""
        self.flood(SLOW, NODE)

    def test_a_tap_that_stands_still(self):
        tap = self.context.socket(zmq.SUB)
        self.addCleanup(tap.close, 0)
        tap.setsockopt(zmq.RCVHWM, 2)
        tap.setsockopt(zmq.SUBSCRIBE, b"")
        tap.connect(f"ipc://{self.fleet.dir(TARGET)}/bus/tap.ipc")
        cat = self.joined("cat")
        cat.put("route_list", wire.pack([]), type=wire.REQUEST)
        tap.recv_multipart()
        data = os.urandom(PICTURE)
        end = time.monotonic() + 3
        while time.monotonic() < end:
            cat.put("sensor_list", data, type=wire.REQUEST)
            cat.hear()
            self.look()
        # The tap's messages, and those of the service that they were for.
        self.assert_bounded(2 * DESTINATION + LINK_RECEIVED + REST)
        self.assertGreater(self.watch.rise(("dropped.",)).get("dropped.tap_full", 0), 0)
        tap.close()
        self.assert_given_back()


if __name__ == "__main__":
    support.main()
