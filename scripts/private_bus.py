"""A D-Bus of its own, with the system bus's rules and the project's policy: for what must not touch the machine's."""
import hashlib
import os
import pathlib
import signal
import stat
import string
from xml.sax.saxutils import escape

import trb_fleet

CONFIG = """<!DOCTYPE busconfig PUBLIC "-//freedesktop//DTD D-Bus Bus Configuration 1.0//EN"
 "http://www.freedesktop.org/standards/dbus/1.0/busconfig.dtd">
<busconfig>
  <listen>{address}</listen>
  <auth>EXTERNAL</auth>
  <policy context="default">
    <allow user="*"/>
    <deny own="*"/>
    <deny send_type="method_call"/>
    <allow send_type="signal"/>
    <allow send_requested_reply="true" send_type="method_return"/>
    <allow send_requested_reply="true" send_type="error"/>
    <allow receive_type="method_call"/>
    <allow receive_type="method_return"/>
    <allow receive_type="error"/>
    <allow receive_type="signal"/>
    <allow send_destination="org.freedesktop.DBus"/>
  </policy>
  <policy user="{user}">
    <allow own_prefix="trbots"/>
  </policy>
  <include>{policy}</include>
  {more}
</busconfig>
"""


LONGEST = 107  # bytes of a socket's path: sun_path
PLAIN = set((string.ascii_letters + string.digits + "-_/.").encode())


def escaped(path):
    """A path as a D-Bus address has it: a space is %20."""
    return "".join(chr(byte) if byte in PLAIN else f"%{byte:02x}" for byte in os.fsencode(path))


def socket_of(folder, name):
    """The path of a socket: in the folder, or, if that is too long, in a private one that is named after it."""
    path = pathlib.Path(folder) / name
    if len(os.fsencode(path)) <= LONGEST:
        return path
    own = "trb-" + hashlib.sha256(os.fsencode(path.parent)).hexdigest()[:16]
    bases = [base for base in (os.environ.get("XDG_RUNTIME_DIR"), "/tmp") if base and os.path.isdir(base)]
    short = next(pathlib.Path(base) / own for base in bases if len(os.fsencode(pathlib.Path(base) / own / name)) <= LONGEST)
    short.mkdir(mode=0o700, exist_ok=True)
    found = short.lstat()
    if not stat.S_ISDIR(found.st_mode) or found.st_uid != os.geteuid() or stat.S_IMODE(found.st_mode) != 0o700:
        raise RuntimeError(f"{short} is not a folder of {os.geteuid()} alone: remove it, or name a shorter folder than {folder}")
    return short / name


class PrivateBus:
    """A dbus-daemon that is started and stopped as one likes; its files are folder/NAME, NAME.conf and NAME.log, its socket
    elsewhere if the folder's path is too long for one. `more`: further rules, which come last."""

    def __init__(self, folder, name="bus", more=""):
        self.socket = socket_of(folder, name)
        self.elsewhere = self.socket.parent != pathlib.Path(folder)
        self.config = folder / f"{name}.conf"
        self.log = folder / f"{name}.log"
        self.address = f"unix:path={escaped(self.socket)}"
        self.more = more
        self.process = None

    def start(self):
        policy = trb_fleet.REPO / "deploy" / "dbus" / "trbots.conf"
        self.config.write_text(CONFIG.format(address=self.address, policy=escape(str(policy)), user=trb_fleet.user(),
                                             more=self.more))
        self.socket.unlink(missing_ok=True)
        command = ["/usr/bin/dbus-daemon", f"--config-file={self.config}", "--nofork", "--nosyslog", "--print-address=1"]
        self.process = trb_fleet.Process(command, self.log)
        self.process.wait_line("unix:", trb_fleet.LONG_S)

    def stop(self, how=signal.SIGTERM):
        if self.process:
            self.process.stop(how)
            self.process = None
        self.socket.unlink(missing_ok=True)
        if self.elsewhere:
            try:
                self.socket.parent.rmdir()
            except OSError:
                pass  # it is not there any more, or another bus is
