"""A systemd of the test's own: it is process 1 of namespaces, on this machine's files with a layer above that goes with it."""
import os
import pathlib
import re
import shutil
import subprocess
import time
import uuid

SYSTEMD = "/lib/systemd/systemd"
BOOT_S = 60
TARGET = "a-test.target"
NOT_PREPARED = 33  # of the script below: a fault of the test's
UP = "[Unit]\nDescription=only what a test starts\nAllowIsolate=yes\n"

# With a network, a name and signals of its own. /proc/sys and /sys can be read only: systemd would set them for the machine.
BOOT = r"""
set -e
layer="$1" root="$1/root" prepare="$2"
mount --make-rprivate /
mount -t tmpfs layer "$layer"
mkdir "$layer/above" "$layer/work" "$root"
mount -t overlay root -o "lowerdir=/,upperdir=$layer/above,workdir=$layer/work" "$root"
mount -t proc proc "$root/proc"
mount --bind -o ro "$root/proc/sys" "$root/proc/sys"
mount -t sysfs -o ro sys "$root/sys"
mount -t cgroup2 cgroup "$root/sys/fs/cgroup"
mount -t tmpfs run "$root/run"
mount -t tmpfs dev "$root/dev"
cp -a /dev/null /dev/zero /dev/full /dev/random /dev/urandom /dev/tty "$root/dev"
mkdir "$root/dev/shm" "$root/dev/pts" "$root/dev/mqueue"; ln -s pts/ptmx "$root/dev/ptmx"
touch "$root/dev/console"
ip link set lo up
rm -rf "$root"/etc/systemd/system/*.wants
export root
bash -ec "$prepare" || exit 33
cd "$root"
mkdir -p before
pivot_root . before
cd /
umount -l /before
exec env -i container=test PATH=/usr/sbin:/usr/bin:/sbin:/bin "$3" --log-target=console --show-status=no "--unit=$4" </dev/null
"""


def why_not():
    """What is missing here; None: it can be tried."""
    if os.geteuid() != 0:
        return "needs root, for a systemd of its own; run it with sudo"
    for program, package in ((SYSTEMD, "systemd"), ("unshare", "util-linux"), ("ip", "iproute2")):
        if shutil.which(program) is None:
            return f"needs {program}: apt-get install {package}"
    if cgroups() is None:
        return "has no cgroups of version 2"
    return None


def cgroups():
    """Where this machine has its cgroups of version 2."""
    mounts = pathlib.Path("/proc/self/mounts").read_text().splitlines()
    found = [pathlib.Path(line.split()[1]) for line in mounts if line.split()[2] == "cgroup2"]
    return found[0] if found else None


class CannotBoot(Exception):
    """This machine does not let it: the last word of what was tried."""


class OwnSystemd:
    """`prepare`: a script that puts files below $root before systemd starts."""

    def __init__(self, folder, prepare):
        self.layer = folder / "layer"
        self.layer.mkdir()
        here = re.search(r"^0::/(.*)$", pathlib.Path("/proc/self/cgroup").read_text(), re.MULTILINE)
        self.cgroup = cgroups() / (here[1] if here else "") / f"trb-test-{uuid.uuid4().hex[:8]}"
        self.child = self.pid = None
        prepare = f"printf '{UP}' > $root/etc/systemd/system/{TARGET}\n{prepare}"
        namespaces = ("--mount", "--pid", "--net", "--uts", "--ipc", "--cgroup", "--fork", "--kill-child", "--mount-proc")
        # unshare takes no SIGTERM: it is killed if the test is.
        self.command = ["setpriv", "--pdeathsig", "KILL", "unshare", *namespaces, "bash", "-c", BOOT, "boot", self.layer, prepare, SYSTEMD, TARGET]

    def boot(self):
        """Returns when it takes orders. Raises CannotBoot."""
        with open(self.layer.parent / "boot.log", "wb") as log:
            try:
                self.cgroup.mkdir()
                # Its cgroups begin where it is when they become its own.
                join = ["sh", "-c", f'echo $$ > "{self.cgroup}/cgroup.procs" && exec "$@"', "join"]
                self.child = subprocess.Popen([*join, *self.command], stdout=log, stderr=log, stdin=subprocess.DEVNULL)
            except OSError as fault:
                raise CannotBoot(str(fault)) from None
        self.wait("systemd is up", self.is_up, BOOT_S)

    def is_up(self):
        if self.child.poll() is not None:
            said = (self.layer.parent / "boot.log").read_text(errors="replace").strip()
            if self.child.returncode == NOT_PREPARED:
                raise RuntimeError(said)
            raise CannotBoot(said.splitlines()[-1] if said else f"unshare: {self.child.returncode}")
        try:
            self.pid = pathlib.Path(f"/proc/{self.child.pid}/task/{self.child.pid}/children").read_text().split()[0]
            if pathlib.Path(f"/proc/{self.pid}/comm").read_text() != "systemd\n":
                return False
        except (IndexError, OSError):
            return False  # it begins, or ends
        return self.sh(f"systemctl is-active {TARGET}", check=False).stdout.strip() == "active"

    def stop(self):
        if self.child:
            self.child.kill()
            self.child.wait()
            self.wait("its processes have ended", lambda: "populated 0" in (self.cgroup / "cgroup.events").read_text(), BOOT_S)
        if self.cgroup.exists():
            for folder, _, _ in os.walk(self.cgroup, topdown=False):
                os.rmdir(folder)

    def sh(self, order, check=True):
        """As root, where it is."""
        words = ["nsenter", "--target", self.pid, "--mount", "--pid", "--net", "--uts", "--ipc", "--cgroup", "bash", "-c", order]
        done = subprocess.run(words, capture_output=True, text=True, timeout=120, stdin=subprocess.DEVNULL)
        if check and done.returncode != 0:
            raise RuntimeError(f"{order}: {done.returncode}: {done.stdout}{done.stderr}")
        return done

    def show(self, unit, name):
        return self.sh(f"systemctl show -P {name} {unit}").stdout.strip()

    def wait(self, what, holds, timeout=60):
        """What it holds; looks again and again, each look a program that takes its time."""
        end = time.monotonic() + timeout
        while True:
            found = holds()
            if found:
                return found
            if time.monotonic() > end:
                raise TimeoutError(f"{what}: not within {timeout} s")
