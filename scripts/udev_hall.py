#!/usr/bin/env python3
"""A hall into which devices are plugged that are not there: the real systemd-udevd in a namespace, where a folder stands for
/sys and kernel events are told by hand. Everything else (udev's rules, hardware database, libudev) is Debian's.

    with Hall(folder) as hall:
        sensor = hall.plug_temperature(21.5)
        process = trb_fleet.Process(hall.inside([PROGRAMS / "trb-sensor-bus", node_dir]), log)   # in the hall
        sensor.set(25)
        sensor.unplug()

As root, or as a user whom the kernel lets make user namespaces. Needs Debian's udev and util-linux. Nothing is started or
changed outside of the namespace, and it ends with the process that made it.
"""
import ctypes
import json
import os
import pathlib
import select
import shutil
import signal
import socket
import struct
import subprocess
import sys
import time

from udev_devices import Plugged, Serial

UDEVD = "/lib/systemd/systemd-udevd"
# Its /sys is no sysfs.
ENVIRONMENT = {"SYSTEMD_DEVICE_VERIFY_SYSFS": "0"}
NODES = ["null", "zero", "full", "random", "urandom", "tty"]
USB = "/devices/pci0000:00/0000:00:01.2/usb1"
BOARD = "/devices/platform/board"
START_S = 60  # a deadline, not a measurement: for a starved machine


def end_with_parent():
    ctypes.CDLL(None).prctl(1, signal.SIGTERM)


def why_not():
    """What is missing for a hall; empty: nothing."""
    for program, package in ((UDEVD, "udev"), ("unshare", "util-linux"), ("nsenter", "util-linux")):
        if not shutil.which(program):
            return f"there is no {program} (Debian: {package})"
    words = namespaces()
    done = subprocess.run(["unshare", *words, "mount", "-t", "tmpfs", "none", "/sys"], capture_output=True, text=True)
    if done.returncode != 0:
        return f"unshare {' '.join(words)}: {done.stderr.strip()} (be root, or allow user namespaces)"
    return ""


def namespaces():
    return ["-m", "-n"] if os.geteuid() == 0 else ["-U", "-r", "-m", "-n"]


