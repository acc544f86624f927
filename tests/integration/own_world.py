"""A mount and a network namespace of the test's own: disks of any size, name servers with given answers."""
import ctypes
import fcntl
import os
import pathlib
import shutil
import socket
import struct
import subprocess
import sys

import support  # noqa: F401: sets the path for the next import
import skips

INSIDE = "TRB_OWN_WORLD"
LIBC = ctypes.CDLL(None, use_errno=True)
MS_BIND = 4096
MS_RDONLY, MS_REMOUNT = 1, 32
SIOCSIFFLAGS, SIOCGIFFLAGS, IFF_UP = 0x8914, 0x8913, 1


def enter():
    """Runs this program again in namespaces of its own; ends it as skipped, with the reason, where there are none."""
    if INSIDE in os.environ:
        return loopback_up()
    why = ""
    for user in ([] if os.geteuid() == 0 else ["--map-root-user"]), ["--map-root-user"]:
        command = ["unshare", *user, "--mount", "--net", "--propagation", "private"]
        # A mount is tried, too: some machines allow a namespace, but no mount in it.
        tried = subprocess.run([*command, "mount", "-t", "tmpfs", "none", "/mnt"], capture_output=True, text=True)
        if tried.returncode == 0:
            os.execvpe(command[0], [*command, sys.executable, *sys.argv], dict(os.environ, **{INSIDE: "1"}))
        why = tried.stderr.strip() or f"exit {tried.returncode}"
    skips.leave(f"no mount namespace can be made here: {why}")


def loopback_up():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as any_socket:
        request = struct.pack("16sh14x", b"lo", 0)
        flags = struct.unpack("16sh14x", fcntl.ioctl(any_socket, SIOCGIFFLAGS, request))[1]
        fcntl.ioctl(any_socket, SIOCSIFFLAGS, struct.pack("16sh14x", b"lo", flags | IFF_UP))


def mount(source, target, kind, flags=0, options=""):
    done = LIBC.mount(os.fsencode(source), os.fsencode(target), kind.encode(), flags, options.encode())
    if done != 0:
        raise OSError(ctypes.get_errno(), f"mount {kind} on {target}")


def unmount(target):
    LIBC.umount2(os.fsencode(target), 2)


def put_over(path, text, folder):
    """Gives this file another text, visible only here."""
    other = pathlib.Path(folder) / pathlib.Path(path).name
    other.write_text(text)
    mount(other, path, "", MS_BIND)


class SmallDisk:
    """Moves a folder onto a disk of its own, which can be filled to the last byte."""

    def __init__(self, folder, size="16m", files=0):
        """files: how many there may be; 0: any number."""
        self.folder = pathlib.Path(folder)
        aside = self.folder.with_name(self.folder.name + "-aside")
        self.folder.rename(aside)
        self.folder.mkdir(mode=0o700)
        mount("none", self.folder, "tmpfs", options=f"size={size},mode=0700,nr_inodes={files}")
        subprocess.run(["cp", "-a", f"{aside}/.", self.folder], check=True)
        self.ballast = self.folder / "ballast"
        self.many = self.folder / "many"

    def read_only(self):
        mount("none", self.folder, "tmpfs", MS_REMOUNT | MS_RDONLY)

    def fill(self, but=0):
        """To the last byte, or until so many bytes are left."""
        if but:
            with open(self.ballast, "ab") as file:
                os.posix_fallocate(file.fileno(), 0, self.left("f_bavail") * self.left("f_frsize") - but)
            return
        with open(self.ballast, "ab", buffering=0) as file:
            for size in 1 << 16, 1 << 12, 1:
                try:
                    while file.write(b"x" * size):
                        pass
                except OSError:
                    pass

    def left(self, what):
        return getattr(os.statvfs(self.folder), what)

    def take_files(self):
        """No file can be made any more."""
        self.many.mkdir()
        while self.left("f_favail") > 0:
            (self.many / str(self.left("f_favail"))).touch()

    def room(self):
        self.ballast.unlink(missing_ok=True)
        shutil.rmtree(self.many, ignore_errors=True)

    def gone(self):
        unmount(self.folder)
