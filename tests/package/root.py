"""A Debian 12 in a folder, to install packages in: commands in it, and what its files are."""
import hashlib
import os
import pathlib
import re
import shutil
import subprocess
import time

REPO = pathlib.Path(__file__).resolve().parents[2]
# What apt, dpkg and the machine write for themselves.
OWN = ("proc/", "dev/", "sys/", "run/", "tmp/", "var/cache/", "var/lib/apt/", "var/lib/dpkg/", "var/log/", "etc/resolv.conf", "etc/ld.so.cache",
       "etc/mtab", "packages/", "root/", "var/lib/systemd/")


class Failed(Exception):
    """A command that ended with an error: its words and what it said."""


class Done:
    """What a command said, and the seconds it took: by the clock, and of a processor."""

    def __init__(self, said, seconds, processor):
        self.said, self.seconds, self.processor = said, seconds, processor


class Root:
    def __init__(self, base, path):
        self.path = pathlib.Path(path)
        subprocess.run(["cp", "-a", "--reflink=auto", base, self.path], check=True)
        self.shared = self.path.parent / "packages"
        self.shared.mkdir(exist_ok=True)

    def run(self, script, check=True, timeout=900):
        """The script, as root, in this Debian, in namespaces of its own: what it starts ends with it."""
        words = ["unshare", "--net", "bash", "-c", f'. {REPO}/scripts/package_root.sh; ip link set lo up; in_root "$@"', "in_root"]
        if re.search(r"\bapt(-get)? ", script):
            words = ["bash", "-c", f'. {REPO}/scripts/package_root.sh; in_root "$@"', "in_root"]
        began, before = time.monotonic(), os.times()
        done = subprocess.run([*words, self.path, self.shared, self.path.parent / "cache", "bash", "-ec", script], stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, text=True, errors="replace", check=False, timeout=timeout)
        after = os.times()
        if check and done.returncode:
            raise Failed(f"{script.strip()}\n  ended with {done.returncode}:\n{done.stdout[-3000:]}")
        return Done(done.stdout, time.monotonic() - began,
                    after.children_user - before.children_user + after.children_system - before.children_system)

    def share(self, *files):
        """Puts the files where `run` finds them; their paths there."""
        for file in files:
            shutil.copy(file, self.shared)
        return [str(self.shared / pathlib.Path(file).name) for file in files]

    def files(self, below=""):
        """path: what is there (mode, owner, and the content or target), without what apt and dpkg note for themselves."""
        found = {}
        for folder, folders, names in os.walk(self.path / below):
            for name in folders + names:
                path = pathlib.Path(folder, name)
                key = str(path.relative_to(self.path))
                if not (key + "/").startswith(OWN):
                    found[key] = self.state(path)
            folders[:] = [name for name in folders if not (str(pathlib.Path(folder, name).relative_to(self.path)) + "/").startswith(OWN)]
        return found

    @staticmethod
    def state(path):
        status = path.lstat()
        if path.is_symlink():
            return ("link", os.readlink(path))
        if path.is_dir():
            return ("folder", status.st_mode, status.st_uid)
        return ("file", status.st_mode, status.st_uid, hashlib.sha256(path.read_bytes()).hexdigest() if path.is_file() else "")
