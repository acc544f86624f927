"""What the virtual machine boots: Debian's kernel, and a file system with udevd, a dbus-daemon and a node."""
import json
import os
import re
import shutil
import subprocess

import support

REPO = support.REPO
STORE = REPO / "build/vm"
NODE = "cloud"
# udevd loads most of these by itself when the device appears.
MODULES = ["xhci-pci", "usbserial", "ftdi_sio", "usbhid", "hid-generic", "evdev", "i2c-dev", "i2c-stub", "lm75", "vivid"]
PROGRAMS = ["/lib/systemd/systemd-udevd", "/bin/udevadm", "/usr/bin/dbus-daemon", "/usr/sbin/i2cset"]
GROUPS = ["root", "tty", "dialout", "kmem", "input", "video", "audio", "render", "sgx", "lp", "disk", "cdrom", "tape", "kvm", "plugdev"]
BUS = """<busconfig><type>session</type><listen>unix:path=/run/bus</listen><auth>EXTERNAL</auth>
<policy context="default"><allow send_destination="*"/><allow own="*"/><allow receive_sender="*"/></policy></busconfig>"""
# QEMU's serial line acts as a converter that reports nothing of the device behind it: config/sensors/README.md.
UDEV_RULES = """SUBSYSTEM=="tty", ENV{ID_SERIAL_SHORT}=="TH*", ENV{TRB_SENSOR}="line"
SUBSYSTEM=="tty", ENV{ID_SERIAL_SHORT}=="GPS*", ENV{TRB_SENSOR}="gps"
"""
# QEMU's USB keyboard plays a reader of tags; the machine's own keyboard (PS/2) stays a keyboard.
TAGS = {"match": {"subsystem": "input", "sysname": "event*", "properties": {"ID_INPUT_KEYBOARD": "1", "ID_VENDOR_ID": "0627"}},
        "read": "keyboard", "identity": {"property": "ID_SERIAL_SHORT"}, "sensors": [{"kind": "tag"}]}
# Orders come on the second serial line, each a number and a command; so do their answers.
INIT = """#!/bin/busybox sh
/bin/busybox --install -s /bin
mount -t proc proc /proc; mount -t sysfs sysfs /sys; mount -t devtmpfs dev /dev; mount -t tmpfs run /run; mount -t tmpfs tmp /tmp
mkdir -p /run/udev
ip link set lo up
/lib/systemd/systemd-udevd --daemon
udevadm trigger --action=add --subsystem-nomatch=tty --subsystem-nomatch=vc  # of these there are 130, none of them plugged in
udevadm settle
modprobe i2c-dev
dbus-daemon --config-file=/etc/bus.conf --nofork --nosyslog &
trb up /node &
cat /dev/tty1 >/tmp/typed &
stty -F /dev/ttyS1 raw -echo
exec 3<>/dev/ttyS1
echo ready >&3
while read -r number order <&3; do
  sh -c "$order" >/tmp/out 2>&1
  code=$?
  awk -v number="$number:" '{print number, $0}' /tmp/out >&3  # ends each line, sed would not
  echo "$number= $code" >&3
done
"""


def run(*words, **more):
    done = subprocess.run([str(word) for word in words], capture_output=True, text=True, check=False, **more)
    if done.returncode:
        raise RuntimeError(f"{' '.join(map(str, words))}: {done.stderr.strip()}")
    return done.stdout