class Hall:
    """Use it with `with`, or call close()."""

    def __init__(self, folder):
        missing = why_not()
        if missing:
            raise RuntimeError(f"no hall for devices: {missing}")
        self.count = 0
        self.log_path = pathlib.Path(folder) / "udevd.log"
        with open(self.log_path, "ab") as log:
            self.child = subprocess.Popen(
                ["unshare", *namespaces(), sys.executable, __file__, "--inside"], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                stderr=log, text=True, preexec_fn=end_with_parent, env={**os.environ, **ENVIRONMENT})
        self.answer()

    def __enter__(self):
        return self

    def __exit__(self, *ignored):
        self.close()

    def close(self):
        if self.child.poll() is None:
            self.child.stdin.close()
            try:
                self.child.wait(5)
            except subprocess.TimeoutExpired:
                self.child.kill()
                self.child.wait()
        self.child.stdout.close()

    def inside(self, command):
        """The command, to be run in the hall."""
        enter = ["nsenter", "-t", str(self.child.pid), "-m", "-n", f"--wd={os.getcwd()}"]
        if os.geteuid() != 0:
            enter += ["-U", "--preserve-credentials"]
        return [*enter, "env", *(f"{k}={v}" for k, v in ENVIRONMENT.items()), *map(str, command)]

    def ask(self, **command):
        self.child.stdin.write(json.dumps(command) + "\n")
        self.child.stdin.flush()
        return self.answer()

    def answer(self):
        line = self.child.stdout.readline()
        answer = json.loads(line) if line else {"error": self.log_path.read_text().strip()[-2000:] or "it has ended"}
        if "error" in answer:
            raise RuntimeError(f"the hall: {answer['error']}")
        return answer

    def stop_udevd(self):
        """No udevd, as in a container or early at boot."""
        self.ask(do="stop_udevd")

    def start_udevd(self):
        """If it does not run."""
        self.ask(do="start_udevd")

    # ---- what is plugged in

    def number(self):
        self.count += 1
        return self.count

    def plug_device(self, subsystem, name, files, properties=None, parent=BOARD, is_bus=False):
        """A device that is its files alone, as of iio, hwmon and w1. `properties`: what the kernel says of it."""
        path = f"{parent}/{name}"
        folder = {"path": path, "subsystem": subsystem, "is_bus": is_bus, "files": files, "properties": properties or {}}
        device = Plugged(self, path, [path])
        device.properties = self.ask(do="plug", folders=[folder], node=None)["properties"]
        return device

    def plug_temperature(self, value, name=None):
        """A thermometer of the kernel's hwmon, in degC."""
        device = self.plug_device("hwmon", name or f"hwmon{self.number()}", {"name": "lm75\n", "temp1_input": f"{round(value * 1000)}\n"})
        device.attribute, device.factor = "temp1_input", 1000
        return device

    def plug_iio(self, files, name="hts221"):
        number = self.number()
        return self.plug_device("iio", f"iio:device{number}", {"name": name + "\n", **files}, {"DEVTYPE": "iio_device"}, is_bus=True)

    def plug_w1(self, value, serial):
        files = {"name": serial + "\n", "w1_slave": f"72 01 : crc=57 YES\n72 01 t={round(value * 1000)}\n"}
        return self.plug_device("w1", serial, files, is_bus=True)

    def usb(self, number, vendor, product, serial, maker, model):
        """A device on USB and its interface, as folders."""
        path = f"{USB}/1-{number}"
        files = {"idVendor": vendor, "idProduct": product, "manufacturer": maker, "product": model, "bDeviceClass": "00"}
        if serial is not None:
            files["serial"] = serial
        device = {"path": path, "subsystem": "usb", "is_bus": True, "files": {k: f"{v}\n" for k, v in files.items()},
                  "properties": {"DEVTYPE": "usb_device", "BUSNUM": "001", "DEVNUM": f"{number % 127:03}", "PRODUCT": f"{vendor}/{product}/100"}}
        interface = {"path": f"{path}/1-{number}:1.0", "subsystem": "usb", "is_bus": True,
                     "files": {"bInterfaceNumber": "00\n", "bInterfaceClass": "ff\n", "bInterfaceSubClass": "00\n", "bInterfaceProtocol": "00\n"},
                     "properties": {"DEVTYPE": "usb_interface", "INTERFACE": "255/0/0"}}
        return [device, interface]

    def plug_serial(self, vendor="1209", product="0001", serial="S1", maker="Example", model="Thermometer"):
        """A device on USB with a serial line."""
        number = self.number()
        folders = self.usb(number, vendor, product, serial, maker, model)
        name = f"ttyUSB{number}"
        path = f"{folders[-1]['path']}/{name}/tty/{name}"
        folders.append({"path": path, "subsystem": "tty", "is_bus": False, "files": {}, "properties": {"DEVNAME": name}})
        return self.plug_node(folders, name)

    def plug_keyboard(self, vendor="08ff", product="0009", serial="R1", maker="Example", model="RFID Reader"):
        """A reader of tags on USB that types."""
        number = self.number()
        folders = self.usb(number, vendor, product, serial, maker, model)
        path = f"{folders[-1]['path']}/input/input{number}"
        files = {"name": f"{maker} {model}\n", "id/bustype": "0003\n", "id/vendor": f"{vendor}\n", "id/product": f"{product}\n",
                 "id/version": "0110\n", "capabilities/ev": "120013\n", "capabilities/key": "10000 7 ff800000 7ff febeffdf f3cfffff ffffffff fffffffe\n",
                 "capabilities/abs": "0\n", "capabilities/rel": "0\n", "properties": "0\n"}
        folders.append({"path": path, "subsystem": "input", "is_bus": False, "files": files, "properties": {"PRODUCT": f"3/{vendor}/{product}/110"}})
        name = f"input/event{number}"
        folders.append({"path": f"{path}/event{number}", "subsystem": "input", "is_bus": False, "files": {}, "properties": {"DEVNAME": name}})
        return self.plug_node(folders, name)

    def plug_node(self, folders, name):
        device = Serial(self, folders[-1]["path"], [folder["path"] for folder in folders], name)
        pts = os.fstat(device.slave).st_rdev
        folders[-1]["properties"].update(MAJOR=str(os.major(pts)), MINOR=str(os.minor(pts)))
        device.properties = self.ask(do="plug", folders=folders, node=[name, os.ttyname(device.slave)])["properties"]
        return device


