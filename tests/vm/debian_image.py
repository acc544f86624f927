"""A machine with Debian 12, systemd and no network: its disk, a small second one for the node, and what starts it."""
import shutil
import subprocess

import hall
import image
from image import REPO, Root, run

DISK_MB = 1600
STATE_MB = 48
STATE_FILES = 256
MODULES = ["virtio_pci", "virtio_blk", "ext4"]
PACKAGES = "systemd systemd-sysv udev dbus util-linux e2fsprogs procps curl"
INIT = """#!/bin/busybox sh
/bin/busybox --install -s /bin
mount -t proc proc /proc; mount -t sysfs sysfs /sys; mount -t devtmpfs dev /dev
for module in $(cat /modules); do modprobe $module; done
until [ -b /dev/vda ] && [ -b /dev/vdb ]; do sleep 0.1; done
mkdir -p /new
mount -t ext4 /dev/vda /new
mount --move /dev /new/dev; mount --move /proc /new/proc; mount --move /sys /new/sys
exec switch_root /new /sbin/init
"""
ORDERS = """[Unit]
Description=orders of the test
DefaultDependencies=no
After=sysinit.target
[Service]
ExecStart=/usr/local/sbin/orders
Restart=no
[Install]
WantedBy=multi-user.target
"""
# A busy computer takes minutes for what is there at once elsewhere.
FSTAB = "/dev/vda / ext4 rw 0 0\n/dev/vdb /var/lib/talkrobots ext4 rw,x-systemd.device-timeout=900,x-systemd.mount-timeout=900 0 0\n"


def shell(script, *words):
    """With the functions of scripts/package_root.sh."""
    done = subprocess.run(["bash", "-ec", f". {REPO}/scripts/setup.sh; . {REPO}/scripts/package_root.sh; {script}", "test-vm", *map(str, words)],
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
    if done.returncode:
        raise RuntimeError(f"{script}\n{done.stdout[-2000:]}")
    return done.stdout


def system(packages, store):
    """A Debian with systemd and what the packages depend on, but not the packages: they are installed in the machine."""
    root = store / "vm-root"
    if not root.exists():
        half = store / "vm-root.half"
        shutil.rmtree(half, ignore_errors=True)
        shell('debian_root "$1"; cp -a "$1" "$2"', store / "base-root", half)
        script = (f"apt-get update -qq; apt-get install -y -qq --no-install-recommends {PACKAGES}; "
                  "apt-get install -s --no-install-recommends /tmp/packages/*.deb | sed -n 's/^Inst \\([^ ]*\\).*/\\1/p' | grep -v talkrobots | "
                  "xargs apt-get install -y -qq --no-install-recommends; apt-get clean; rm -rf /var/lib/apt/lists/*")
        shell('in_root "$1" "$2" "$3" bash -ec "mkdir -p /tmp/packages; cp $2/*.deb /tmp/packages; $4"', half, packages, store / "cache", script)
        half.rename(root)
    return root


def disk(folder, packages, store):
    """The machine's disk."""
    tree = folder / "system"
    subprocess.run(["cp", "-a", "--reflink=auto", system(packages, store), tree], check=True)
    place = Root.__new__(Root)
    place.path = tree
    for file in packages.glob("*.deb"):
        place.copy(file, f"/root/{file.name}")
    place.copy(REPO / "tests/vm/orders", "/usr/local/sbin/orders")
    place.at("/usr/local/sbin/orders").chmod(0o755)
    for name, text in {"orders": ORDERS, **hall.UNITS}.items():
        place.write(f"/etc/systemd/system/{name}.service", text)
        wants = place.at(f"/etc/systemd/system/multi-user.target.wants/{name}.service")
        if not wants.is_symlink():
            wants.symlink_to(f"/etc/systemd/system/{name}.service")
    place.write("/etc/fstab", FSTAB)
    place.write("/etc/hostname", "hall\n")
    place.at("/usr/sbin/policy-rc.d").unlink(missing_ok=True)
    place.at("/var/log/journal/").mkdir(parents=True, exist_ok=True)  # the journal outlives a power cut
    file = folder / "disk"
    run("mke2fs", "-q", "-t", "ext4", "-d", tree, file, f"{DISK_MB}M")
    shutil.rmtree(tree)
    return file


def state_disk(folder):
    file = folder / "state"
    run("mke2fs", "-q", "-t", "ext4", "-m", "0", "-N", STATE_FILES, file, f"{STATE_MB}M")
    return file


def starter(folder, version):
    """The initramfs that mounts the disk and hands over to systemd."""
    root = Root(folder / "starter")
    root.copy("/bin/busybox")
    root.program("/bin/kmod", "/sbin/modprobe")
    for name in MODULES:
        root.module(name, version)
    run("/sbin/depmod", "-b", root.path, version)
    root.write("modules", "\n".join(MODULES) + "\n")
    root.write("init", INIT, 0o755)
    return image.pack(root, folder / "initramfs")

