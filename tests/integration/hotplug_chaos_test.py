"""A thousand times devices are plugged in and out, with faults at random: the sensor-bus neither crashes nor grows, and
knows in the end what is there. `hotplug_chaos_test.py --seed N` repeats a run; `--rounds N` makes it longer."""
import argparse
import os
import pathlib
import random
import re
import sys
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))

import sensor_node  # noqa: E402
import skips  # noqa: E402

AT_ONCE = 24  # devices
GARBAGE = [b"$GPGGA,x*00\n", b"\xff\xfe\x00\n", b"$GPRMC*\n", b"$" * 900 + b"\n", b"T=\nH=1e999\n", b"\r\n\r\n", b"T=nan;H=inf\n"]
GOOD = b"T=21.5;H=40\n"
STRANGE = ["S1", "S\xff\xfe".encode("latin-1").decode("utf-8", "surrogateescape"), "\u0000".join("ab"), "x" * 300, "../../etc", "A\nB", "\u202e"]
CONTENTS = ["", "21", "2150", "-", "nan\n", "1e999\n", "\x00" * 4096, "9" * 5000, "21500\n", None]


class Chaos:
    def __init__(self, node, seed):
        self.node, self.hall, self.random = node, node.hall, random.Random(seed)
        self.plugged = []
        self.plugs = self.unplugs = self.long_lines = 0

    def plug(self):
        serial = self.random.choice(["S1", "S1", f"N{self.plugs}", self.random.choice(STRANGE)]).replace("\u0000", "")
        kind = self.random.randrange(6)
        if kind == 0:
            device = self.hall.plug_temperature(20)
        elif kind == 1:
            device = self.hall.plug_iio({"in_temp_raw": "100\n", "in_temp_scale": "10\n", "in_pressure_input": "1\n"})
        elif kind == 2:
            device = self.hall.plug_w1(20, f"28-{self.plugs:012x}")
        elif kind == 3:
            device = self.hall.plug_serial(model="GPS Receiver", serial=serial)
        elif kind == 4:
            device = self.hall.plug_keyboard(serial=serial)
        else:
            device = self.hall.plug_serial(serial=serial, maker=self.random.choice(["Example", "\udcff\udcfe", "\u20ac" * 40]))
        device.kind = kind
        self.plugs += 1
        self.plugged.append(device)

    def unplug(self):
        self.plugged.pop(self.random.randrange(len(self.plugged))).unplug()
        self.unplugs += 1

    def disturb(self, device):
        if device.kind == 0:
            device.write("temp1_input", self.random.choice(CONTENTS))
        elif device.kind == 1:
            device.write(self.random.choice(["in_temp_raw", "in_temp_scale", "in_pressure_input"]), self.random.choice(CONTENTS))
        elif device.kind == 2:
            device.write("w1_slave", self.random.choice(["x : crc=57 NO\nx t=1\n", "x : crc=57 YES\n", "", None, "\udcff\n\n"]))
        elif device.kind == 4:
            self.say(device, bytes(self.random.randrange(256) for _ in range(self.random.randrange(96))))
        else:
            self.say(device, self.random.choice([*GARBAGE, GOOD]))
            if self.random.random() < 0.02:
                device.hang_up()

    def say(self, device, data):
        """Writes to the line as a device does, whether or not it is read."""
        if device.master is None:
            return
        try:
            device.say(data, timeout=0)
        except (TimeoutError, BlockingIOError, OSError):
            pass  # its line is full, or gone

    def say_long_line(self):
        """10 MB without a line end, to a listening reader."""
        device = self.hall.plug_serial(serial="LONG")
        self.node.wait("the long line's reader", lambda there: any("LONG" in s["identity"] for s in there.values()))
        for _ in range(160):
            device.say(b"x" * 65536)
        device.say(b"\n" + GOOD)
        self.node.wait("a good line after it", lambda there: any("LONG" in s["identity"] and s["state"] == "ok" for s in there.values()))
        device.unplug()
        self.long_lines += 1

    def step(self):
        full = len(self.plugged) >= AT_ONCE
        if not self.plugged or (not full and self.random.random() < 0.5):
            self.plug()
        else:
            self.unplug()
        for device in self.random.sample(self.plugged, min(2, len(self.plugged))):
            if self.random.random() < 0.5:
                self.disturb(device)
            elif self.random.random() < 0.2:
                device.event(self.random.choice(["add", "change", "bind", "unbind"]))

    def expected(self):
        """The number of sensors of the plugged devices."""
        return sum({0: 1, 1: 2, 2: 1, 3: 5, 4: 1, 5: 2}[device.kind] for device in self.plugged)

    def repair(self, device):
        """Restores a vanished file: without it the sensor ends at udev's next event of the device."""
        files = {0: {"temp1_input": "20000\n"}, 2: {"w1_slave": "x : crc=57 YES\nx t=1\n"},
                 1: {"in_temp_raw": "100\n", "in_temp_scale": "10\n", "in_pressure_input": "1\n"}}.get(device.kind, {})
        for name, content in files.items():
            device.write(name, content)
        if files:
            device.event("change")

    def settle(self):
        for device in self.plugged:
            self.repair(device)
        wanted = self.expected()
        self.node.wait(f"{wanted} sensors", lambda there: len(there) == wanted, 60)

    def unplug_all(self):
        while self.plugged:
            self.unplug()
        self.settle()


