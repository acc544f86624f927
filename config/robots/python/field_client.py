"""A robot's end of the field channel (proto/FIELD_CHANNEL.md) in Python, standard library only: framing "newline",
encoding "text". Copy it to the robot. `main` at the end is an example of a robot's program; try it, and yours, with

    trb robot conform config/robots/field-example.json --listen 127.0.0.1:40000 --run wave
    python3 field_client.py 127.0.0.1
"""
import argparse
import collections
import re
import select
import socket
import time

# type: "command", "request" or "information"; peer: who has sent it; data: a text
Message = collections.namedtuple("Message", "type subtype peer data")

OWN_NODE = ""  # the target of reports
UNESCAPED = {b"\\": b"\\", b"n": b"\n", b"r": b"\r"}


class Channel:
    """The connection to the robot's node. A broken one is dialled again, by itself."""

    def __init__(self, host, port=40000, chunk_bytes=0, on_stop=lambda: None, on_release=lambda: None):
        """`on_stop` stops every motion; it is called from receive() before the stop is confirmed. `chunk_bytes` is that of
        the description: the longest line that is sent."""
        self.address, self.chunk_bytes = (host, port), chunk_bytes
        self.on_stop, self.on_release = on_stop, on_release
        self.stopped = False  # from a stop to its release no command may be carried out; it outlasts a connection
        self.socket = None
        self._forget()

    # ---- to be called by the robot's program

    def receive(self, timeout):
        """The next message; None if none came in that many seconds. Call it often, also while the robot moves: it is how
        a stop gets through."""
        end = time.monotonic() + timeout
        while True:
            try:
                field = self._next_field(end)
                if field is None:
                    return None
                message = self._take(field)
            except OSError:
                self._hang_up()
                continue
            if message:
                return message

    def send(self, type_, subtype, target, data=""):
        """Sends a message. What is under way when the connection breaks is lost: a node that needs it asks again."""
        raw = data.encode()
        head = [type_.encode(), subtype.encode(), target.encode(), str(len(raw)).encode()]  # the size counts bytes
        try:
            self._write(b"".join(escape(field) + b"\n" for field in head + self._chunks(raw)))
        except OSError:
            self._hang_up()

    def answer(self, request, data):
        self.send("information", request.subtype, request.peer, data)

    def done(self, skill, result=""):
        self.send("information", "done", OWN_NODE, f"{skill} {result}".strip())

    def failed(self, skill, reason):
        self.send("information", "failed", OWN_NODE, f"{skill} {reason}")

    def fault(self, capability, severity, text):
        """`severity` is WARNING, URGENT, CRITICAL or FATAL."""
        self.send("information", "fault", OWN_NODE, f"{capability} {severity} {text}")

    def fault_over(self, capability):
        """It works again; a CRITICAL or FATAL fault keeps the capability out of use until then."""
        self.send("information", "fault", OWN_NODE, f"{capability} OVER")

    # ---- within

    def _forget(self):
        self.input, self.searched = bytearray(), 0
        self._begin_message()

    def _begin_message(self):
        self.head, self.data = [], bytearray()

    def _hang_up(self):
        if self.socket:
            self.socket.close()
        self.socket = None
        self._forget()  # the new connection begins with a new message

    def _next_field(self, end):
        while True:
            at = self.input.find(b"\n", self.searched)
            if at >= 0:
                line = bytes(self.input[:at]).removesuffix(b"\r")
                del self.input[:at + 1]
                self.searched = 0
                return re.sub(rb"\\([\\nr])", lambda found: UNESCAPED[found[1]], line)
            self.searched = len(self.input)
            if not self.socket and not self._dial(end):
                return None
            if not select.select([self.socket], [], [], max(0, end - time.monotonic()))[0]:
                return None
            received = self.socket.recv(65536)
            if not received:
                raise ConnectionError("the node has closed the connection")
            self.input += received

    def _dial(self, end):
        while not self.socket:
            try:
                self.socket = socket.create_connection(self.address, timeout=2)
                self.socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            except OSError:
                left = end - time.monotonic()
                time.sleep(max(0, min(0.2, left)))  # a refused dial costs nothing: without a pause it would be repeated at once
                if left <= 0.2:
                    return False
        return True

    def _take(self, field):
        if field in (b"!stop", b"!release"):
            return self._take_order(field)
        if len(self.head) < 4:
            self.head.append(field.decode(errors="replace"))
        else:
            self.data += field
        self._write(b"ok\n")
        if len(self.head) < 4 or not self._whole(field):
            return None
        (type_, subtype, peer, _), data = self.head, self.data.decode(errors="replace")
        self._begin_message()
        return Message(type_, subtype, peer, data)

    def _whole(self, last):
        """Empty data is one empty chunk: the size alone ends no message."""
        size = int(self.head[3])
        return len(self.data) >= size and (size > 0 or last == b"")

    def _take_order(self, order):
        self._begin_message()  # the part of a message that is held is thrown away
        if order == b"!stop":
            self.stopped = True
            self.on_stop()
        else:
            self.stopped = False
            self.on_release()
        self._write(order + (b"ped\n" if order == b"!stop" else b"d\n"))

    def _chunks(self, raw):
        # Half of the limit: each byte may become two. A robot need not fill its chunks.
        most = self.chunk_bytes // 2 or len(raw) or 1
        return [raw[at:at + most] for at in range(0, len(raw), most)] or [b""]

    def _write(self, data):
        if not self.socket:
            raise ConnectionError("not connected")
        self.socket.sendall(data)


def escape(field):
    return field.replace(b"\\", b"\\\\").replace(b"\n", b"\\n").replace(b"\r", b"\\r")


class ExampleRobot:
    """It can wave, and says where it is. Put your robot's own calls where it says so."""

    def __init__(self, host, port=40000, chunk_bytes=0):
        self.channel = Channel(host, port, chunk_bytes, on_stop=self.stop)
        self.skill, self.ends = None, 0

    def run(self):
        while True:
            message = self.channel.receive(timeout=0.05)
            if message and message.type == "command":
                self.begin(message)
            elif message and message.type == "request":
                self.channel.answer(message, self.told(message))
            if self.skill and time.monotonic() >= self.ends:  # yours: has the motion ended?
                skill, self.skill = self.skill, None
                self.channel.done(skill)

    def begin(self, command):
        if command.subtype != "wave":
            return self.channel.failed(command.subtype, "unknown")
        if self.channel.stopped or self.skill:
            return self.channel.failed(command.subtype, "stopped" if self.channel.stopped else "busy")
        self.skill, self.ends = command.subtype, time.monotonic() + 0.5  # yours: begin the motion, and do not wait for it

    def told(self, request):
        if request.subtype == "position":
            return "0 0 0"  # yours
        if request.subtype == "echo":
            return request.data  # for trb robot conform
        return "unknown"

    def stop(self):
        self.skill = None  # yours: stop every motion, now


def main():
    parser = argparse.ArgumentParser(description="A robot that can wave, on the field channel of its node.",
                                     epilog="Example: field_client.py 192.168.1.10")
    parser.add_argument("node", help="the address of the node's computer in the robot's network")
    parser.add_argument("port", type=int, nargs="?", default=40000, help="TCP_PORT of network.json (40000)")
    parser.add_argument("chunk_bytes", type=int, nargs="?", default=0, help="chunk_bytes of the robot's description (0: no limit)")
    given = parser.parse_args()
    ExampleRobot(given.node, given.port, given.chunk_bytes).run()


if __name__ == "__main__":
    main()
