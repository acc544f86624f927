"""An AR.Drone 2's two sides in Python, written from the protocol alone: a client, and a drone that a test controls."""
import select
import socket
import struct
import threading
import time

MAGIC = 0x55667788
FLYING, COMMAND, BOOTSTRAP, COM_LOST, BATTERY_LOW = 1 << 0, 1 << 6, 1 << 11, 1 << 13, 1 << 15
CAMERA, DEMO, PIC = 1 << 7, 1 << 10, 1 << 23
CUTOUT, WATCHDOG, EMERGENCY = 1 << 22, 1 << 30, 1 << 31
LANDED, FLIES, HOVERING, TAKING_OFF, LANDING = 2, 3, 4, 6, 8
GROUND, AIR, TOGGLE = 290717696, 290718208, 290717952


def bits_of(number):
    """A float as the int32 of the same bits."""
    return struct.unpack("<i", struct.pack("<f", number))[0]


def pack_navdata(sequence, state, control=LANDED, battery=90, altitude_mm=0, speeds=(0, 0, 0), demo=True):
    packet = struct.pack("<4I", MAGIC, state, sequence, 0)
    if demo:
        packet += struct.pack("<HHII3fi3f", 0, 148, control << 16, battery, 0, 0, 0, altitude_mm, *speeds) + bytes(108)
    return packet + struct.pack("<HHI", 0xFFFF, 8, sum(packet))


def read_navdata(packet):
    """Header and flight data as a dictionary; an assertion fails for a packet that is wrong."""
    magic, state, sequence, vision = struct.unpack_from("<4I", packet)
    assert magic == MAGIC, hex(magic)
    out, at = {"state": state, "sequence": sequence, "vision": vision, "options": []}, 16
    while True:
        tag, size = struct.unpack_from("<HH", packet, at)
        if tag == 0xFFFF:
            assert size == 8 and at + 8 == len(packet), "the checksum is not at the end"
            assert struct.unpack_from("<I", packet, at + 4)[0] == sum(packet[:at]), "wrong checksum"
            return out
        assert size >= 4, size
        out["options"].append(tag)
        if tag == 0:
            assert size == 148, size
            control, battery, theta, phi, psi, altitude, vx, vy, vz = struct.unpack_from("<II3fi3f", packet, at + 4)
            out.update(control=control >> 16, battery=battery, theta=theta, phi=phi, psi=psi, altitude=altitude,
                       vx=vx, vy=vy, vz=vz)
        at += size


class Client:
    """Flies a drone: commands with rising numbers, the state again every 30 ms while it waits."""

    def __init__(self, host, at_port, navdata_port):
        self.at = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.at.connect((host, at_port))
        self.navdata = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.navdata.connect((host, navdata_port))
        self.sequence = 0
        self.state = []
        self.last = None

    def close(self):
        self.at.close()
        self.navdata.close()

    def wake(self):
        self.navdata.send(b"\1\0\0\0")

    def send(self, *calls):
        """One datagram of commands such as "REF,290718208"."""
        text = ""
        for call in calls:
            self.sequence += 1
            name, _, arguments = call.partition(",")
            text += f"AT*{name}={self.sequence}" + ("," + arguments if arguments else "") + "\r"
        self.at.send(text.encode())

    def hold(self, reference, motion="0,0,0,0,0"):
        self.state = [f"REF,{reference}", f"PCMD,{motion}"]

    def wait(self, what, condition, timeout=60):
        """Waits for a matching navdata; the state is sent meanwhile."""
        end, next_state = time.monotonic() + timeout, 0
        while time.monotonic() < end:
            if self.state and time.monotonic() >= next_state:
                # As the maker's guide asks: a drone whose watchdog was set obeys after COMWDG.
                bitten = self.last is not None and self.last["state"] & WATCHDOG
                self.send(*(["COMWDG"] if bitten else []), *self.state)
                next_state = time.monotonic() + 0.03
            if not select.select([self.navdata], [], [], 0.01)[0]:
                continue
            heard = read_navdata(self.navdata.recv(4096))
            assert self.last is None or heard["sequence"] > self.last["sequence"], "the numbers do not rise"
            self.last = heard
            if condition(heard):
                return heard
        raise TimeoutError(f"{what}: not within {timeout} s; last {self.last}")


class Drone(threading.Thread):
    """Sends the test's values 15 times a second, and keeps what it receives."""

    def __init__(self, host, answers=True):
        super().__init__(daemon=True)
        self.at = self.bind(host, 5556)
        self.navdata = self.bind(host, 5554)
        self.lock = threading.Lock()
        self.heard = []  # (time, name, sequence, arguments)
        self.datagrams = []  # (time, bytes)
        self.woken = 0
        self.client = None
        self.sequence = 0
        self.sky = {"state": 0}  # arguments of pack_navdata
        self.answers = answers
        self.demo = False
        self.command_bit = False
        self.ended = False

    @staticmethod
    def bind(host, port):
        out = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        out.bind((host, port))
        return out

    def run(self):
        next_navdata = 0
        while not self.ended:
            ready, _, _ = select.select([self.at, self.navdata], [], [], 0.01)
            for each in ready:
                data, sender = each.recvfrom(4096)
                with self.lock:
                    self.take(data) if each is self.at else self.wake(sender)
            if self.client and self.answers and time.monotonic() >= next_navdata:
                next_navdata = time.monotonic() + 1 / 15
                with self.lock:
                    self.tell()
        self.at.close()
        self.navdata.close()

    def wake(self, sender):
        self.client = sender
        self.woken += 1

    def take(self, data):
        now = time.monotonic()
        self.datagrams.append((now, data))
        for line in data.decode("ascii").split("\r")[:-1]:
            name, _, rest = line.removeprefix("AT*").partition("=")
            sequence, _, arguments = rest.partition(",")
            self.heard.append((now, name, int(sequence), arguments))
            if name == "CONFIG":
                self.command_bit = True
                self.demo = self.demo or "navdata_demo" in arguments
            if name == "CTRL":
                self.command_bit = False

    def packet(self):
        self.sequence += 1
        sky = dict(self.sky)
        sky["state"] |= (0 if self.demo else BOOTSTRAP) | (COMMAND if self.command_bit else 0)
        return pack_navdata(self.sequence, demo=self.demo, **sky)

    def tell(self, packet=None):
        self.navdata.sendto(packet or self.packet(), self.client)

    def is_in(self, **sky):
        with self.lock:
            self.sky = sky

    def mark(self):
        with self.lock:
            return len(self.heard)

    def since(self, mark, *names):
        with self.lock:
            return [call for call in self.heard[mark:] if not names or call[1] in names]

    def close(self):
        self.ended = True
        self.join()
