"""What goes between the computers of a fleet: each message by its phase, read at every node's tap, and all bytes of the wire,
read from the kernel. One is held against the other."""
import collections
import os
import pathlib
import re
import socket
import struct
import sys
import threading

import zmq

REPO = pathlib.Path(__file__).resolve().parents[3]
sys.path[:0] = [str(REPO / "scripts"), str(REPO / "tests" / "integration")]
import wire  # noqa: E402  (found only with the line above)

CURVE_BYTES, SHORT = 33, 255  # what CURVE adds to a frame; up to this size ZMTP says the length in one byte
UPDATE = "sensor_reading"  # of a sensor that is watched: Equation 3's updates
IPV4, TCP, UDP = 0x0800, 6, 17
HEAD = 128  # of each packet, enough for the headers of IP and TCP
SOL_PACKET, PACKET_STATISTICS, SO_RCVBUFFORCE = 263, 6, 33


def wire_size(frame_bytes):
    """Of a message between two routers, as ZMTP and CURVE send it, without TCP and IP."""
    size = frame_bytes + CURVE_BYTES
    return size + (2 if size <= SHORT else 9)


def table(name):
    """Between two marks of proto/README.md; a test of proto/ holds them against the code."""
    text = (REPO / "proto" / "README.md").read_text()
    return re.search(f"<!-- {name} -->\n(.*?)<!-- /{name} -->", text, re.DOTALL).group(1)


def phases():
    """Subtype -> phase of Equation 12, updates of sensors apart, for all of the middleware's own subtypes."""
    out = {word: "upkeep" for row in table("rights").splitlines() for word in re.findall(r"\b[a-z]+(?:_[a-z]+)*\b", row)}
    for row in table("phases").splitlines()[2:]:
        phase, words = row.strip("| ").split(" | ")
        if phase != "upkeep":
            out.update((word, phase) for word in words.split(",")[0].split())
    return {**out, UPDATE: "updates"}


def payload(packet):
    """(protocol, (source, port), (target, port), bytes without headers) of an IPv4 packet; None: neither TCP nor UDP, or cut short."""
    if len(packet) < 28 or packet[0] >> 4 != 4:
        return None
    head, length, protocol = 4 * (packet[0] & 15), int.from_bytes(packet[2:4], "big"), packet[9]
    if protocol == TCP and len(packet) >= head + 20:
        inner = 4 * (packet[head + 12] >> 4)
    elif protocol == UDP:
        inner = 8
    else:
        return None
    ports = struct.unpack_from(">HH", packet, head)
    return (protocol, *zip(map(socket.inet_ntoa, (packet[12:16], packet[16:20])), ports), length - head - inner)


class Capture(threading.Thread):
    """Counts what TCP carries to and from the routers' ports at addresses that begin with `prefix`, and UDP from there, each
    packet once. As root."""

    PORTS = (45000, 45001)  # a router's inbox, and its lane

    def __init__(self, prefix):
        super().__init__(daemon=True)
        self.prefix = prefix
        self.tcp = self.udp = self.datagrams = 0
        self.over = threading.Event()
        try:
            # Asked for IPv4 alone, the kernel shows what comes in, and not once more what goes out.
            self.socket = socket.socket(socket.AF_PACKET, socket.SOCK_DGRAM, socket.htons(IPV4))
        except PermissionError:
            raise RuntimeError("figure 16 reads the wire from the kernel: run it as root") from None
        self.socket.setsockopt(socket.SOL_SOCKET, SO_RCVBUFFORCE, 64 << 20)
        self.socket.bind(("lo", IPV4))
        self.socket.settimeout(0.2)

    def run(self):
        while not self.over.is_set():
            try:
                packet = self.socket.recv(HEAD)
            except TimeoutError:
                continue
            self.take(payload(packet))

    def take(self, seen):
        if not seen:
            return
        protocol, source, target, size = seen
        if protocol == TCP and any(host.startswith(self.prefix) and port in self.PORTS for host, port in (source, target)):
            self.tcp += size
        elif protocol == UDP and source[0].startswith(self.prefix):
            self.udp += size
            self.datagrams += 1

    def end(self):
        self.over.set()
        self.join()
        lost = struct.unpack("II", self.socket.getsockopt(SOL_PACKET, PACKET_STATISTICS, 8))[1]
        self.socket.close()
        if lost:
            raise RuntimeError(f"the kernel has dropped {lost} packets of the wire: count again on a quieter machine")


class Taps(threading.Thread):
    """Every node's tap, listened to from before its router is there. Messages and bytes that leave for other nodes, by
    (phase, subtype)."""

    def __init__(self, buses):
        super().__init__(daemon=True)
        self.phase_of = phases()
        self.messages, self.bytes = collections.Counter(), collections.Counter()
        self.over = threading.Event()
        self.context = zmq.Context()
        self.poller = zmq.Poller()
        for bus in buses:
            tap = self.context.socket(zmq.SUB)
            for option, value in ((zmq.RECONNECT_IVL, 1), (zmq.RCVHWM, 0), (zmq.LINGER, 0)):
                tap.setsockopt(option, value)
            tap.setsockopt(zmq.SUBSCRIBE, b"")
            tap.connect(f"ipc://{bus}/tap.ipc")
            self.poller.register(tap, zmq.POLLIN)

    def run(self):
        while not self.over.is_set():
            for tap, _ in self.poller.poll(100):
                direction, frame = tap.recv_multipart()
                if direction == b">":
                    self.take(frame)
        self.context.destroy(0)

    def take(self, frame):
        subtype = wire.decode(frame).subtype
        key = self.phase_of.get(subtype, "task"), subtype  # the user's own words belong to tasks
        self.messages[key] += 1
        self.bytes[key] += wire_size(len(frame))

    def end(self):
        self.over.set()
        self.join()