def few(node, idle):
    _, threads, descriptors = node.figures()
    return threads <= idle[1] and descriptors <= idle[2]


def run(node, rounds, seed):
    chaos = Chaos(node, seed)
    node.start()
    node.fleet.wait("what is plugged in at the start is found", lambda: node.logged("welcomed"), 60)
    idle = node.figures()
    started = time.monotonic()
    figures = []
    while chaos.plugs + chaos.unplugs < 2 * rounds:
        chaos.step()
        if (chaos.plugs + chaos.unplugs) % (2 * rounds // 5) == 0:
            chaos.settle()
            if chaos.long_lines < 1:
                chaos.say_long_line()
            chaos.unplug_all()
            figures.append(node.figures())
            print(f"after {chaos.plugs} plugged in, {chaos.unplugs} out: {figures[-1][0]} kB, {figures[-1][1]} threads, {figures[-1][2]} descriptors", flush=True)
    chaos.unplug_all()
    # One more, a good one: the faults of the others do not affect it.
    device = node.hall.plug_temperature(20)
    node.wait_state("temperature", "ok")
    device.unplug()
    node.wait("nothing is left", lambda there: not there)
    node.fleet.wait("threads and descriptors are those of the start", lambda: few(node, idle), 60)
    figures.append(node.figures())
    print(f"{chaos.plugs} plugged in, {chaos.unplugs} out in {time.monotonic() - started:.1f} s: {figures[-1]}")
    assert node.bus.child.poll() is None, "the sensor-bus has ended"
    assert figures[-1][0] <= figures[0][0] + 4096 + quarantine_kb(), f"it grows: {figures}"
    unknown = node.table(unknown=True)["unknown"]
    assert unknown == [], f"devices are left: {unknown}"


def quarantine_kb():
    """Freed memory that ASan keeps, which is no growth of the program."""
    words = re.search(r"quarantine_size_mb=(\d+)", os.environ.get("ASAN_OPTIONS", ""))
    return 1024 * int(words[1]) if words else 0


class Case:
    """The case that ends a SensorNode."""

    def __init__(self):
        self.cleanups = []

    def addCleanup(self, function, *arguments):
        self.cleanups.append((function, arguments))

    def end(self):
        for function, arguments in reversed(self.cleanups):
            function(*arguments)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seed", type=int, default=random.randrange(2**32))
    parser.add_argument("--rounds", type=int, default=1000)
    arguments = parser.parse_args()
    missing = sensor_node.skip_reason()
    if missing:
        skips.leave(missing)
    print(f"seed {arguments.seed}", flush=True)
    case = Case()
    try:
        run(sensor_node.SensorNode(case, block=124, udp_port=50924), arguments.rounds, arguments.seed)
    finally:
        case.end()
    return 0


if __name__ == "__main__":
    sys.exit(main())