class Inside:
    """The hall's own side: the namespace's /sys, /dev and /run, and its udevd."""

    def __init__(self):
        self.sequence = 0
        self.links = {}  # a device's path: the link to it among those of its subsystem
        self.socket = socket.socket(socket.AF_NETLINK, socket.SOCK_RAW | socket.SOCK_CLOEXEC, 15)  # NETLINK_KOBJECT_UEVENT
        self.make_places()
        self.udevd = None
        self.start_udevd()

    def start_udevd(self):
        if self.udevd:
            return
        self.udevd = subprocess.Popen([UDEVD], stdin=subprocess.DEVNULL, stdout=sys.stderr,
                                      preexec_fn=end_with_parent)
        end = time.monotonic() + START_S
        while not os.path.exists("/run/udev/control"):
            if self.udevd.poll() is not None or time.monotonic() > end:
                raise RuntimeError(f"{UDEVD} does not start")
            select.select([], [], [], 0.01)

    def stop_udevd(self):
        if self.udevd:
            self.udevd.terminate()
            self.udevd.wait()
            self.udevd = None
        pathlib.Path("/run/udev/control").unlink(missing_ok=True)  # what it leaves behind is of no use

    def make_places(self):
        run("mount", "--make-rprivate", "/")
        stage = "/sys"  # the devices' nodes are gathered there before it becomes /dev
        run("mount", "-t", "tmpfs", "none", stage)
        for name in NODES:
            pathlib.Path(stage, name).touch()
            run("mount", "--bind", f"/dev/{name}", f"{stage}/{name}")
        os.mkdir(f"{stage}/pts")
        run("mount", "--rbind", "/dev/pts", f"{stage}/pts")
        os.symlink("pts/ptmx", f"{stage}/ptmx")
        for link, to in (("fd", "/proc/self/fd"), ("stdin", "fd/0"), ("stdout", "fd/1"), ("stderr", "fd/2")):
            os.symlink(to, f"{stage}/{link}")
        os.mkdir(f"{stage}/shm", 0o1777)
        run("mount", "-n", "--move", stage, "/dev")
        run("mount", "-t", "tmpfs", "none", "/sys")
        run("mount", "-t", "tmpfs", "none", "/run")
        for folder in ("/sys/bus", "/sys/class", "/sys/devices", "/run/udev"):
            os.mkdir(folder)

    def serve(self):
        self.say({})
        for line in sys.stdin:
            command = json.loads(line)
            try:
                self.say(getattr(self, command.pop("do"))(**command) or {})
            except Exception as problem:  # told to whoever asked
                self.say({"error": f"{type(problem).__name__}: {problem}"})
        self.stop_udevd()

    @staticmethod
    def say(answer):
        print(json.dumps(answer), flush=True)

    # ---- what is asked for

    def plug(self, folders, node):
        if node:
            path = pathlib.Path("/dev", node[0])
            path.parent.mkdir(exist_ok=True)
            if path.parent.name != "dev":
                (path.parent / ".stays").touch()  # udevd removes a folder of /dev when the last device of it has gone
            path.touch()
            run("mount", "--bind", node[1], str(path))
        for folder in folders:
            said = self.make_folder(**folder)
            self.event("add", folder["path"], said)
        return {"properties": said}

    def make_folder(self, path, subsystem, is_bus, files, properties):
        place = pathlib.Path("/sys" + path)
        place.mkdir(parents=True)
        home = pathlib.Path("/sys/bus", subsystem, "devices") if is_bus else pathlib.Path("/sys/class", subsystem)
        home.mkdir(parents=True, exist_ok=True)
        (place / "subsystem").symlink_to(home.parent if is_bus else home)
        link = home / place.name
        link.symlink_to(place)
        self.links[path] = link
        for name, content in files.items():
            self.write(f"{path}/{name}", content)
        if "MAJOR" in properties:
            self.write(f"{path}/dev", f"{properties['MAJOR']}:{properties['MINOR']}\n")
        self.write(f"{path}/uevent", "".join(f"{k}={v}\n" for k, v in properties.items()))
        return {"SUBSYSTEM": subsystem, **properties}

    @staticmethod
    def write(path, content):
        place = pathlib.Path("/sys" + path)
        if content is None:
            return place.unlink(missing_ok=True)
        place.parent.mkdir(parents=True, exist_ok=True)
        # At once, as the kernel does it: nobody reads half of it.
        new = place.with_name(place.name + ".new")
        new.write_text(content, errors="surrogateescape")
        new.rename(place)

    @staticmethod
    def freeze(path):
        os.unlink("/sys" + path)
        os.mkfifo("/sys" + path)

    def thaw(self, path, content):
        frozen = f"/sys{path}.frozen"
        os.rename("/sys" + path, frozen)  # who is let go may read again at once
        self.write(path, content)
        try:
            os.close(os.open(frozen, os.O_WRONLY | os.O_NONBLOCK))
        except OSError:
            pass  # nobody waits
        os.unlink(frozen)

    def event(self, action, path, properties):
        self.sequence += 1
        said = {"ACTION": action, "DEVPATH": path, **properties, "SEQNUM": self.sequence}
        words = [f"{action}@{path}", *(f"{k}={v}" for k, v in said.items())]
        data = b"".join(os.fsencode(word) + b"\0" for word in words)
        # To the kernel, which tells it to all who listen in this network namespace: NLMSG_MIN_TYPE, NLM_F_REQUEST.
        self.socket.sendto(struct.pack("=IHHII", 16 + len(data), 0x10, 1, self.sequence, 0) + data, (0, 0))

    def unplug(self, path, folders, properties, node):
        if node:
            run("umount", "-l", f"/dev/{node}")
            os.unlink(f"/dev/{node}")
        for folder in reversed(folders):
            self.links.pop(folder).unlink()
            subsystem = os.path.basename(os.readlink(f"/sys{folder}/subsystem"))
            shutil.rmtree(f"/sys{folder}", ignore_errors=True)
            self.event("remove", folder, properties if folder == path else {"SUBSYSTEM": subsystem})


def run(*command):
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode != 0:
        raise RuntimeError(f"{' '.join(command)}: {done.stderr.strip()}")


def main():
    if sys.argv[1:] == ["--inside"]:
        signal.signal(signal.SIGTERM, lambda *_: sys.exit(0))
        Inside().serve()
        return 0
    missing = why_not()
    print(missing or "a hall for devices can be made here")
    return 1 if missing else 0


if __name__ == "__main__":
    sys.exit(main())