def kernel():
    """Debian's kernel, and its version; its modules are in STORE/kernel."""
    if not (STORE / "kernel").exists():
        print("downloading Debian's kernel, once", flush=True)
        half = STORE / "half"
        shutil.rmtree(half, ignore_errors=True)
        (half / "kernel").mkdir(parents=True)
        package = re.search(r"Depends: (linux-image-[0-9]\S*)", run("apt-cache", "depends", "linux-image-amd64"))
        run("apt-get", "download", package[1], cwd=half)
        run("dpkg", "-x", next(half.glob("*.deb")), half / "kernel")
        version = next(half.glob("kernel/boot/vmlinuz-*")).name.removeprefix("vmlinuz-")
        run("/sbin/depmod", "-b", half / "kernel", version)
        (half / "kernel").rename(STORE / "kernel")  # complete, or not there
        shutil.rmtree(half)
    vmlinuz = next(STORE.glob("kernel/boot/vmlinuz-*"))
    return vmlinuz, vmlinuz.name.removeprefix("vmlinuz-")


class VmFleet(support.RouterFleet):
    def node_json(self, node):
        return {**super().node_json(node), "dbus": "unix:path=/run/bus"}


class Root:
    """The machine's file system, as a folder."""

    def __init__(self, path):
        self.path = path
        for folder in ("bin", "sbin", "lib64", "usr/bin", "proc", "sys", "dev", "run", "tmp", "etc"):
            (path / folder).mkdir(parents=True)

    def at(self, path):
        target = self.path / str(path).lstrip("/")
        target.parent.mkdir(parents=True, exist_ok=True)
        return target

    def copy(self, source, to=None):
        shutil.copy(os.path.realpath(source), self.at(to or source))

    def program(self, source, to):
        """With its libraries."""
        self.copy(source, to)
        for line in run("ldd", source).splitlines():
            for word in line.split():
                if word.startswith("/") and not self.at(word).exists():
                    self.copy(word)

    def module(self, name, version):
        for line in run("/sbin/modprobe", "-d", STORE / "kernel", "-S", version, "--show-depends", name).splitlines():
            if line.startswith("insmod"):
                file = line.split()[1]
                self.copy(file, os.path.relpath(file, STORE / "kernel"))

    def write(self, path, text, mode=0o644):
        self.at(path).write_text(text)
        self.at(path).chmod(mode)


def add_node(root, case):
    """A node with its programs; its keys and certificate are made here, as everywhere."""
    for name in ("trb", "trb-router", "trb-sensor-bus"):
        root.program(support.PROGRAMS / name, f"/bin/{name}")
        run("strip", root.at(f"/bin/{name}"))
    fleet = support.make_fleet(case, VmFleet, services={NODE: ["router", "sensor-bus"]}, block=234, udp_port=50934)
    shutil.copytree(fleet.dir(NODE), root.at("node"))
    shutil.copytree(REPO / "config/sensors", root.at("node/sensors"))
    root.write("node/sensors/vm-tags.json", json.dumps(TAGS))


def pack(root, image):
    """The folder as an initramfs."""
    with open(image, "wb") as file:
        subprocess.run(["cpio", "-o", "-H", "newc", "--quiet"], cwd=root.path, input=run("find", ".", cwd=root.path).encode(),
                       stdout=file, check=True)
    return image


def make(folder, version, case):
    """Writes the initramfs into the folder; its temporary files are removed with `case`."""
    root = Root(folder / "root")
    root.copy("/bin/busybox")
    for program in PROGRAMS:
        root.program(program, program if "systemd" in program else f"/bin/{os.path.basename(program)}")
    root.program("/bin/kmod", "/sbin/modprobe")  # its name selects its function
    for name in MODULES:
        root.module(name, version)
    run("/sbin/depmod", "-b", root.path, version)
    shutil.copytree("/lib/udev", root.at("/lib/udev"), ignore=shutil.ignore_patterns("hwdb.*"))
    root.write("etc/udev/rules.d/70-trb.rules", UDEV_RULES)
    root.write("etc/passwd", "root:x:0:0::/:/bin/sh\n")
    root.write("etc/group", "".join(f"{name}:x:{number}:\n" for number, name in enumerate(GROUPS)))
    root.write("etc/bus.conf", BUS)
    root.write("init", INIT, 0o755)
    add_node(root, case)
    return pack(root, folder / "initramfs")
