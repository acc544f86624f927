"""A client of a Universal Robot's controller, as the maker's documents describe its interfaces: the dashboard server and
the primary and secondary client interfaces."""
import contextlib
import socket
import struct


class Dashboard:
    def __init__(self, address, port):
        self.link = socket.create_connection((address, port), 10)
        self.lines = self.link.makefile("r", newline="\n")
        self.greeting = self.lines.readline().rstrip("\n")

    def ask(self, line):
        self.link.sendall((line + "\n").encode())
        return self.lines.readline().rstrip("\n")

    def close(self):
        self.lines.close()
        self.link.close()


class Primary:
    """Packets of port 30001 or 30002; scripts are written to it."""

    def __init__(self, address, port):
        self.link = socket.create_connection((address, port), 10)
        self.stream = self.link.makefile("rb")

    def send(self, script):
        self.link.sendall(script.encode() if script.endswith("\n") else script.encode() + b"\n")

    def packet(self):
        size, kind = struct.unpack(">iB", self.exactly(5))
        return kind, self.exactly(size - 5)

    def exactly(self, size):
        data = self.stream.read(size)
        if len(data) < size:
            raise EOFError
        return data

    def state(self):
        """The next state: {sub-package type: its payload}"""
        while True:
            kind, body = self.packet()
            if kind != 16:
                continue
            parts = {}
            while body:
                size, part = struct.unpack(">IB", body[:5])
                parts[part], body = body[5:size], body[size:]
            return parts

    def message(self, *kinds):
        """The next message of these kinds: (source, kind, its payload)."""
        while True:
            type_, body = self.packet()
            if type_ == 20 and body[9] in kinds:
                return body[8], body[9], body[10:]

    def until(self, happened):
        """Reads states until one is as wanted."""
        while not happened(parts := self.state()):
            pass
        return parts

    def close(self):
        with contextlib.suppress(OSError):
            self.link.shutdown(socket.SHUT_RDWR)
        self.stream.close()
        self.link.close()


def joints_of(parts):
    """Actual, target and speed of the six joints."""
    rows = [struct.unpack(">3d4fB", parts[1][i * 41:(i + 1) * 41]) for i in range(6)]
    return [row[0] for row in rows], [row[1] for row in rows], [row[2] for row in rows]


def robot_mode_of(parts):
    """(power on, emergency stopped, protective stopped, program running, paused, robot mode)"""
    return struct.unpack(">xx5bB", parts[0][8:16])
