"""A client of a Universal Robot's controller, as the maker's documents describe its interfaces: the dashboard server and
the primary and secondary client interfaces."""
import contextlib
import socket
import struct


class Dashboard:
    def __init__(self, address, port):
        self.link = socket.create_connection((address, port), 60)
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
        self.link = socket.create_connection((address, port), 60)
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


class Rtde:
    """The real-time data exchange of port 30004, versions 1 and 2."""
    FORMS = {"VECTOR6D": "6d", "VECTOR3D": "3d", "VECTOR6INT32": "6i", "VECTOR6UINT32": "6I", "DOUBLE": "d", "UINT64": "Q",
             "UINT32": "I", "INT32": "i", "BOOL": "?", "UINT8": "B"}

    def __init__(self, address, port):
        self.link = socket.create_connection((address, port), 60)
        self.stream = self.link.makefile("rb")
        self.version, self.outputs, self.inputs = 1, [], {}

    def send(self, kind, body=b""):
        self.link.sendall(struct.pack(">HB", 3 + len(body), ord(kind)) + body)

    def package(self):
        size, kind = struct.unpack(">HB", self.stream.read(3))
        return chr(kind), self.stream.read(size - 3)

    def answer(self, kind):
        while (package := self.package())[0] != kind:
            pass
        return package[1]

    def ask(self, kind, body=b""):
        self.send(kind, body)
        return self.answer(kind)

    def speak(self, version):
        accepted = self.ask("V", struct.pack(">H", version)) == b"\1"
        if accepted:
            self.version = version
        return accepted

    def controller(self):
        return struct.unpack(">4I", self.ask("v"))

    def set_outputs(self, names, rate=125.0):
        """(id or None, types)"""
        body = ",".join(names).encode()
        said = self.ask("O", (struct.pack(">d", rate) if self.version == 2 else b"") + body)
        number = said[0] if self.version == 2 else None
        types = said[1 if self.version == 2 else 0:].decode().split(",")
        self.outputs = list(zip(names, types))
        return number, types

    def set_inputs(self, names):
        said = self.ask("I", ",".join(names).encode())
        types = said[1:].decode().split(",")
        self.inputs[said[0]] = types
        return said[0], types

    def write(self, recipe, *values):
        form = ">B" + "".join(self.FORMS[type_] for type_ in self.inputs[recipe])
        self.send("U", struct.pack(form, recipe, *values))

    def start(self):
        return self.ask("S") == b"\1"

    def pause(self):
        return self.ask("P") == b"\1"

    def data(self):
        """The next data package: {name: value or tuple}"""
        body = self.answer("U")
        if self.version == 2:
            body = body[1:]
        out = {}
        for name, type_ in self.outputs:
            form = ">" + self.FORMS[type_]
            size = struct.calcsize(form)
            values, body = struct.unpack(form, body[:size]), body[size:]
            out[name] = values if len(values) > 1 else values[0]
        if body:
            raise ValueError(f"{len(body)} bytes more than the recipe has")
        return out

    def until(self, happened):
        while not happened(data := self.data()):
            pass
        return data

    def close(self):
        self.stream.close()
        self.link.close()
