"""The story of scripts/test-hotplug-vm: devices are plugged into a virtual machine and out again, as trb tells it there."""
import json
import pathlib
import shutil
import signal
import statistics
import sys
import tempfile
import time

HERE = pathlib.Path(__file__).resolve().parent
for folder in (HERE, HERE.parent / "integration"):
    sys.path.insert(0, str(folder))

import image  # noqa: E402
from machine import Machine, UsbSerial  # noqa: E402

ROUNDS = 5
AIR = "T=21.5;H=40"
GGA = "$GPGGA,123519,4807.038,N,01131.000,E,1,08,0.9,545.4,M,46.9,M,,*47"
STUB = "$(grep -l SMBus.stub /sys/bus/i2c/devices/*/name | sed 's/name$//')"
STEPS = []


def step(tale):
    """A function that is a step of the story: its first line says what it shows."""
    STEPS.append(tale)
    return tale


class Cleanups:
    """What must be undone, last first."""

    def __init__(self):
        self.list = []

    def addCleanup(self, function, *arguments):
        self.list.append((function, arguments))

    def end(self):
        while self.list:
            function, arguments = self.list.pop()
            function(*arguments)


def check(holds, what):
    if not holds:
        raise AssertionError(what)


def identity(serial, sensor):
    """As the sensor-bus reports it for a device behind QEMU's converter: the maker and the serial number."""
    return f"0403:6001:{serial}/{sensor}"


def check_identity(there, serial="TH1"):
    check(all(each["identity"] == identity(serial, name) for name, each in there.items()), f"its serial number is {serial}: {there}")


class Story:
    def __init__(self, machine):
        self.machine = machine
        self.times = []  # from a plug to a value that trb shows, in s
        self.first = None

    # ---- output of the machine's trb

    def trb(self, words):
        said, code = self.machine.sh(f"trb {words} --node /node")
        return said, code

    def sensors(self):
        """name: its row; None: the node is not up yet."""
        said, code = self.trb("sensor list --json 2>/dev/null")
        return {each["name"]: each for each in json.loads(said)["sensors"]} if code == 0 else None

    def wait(self, what, holds, timeout=30):
        end = time.monotonic() + timeout
        while True:
            there = self.sensors()
            if there is not None and holds(there):
                return there
            if time.monotonic() > end:
                raise TimeoutError(f"{what}: not within {timeout} s; there is {there}")

    def wait_ok(self, *names):
        """Waits until exactly these sensors are there, with values."""
        return self.wait(f"{names} are there and ok", lambda there: {n: s["state"] for n, s in there.items()} == dict.fromkeys(names, "ok"))

    def wait_gone(self):
        self.wait("nothing is left", lambda there: not there)

    def read(self, sensor):
        said, code = self.trb(f"sensor read {sensor} --json")
        check(code == 0, f"trb sensor read {sensor}: {said}")
        return json.loads(said)

    def expect(self, sensor, value, unit):
        """The very next values may have been measured before the device changed."""
        end = time.monotonic() + 20
        while (now := self.read(sensor))["number"] != value or now["unit"] != unit or now["quality"] != "good":
            check(time.monotonic() < end, f"{sensor}: {now} instead of {value} {unit}")

    def sh(self, order):
        said, code = self.machine.sh(order)
        check(code == 0, f"{order}: {said}")
        return said

    def wait_sh(self, what, order, wanted, timeout=30):
        end = time.monotonic() + timeout
        while wanted not in (said := self.machine.sh(order)[0]):
            check(time.monotonic() < end, f"{what}: {said!r}")

    def figures(self):
        """The sensor-bus' process, its threads and its descriptors."""
        return self.sh("p=$(pidof trb-sensor-bus); echo $p; ls /proc/$p/task | wc -l; ls /proc/$p/fd | wc -l").split()

    def thermometer(self, name="air", serial="TH1"):
        return UsbSerial(self.machine, name, serial, AIR)


@step
def the_machine_is_up(story):
    """Linux, udevd, D-Bus and the node are up, and nothing is plugged in"""
    story.machine.wait_ready(120)
    story.wait("no sensor", lambda there: not there, 60)
    story.wait_sh("the service is there", "pidof trb-sensor-bus && echo there", "there")


@step
def a_serial_line(story):
    """usb-serial, a thermometer behind it: recognised by its rule, read over D-Bus"""
    air = story.thermometer()
    there = story.wait_ok("temperature", "humidity")
    story.times.append(time.monotonic() - air.began)
    check_identity(there)
    story.expect("temperature", 21.5, "degC")
    story.expect("humidity", 40, "percent")
    air.text = "T=30.25;H=41"
    story.expect("temperature", 30.25, "degC")
    air.unplug()
    story.wait_gone()
    said, code = story.trb("sensor read temperature")
    check(code != 0 and "temperature" in said, f"no sensor, no value: {code}, {said}")
    story.first = story.figures()  # from here on nothing may grow


