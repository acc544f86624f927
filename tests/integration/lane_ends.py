"""The ends of a lane that a test plays, with wire.py and libzmq, not the middleware's code: programs on a node's bus, and
listeners.
"""
import itertools
import os
import time

import zmq
from zmq.utils.monitor import parse_monitor_message

import support
import trb_fleet
import wire

LANE_PORT = 45001
LOSSY = 4


class Probe:
    """A program on a node's bus: sends requests and streams, gets answers. Or a service that takes these subtypes."""

    def __init__(self, context, fleet, node, service="probe", subtypes=()):
        self.node = node
        self.bus = context.socket(zmq.DEALER)
        self.bus.setsockopt(zmq.LINGER, 0)
        self.bus.connect(f"ipc://{fleet.dir(node)}/bus/{service}.ipc")
        name = "cli" if service == "probe" else service
        hello = wire.pack([name, list(subtypes), 1, os.getpid(), "independent"])
        self.bus.send(wire.Frame("service_hello", "", "", type=wire.COMMAND, id=1, data=hello).encode())
        self.slot = self.receive(20).body()[2]
        self.ids = itertools.count(1)
        self.next_alive = 0

    def receive(self, timeout=20):
        while self.bus.poll(int(timeout * 1000)):
            frame = wire.decode(self.bus.recv())
            if frame.subtype != "service_alive_seen":
                return frame
        raise TimeoutError(f"nothing heard in {timeout} s")

    def live(self):
        """Once a second: a probe that is silent for 10 s is dropped by its router."""
        if time.monotonic() < self.next_alive:
            return
        self.next_alive = time.monotonic() + 1
        self.bus.send(wire.Frame("service_alive", self.node, self.node, id=self.slot << 48 | next(self.ids),
                                 data=wire.pack([1])).encode())

    def hears_nothing(self, timeout=0.3):
        return not self.bus.poll(int(timeout * 1000))

    def value(self, to, data=b"21.5", reply_to=0):
        """One value of a stream: information that may be lost, in answer to an earlier request of that node's probe."""
        return wire.Frame("temperature", self.node, to, flags=LOSSY, id=self.slot << 48 | next(self.ids),
                          reply_to=reply_to, data=data).encode()

    def stream(self, to, count=1, data=b"21.5", reply_to=0):
        for _ in range(count):
            self.bus.send(self.value(to, data, reply_to))

    def send_request(self, target, subtype, body):
        ident = self.slot << 48 | next(self.ids)
        self.bus.send(wire.Frame(subtype, self.node, target, type=wire.REQUEST, id=ident, data=wire.pack(body)).encode())
        return ident

    def asks(self, target):
        """Sends that node's router a request, gets an answer; returns the id, to which more answers may come."""
        self.live()
        ident = self.send_request(target, "echo_request", [b"x" * 48])
        while True:
            frame = self.receive()
            if frame.reply_to == ident:
                if frame.subtype != "echo":
                    raise AssertionError(f"{frame.subtype}: {frame.data}")
                return ident

    def ask(self, target):
        """As asks(); in seconds."""
        began = time.monotonic()
        self.asks(target)
        return time.monotonic() - began


class Lanes(support.RouterFleet):
    """Arm's sensor-bus is played by a test."""

    def start_node(self, node):
        without = ["--without", "sensor-bus"] if node == "arm" else []
        up = [self.programs / "trb", "up", self.dir(node), *without, "--die-with-parent"]
        self.nodes[node] = trb_fleet.Process(up, self.root / f"up-{node}.log")


class Listener:
    """A SUB, or an XSUB, at a router's lane; it dials once."""

    def __init__(self, context, address, server_key=None, keys=None, kind=zmq.SUB):
        self.socket = context.socket(kind)
        self.socket.setsockopt(zmq.LINGER, 0)
        self.socket.setsockopt(zmq.RECONNECT_IVL, -1)
        self.socket.setsockopt(zmq.RCVHWM, 1)
        self.socket.setsockopt(zmq.RCVBUF, 4096)
        if server_key is not None:
            self.socket.curve_serverkey = server_key
            self.socket.curve_publickey, self.socket.curve_secretkey = keys or zmq.curve_keypair()
        self.events = self.socket.get_monitor_socket(
            zmq.EVENT_HANDSHAKE_SUCCEEDED | zmq.EVENT_DISCONNECTED | zmq.EVENT_HANDSHAKE_FAILED_AUTH)
        self.socket.connect(f"tcp://{address}:{LANE_PORT}")

    def wait_event(self, wanted, timeout=60):
        end = time.monotonic() + timeout
        while self.events.poll(max(0, int((end - time.monotonic()) * 1000))):
            if parse_monitor_message(self.events.recv_multipart())["event"] == wanted:
                return
        raise TimeoutError(f"no event {wanted} in {timeout} s")

    def receive(self, timeout=20):
        if not self.socket.poll(int(timeout * 1000)):
            raise TimeoutError(f"nothing heard in {timeout} s")
        topic, frame = self.socket.recv_multipart()
        return topic, wire.decode(frame)

    def hears_nothing(self, timeout=0.3):
        return not self.socket.poll(int(timeout * 1000))

    def close(self):
        self.socket.disable_monitor()
        self.events.close()
        self.socket.close()
