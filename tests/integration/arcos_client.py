"""A client of a Pioneer, written from the maker's description of ARCOS: it shares no code with the tested programs."""
import socket
import struct
import time


def checksum(data):
    total = 0
    for i in range(0, len(data) - 1, 2):
        total = (total + (data[i] << 8) + data[i + 1]) & 0xFFFF
    return total ^ data[-1] if len(data) % 2 else total


def packet(data):
    return b"\xfa\xfb" + bytes([len(data) + 2]) + data + struct.pack(">H", checksum(data))


def command(number, argument=None):
    """A number's sign is the argument's type; a text has its length before it."""
    if argument is None:
        return packet(bytes([number]))
    if isinstance(argument, str):
        return packet(bytes([number, 0x2B, len(argument)]) + argument.encode())
    return packet(bytes([number, 0x1B if argument < 0 else 0x3B]) + struct.pack("<H", abs(argument)))


def counter(word):
    """A counter of 15 bits: 32767 is a millimetre behind the origin."""
    return (word & 0x7FFF) - (0x8000 if word & 0x4000 else 0)


class Sip:
    """A standard server information packet."""

    def __init__(self, data):
        self.moving = data[0] == 0x33
        (x, y, heading, self.left, self.right, battery, self.stall, _, self.flags, _, sonar) = struct.unpack(
            "<HHhhhBHHHBB", data[1:20])
        self.words = (x, y)
        self.x, self.y = counter(x), counter(y)
        self.heading = heading * 360 / 4096
        self.volts = battery / 10
        self.sonar = [struct.unpack("<BH", data[20 + 3 * i:23 + 3 * i]) for i in range(sonar)]
        tail = data[20 + 3 * sonar:]
        self.volts_again = struct.unpack("<h", tail[5:7])[0] / 10
        self.motors = bool(self.flags & 1)
        self.stop_button = bool(self.flags & 32)


class Client:
    def __init__(self, address, port):
        self.socket = socket.create_connection((address, port), timeout=60)
        self.buffer = b""

    def close(self):
        self.socket.close()

    def send(self, number, argument=None):
        self.socket.sendall(command(number, argument))

    def receive(self):
        """The contents of the next packet; its checksum must be right."""
        while True:
            if len(self.buffer) >= 3 and len(self.buffer) >= 3 + self.buffer[2]:
                size = 3 + self.buffer[2]
                whole, self.buffer = self.buffer[:size], self.buffer[size:]
                assert whole[:2] == b"\xfa\xfb", whole
                assert checksum(whole[3:-2]) == struct.unpack(">H", whole[-2:])[0], whole.hex()
                return whole[3:-2]
            more = self.socket.recv(4096)
            if not more:
                raise ConnectionError("closed by the robot")
            self.buffer += more

    def connect(self):
        """Returns the robot's name, class and subclass."""
        for sync in (0, 1):
            self.send(sync)
            assert self.receive() == bytes([sync])
        self.send(2)
        answer = self.receive()
        assert answer[0] == 2
        self.send(1, 1)
        return answer[1:].split(b"\0")[:3]

    def sip(self):
        while True:
            data = self.receive()
            if data[0] in (0x32, 0x33):
                return Sip(data)

    def fresh_sip(self):
        """The next one that has not waited to be read."""
        while True:
            began = time.monotonic()
            sip = self.sip()
            if time.monotonic() - began > 0.05:
                return sip

    def wait(self, what, condition, timeout=60, awake=True):
        """The first packet for which the condition is true."""
        end = time.monotonic() + timeout
        while True:
            sip = self.sip()
            if condition(sip):
                return sip
            if time.monotonic() > end:
                raise TimeoutError(f"{what}: not within {timeout} s; last: {vars(sip)}")
            if awake:
                self.send(0)