@step
def again_and_again(story):
    """the same device out and in, five times: the same names, the same identity, a value each time"""
    for _ in range(ROUNDS):
        air = story.thermometer()
        there = story.wait_ok("temperature", "humidity")
        story.times.append(time.monotonic() - air.began)
        check_identity(there)
        air.unplug()
        story.wait_gone()


@step
def one_serial_number_twice(story):
    """two devices with one serial number: told apart, and why"""
    one, two = story.thermometer(), story.thermometer("air2")
    there = story.wait_ok("temperature", "humidity", "temperature_2", "humidity_2")
    for kind in ("temperature", "humidity"):
        one_of_it, other = there[kind], there[kind + "_2"]
        check(one_of_it["identity"] == identity("TH1", kind) and other["identity"] == identity("TH1", kind) + "#2", f"{there}")
        check(other["detail"] != "", f"it is said why: {other}")
    one.unplug()
    two.unplug()
    story.wait_gone()


@step
def a_receiver_of_gps(story):
    """usb-serial, a receiver of GPS behind it: a position, and an altitude"""
    gps = UsbSerial(story.machine, "gps", "GPS1", GGA)
    story.wait("a position", lambda there: there.get("position", {}).get("state") == "ok" and there["altitude"]["state"] == "ok")
    story.times.append(time.monotonic() - gps.began)
    story.expect("altitude", 545.4, "m")
    place = story.read("position")["text"]
    check(place == "48.1173000,11.5166667", f"48°07.038' N 11°31' E is {place}")
    gps.unplug()
    story.wait_gone()


@step
def a_device_without_a_rule(story):
    """a device that no rule knows: no sensor, but a rule to edit that names it"""
    strange = UsbSerial(story.machine, "strange", "X1", AIR)
    story.wait_sh("it is unknown", "trb sensor list --unknown --json --node /node", "QEMU_USB_SERIAL")
    said = json.loads(story.trb("sensor list --unknown --json")[0])
    found = [each for each in said["unknown"] if "ID_SERIAL_SHORT=X1" in each["properties"]]
    check(len(found) == 1, f"one of it: {said}")
    check(json.loads(found[0]["rule"])["match"]["properties"]["ID_SERIAL_SHORT"] == "X1", found[0]["rule"])
    check(story.sensors() == {}, "it is no sensor")
    strange.unplug()
    end = time.monotonic() + 20
    while "ID_SERIAL_SHORT=X1" in story.trb("sensor list --unknown --json")[0]:
        check(time.monotonic() < end, "it is unplugged, and forgotten")


@step
def a_reader_of_tags(story):
    """usb-kbd, a reader of tags: grabbed, so that its tag is typed into no terminal, as the PS/2 keyboard's keys are"""
    machine = story.machine
    machine.press(["1", "7", "ret"])
    story.wait_sh("the PS/2 keyboard types into the terminal", "cat /tmp/typed", "17")
    machine.plug("usb-kbd", "tags", serial="RFID1")
    there = story.wait("a tag reader", lambda there: "tag" in there)
    check(there["tag"]["identity"] == "0627:0001:RFID1", f"its maker, model and serial number: {there}")
    story.sh("trb sensor read tag --timeout 20 --json --node /node >/tmp/tag 2>&1 &")
    end = time.monotonic() + 30
    # Shown to the reader again until it is heard; not faster than its keys are, for QEMU's keyboard keeps 16 events.
    said = ""
    while not said:
        machine.press(["4", "2", "a", "ret"])
        said = story.sh("i=0; while [ ! -s /tmp/tag ] && [ $i -lt 10 ]; do sleep 0.2; i=$((i+1)); done; cat /tmp/tag")
        check(time.monotonic() < end, "no tag is read")
    check(json.loads(said)["text"] == "42a", f"the tag: {said}")
    machine.unplug("tags")
    story.wait_gone()
    machine.press(["1", "8", "ret"])
    story.wait_sh("the PS/2 keyboard types again", "cat /tmp/typed", "18")
    typed = story.sh("cat /tmp/typed").split()
    check(set(typed) == {"17", "18"}, f"nobody else hears the tag: {typed}")


