"""Observes the fleet: a service on each node's own bus that sends numbered messages to every other node and
reads the routing table. It is this file's own client (tests/integration/wire.py and libzmq), not the middleware's code.

A bus is a file, so one process sits on the buses of all hosts.
"""
import collections
import pathlib
import sys
import threading
import time

import zmq

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "integration"))
import wire  # noqa: E402

WORD = "numbered"
ROUTE = ("id", "role", "address", "state", "last_heard_s", "boot", "link", "dialled_by", "version", "clock", "certificate",
         "profile", "via")


class Seat:
    """One node's bus: the witness plays its service `scheduler`."""

    def __init__(self, context, node, folder):
        self.node, self.slot, self.said_hello, self.said_alive, self.asked = node, 0, 0.0, 0.0, 0.0
        self.table, self.table_asked, self.asked_at = {}, 0.0, {}
        self.count = 0
        self.socket = context.socket(zmq.DEALER)
        for option, value in ((zmq.LINGER, 0), (zmq.IMMEDIATE, 1), (zmq.RECONNECT_IVL, 50), (zmq.RECONNECT_IVL_MAX, 200)):
            self.socket.setsockopt(option, value)
        self.socket.connect(f"ipc://{folder}/bus/scheduler.ipc")
        self.hello = wire.pack(["scheduler", [WORD], time.time_ns() & 0xFFFFFFFF, 1, "witness"])

    def send(self, subtype, target, data, kind=wire.INFORMATION, ident=None):
        if ident is None:
            self.count += 1
            ident = self.slot << 48 | self.count
        frame = wire.Frame(subtype, self.node, target, kind, id=ident, data=data)
        try:
            self.socket.send(frame.encode(), zmq.NOBLOCK)
        except zmq.Again:  # its router is not there
            return 0
        return ident


class Witness(threading.Thread):
    """Sends a numbered message along every ordered pair of `pairs(nodes)` each `every` seconds; requests each table as
    often.

    duplicates, wrong: messages that came twice, or to a wrong node, or from another than the named one.
    """

    def __init__(self, folders, every=0.25, pairs=None, ask_every=0.2):
        super().__init__(daemon=True)
        self.every, self.ask_every = every, ask_every
        self.lock = threading.Lock()
        self.context = zmq.Context()
        self.seats = {node: Seat(self.context, node, folder) for node, folder in folders.items()}
        self.pairs = pairs or [(a, b) for a in folders for b in folders if a != b]
        self.number = 0
        self.sent, self.received, self.nacks = 0, 0, collections.Counter()
        self.seen = collections.defaultdict(set)
        self.sent_at, self.last_sent_at = {}, {}
        self.duplicates, self.wrong = [], []
        self.over = False

    def run(self):
        poller = zmq.Poller()
        seat_of = {}
        for seat in self.seats.values():
            poller.register(seat.socket, zmq.POLLIN)
            seat_of[seat.socket] = seat
        next_numbers = time.monotonic()
        while not self.over:
            for socket, _ in poller.poll(20):
                with self.lock:
                    self.drain(seat_of[socket])
            now = time.monotonic()
            with self.lock:
                for seat in self.seats.values():
                    self.keep(seat, now)
                if now >= next_numbers:
                    next_numbers = now + self.every
                    self.send_numbers(now)
        self.context.destroy(0)

    def end(self):
        self.over = True
        self.join(5)

    def keep(self, seat, now):
        if seat.slot == 0:
            if now - seat.said_hello > 0.1:
                seat.said_hello = now
                seat.send("service_hello", seat.node, seat.hello, ident=1)
            return
        if now - seat.said_alive > 1:
            seat.said_alive = now
            seat.send("service_alive", seat.node, wire.pack([]))
        if now - seat.asked > self.ask_every:
            seat.asked = now
            seat.asked_at[seat.send("route_list", seat.node, wire.pack([]), wire.REQUEST)] = now

    def send_numbers(self, now):
        self.number += 1
        for source, target in self.pairs:
            if self.seats[source].slot == 0:
                continue
            if self.seats[source].send(WORD, target, wire.pack([source, target, self.number])):
                self.sent += 1
                self.sent_at[source, target, self.number] = now

    def drain(self, seat):
        for _ in range(200):
            try:
                frame = wire.decode(seat.socket.recv(zmq.NOBLOCK))
            except zmq.Again:
                return
            self.take(seat, frame)

    def take(self, seat, frame):
        if frame.subtype == "service_welcome":
            seat.slot = frame.body()[2]
        elif frame.subtype == "hello_wanted":
            seat.slot, seat.asked_at = 0, {}
        elif frame.subtype == "route_table":
            seat.table_asked = seat.asked_at.pop(frame.reply_to, 0.0)
            seat.asked_at = {i: at for i, at in seat.asked_at.items() if time.monotonic() - at < 5}
            seat.table = {row[0]: dict(zip(ROUTE, row)) for row in frame.body()[1]}
        elif frame.subtype == "nack":
            self.nacks[wire.nack(frame)["code"]] += 1
        elif frame.subtype == WORD:
            self.take_number(seat, frame)

    def take_number(self, seat, frame):
        source, target, number = frame.body()
        self.received += 1
        if target != seat.node or frame.target != seat.node or frame.source != source:
            self.wrong.append(f"{seat.node} got one for {target}, from {frame.source} in the name of {source}")
        if number in self.seen[source, target]:
            self.duplicates.append(f"{source} to {target}: {number}")
        self.seen[source, target].add(number)
        sent = self.sent_at.pop((source, target, number), 0.0)
        self.last_sent_at[source, target] = max(sent, self.last_sent_at.get((source, target), 0.0))

    # ---- for other threads

    def tables(self, since=0.0):
        """node -> its table, of those that were requested after `since`."""
        with self.lock:
            return {n: dict(s.table) for n, s in self.seats.items() if s.table_asked > since}

    def silent_pairs(self, since, pairs):
        """The pairs by which no message that was sent after `since` has come yet."""
        with self.lock:
            return [pair for pair in pairs if self.last_sent_at.get(pair, 0.0) <= since]

    def figures(self):
        with self.lock:
            return {"sent": self.sent, "received": self.received, "nacked": sum(self.nacks.values()),
                    "twice": len(self.duplicates), "wrong": len(self.wrong)}