@step
def a_chip_on_i2c(story):
    """lm75 on I2C (hwmon): its register is what trb reads, in degC"""
    bus = story.sh(f"modprobe i2c-stub chip_addr=0x48 && basename {STUB}").removeprefix("i2c-")
    story.sh(f"i2cset -y {bus} 0x48 0 0x8015 w")  # 21.5 °C, its upper byte last
    began = time.monotonic()
    story.sh(f"echo lm75 0x48 > {STUB}/new_device")
    story.wait_ok("temperature")
    story.times.append(time.monotonic() - began)
    story.expect("temperature", 21.5, "degC")
    story.sh(f"i2cset -f -y {bus} 0x48 0 0x80f6 w")
    story.expect("temperature", -9.5, "degC")
    story.sh(f"echo 0x48 > {STUB}/delete_device")
    story.wait_gone()
    story.sh("rmmod i2c_stub")


@step
def a_camera(story):
    """vivid, a camera that knows no JPEG: recognised, and its picture is one"""
    story.sh("modprobe vivid n_devs=1 node_types=0x1")
    there = story.wait("a camera", lambda there: "camera" in there)
    check(there["camera"]["kind"] == "image", f"{there}")
    said, code = story.trb("sensor read camera --save /tmp/picture.jpg")
    check(code == 0, f"no picture: {said}")
    ends = story.sh("for end in head tail; do $end -c 2 /tmp/picture.jpg | hexdump -v -e '1/1 \"%02x\"'; done")
    check(ends == "ffd8ffd9", f"a whole JPEG begins with ffd8 and ends with ffd9: {ends}")
    size = int(story.sh("wc -c </tmp/picture.jpg"))
    check(1000 < size <= 1_000_000, f"a picture of {size} bytes")
    story.sh("rmmod vivid")
    story.wait_gone()


@step
def all_at_once(story):
    """three devices in and out together, three times"""
    for _ in range(3):
        devices = [story.thermometer(), UsbSerial(story.machine, "gps", "GPS1", GGA)]
        story.machine.plug("usb-kbd", "tags", serial="RFID1")
        story.wait("all are there", lambda there: {"temperature", "humidity", "position", "tag"} <= set(there)
                   and all(there[name]["state"] == "ok" for name in ("temperature", "humidity", "position")))
        story.machine.unplug("tags")
        for device in devices:
            device.unplug()
        story.wait_gone()


@step
def nothing_is_left(story):
    """the sensor-bus is the same process as at the start, with no thread and no descriptor more"""
    end = time.monotonic() + 20
    while (now := story.figures()) != story.first:
        check(time.monotonic() < end, f"process, threads, descriptors: {story.first}, now {now}")


def tell(machine, folder):
    """What helps to find the fault."""
    try:
        print(machine.sh("tail -n 15 /node/log/sensor-bus.log", 10)[0])
    except (OSError, TimeoutError):
        pass
    log = folder / "console.log"
    print(log.read_text(errors="replace")[-3000:] if log.exists() else "the machine said nothing")


def play(machine, folder):
    story = Story(machine)
    for tale in STEPS:
        began = time.monotonic()
        try:
            tale(story)
        except (AssertionError, OSError, RuntimeError, ValueError) as fault:
            print(f"FAILED {time.monotonic() - began:6.2f} s  {tale.__doc__}\n  {fault}", flush=True)
            tell(machine, folder)
            return 1
        print(f"ok     {time.monotonic() - began:6.2f} s  {tale.__doc__}", flush=True)
    print(f"from a plug to a value that trb tells, without acceleration: median {statistics.median(story.times):.2f} s, "
          f"at most {max(story.times):.2f} s ({len(story.times)} plugs)")
    return 0


def main():
    keep = "--keep" in sys.argv
    started = time.monotonic()
    for each in (signal.SIGTERM, signal.SIGHUP):
        signal.signal(each, lambda *_: sys.exit(1))  # so that all is cleaned up
    cleanups = Cleanups()
    folder = pathlib.Path(tempfile.mkdtemp(prefix="trb-vm-"))
    cleanups.addCleanup(*(print, f"left behind: {folder}") if keep else (shutil.rmtree, folder))
    try:
        vmlinuz, version = image.kernel()
        initramfs = image.make(folder, version, cleanups)
        print(f"Linux {version}, made in {time.monotonic() - started:.1f} s", flush=True)
        machine = Machine(folder, vmlinuz, initramfs)
        cleanups.addCleanup(machine.stop)
        code = play(machine, folder)
    except (OSError, RuntimeError) as fault:
        print(f"scripts/test-hotplug-vm: {fault}", file=sys.stderr)
        return 1
    finally:
        cleanups.end()
    print(f"{'all ' if code == 0 else 'NOT ALL '}{len(STEPS)} steps are good, {time.monotonic() - started:.1f} s")
    return code


if __name__ == "__main__":
    sys.exit(main())
