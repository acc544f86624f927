"""A D-Bus of its own, with the system bus's rules and the project's policy: for what must not touch the machine's."""
import signal

import trb_fleet

CONFIG = """<!DOCTYPE busconfig PUBLIC "-//freedesktop//DTD D-Bus Bus Configuration 1.0//EN"
 "http://www.freedesktop.org/standards/dbus/1.0/busconfig.dtd">
<busconfig>
  <listen>unix:path={socket}</listen>
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
</busconfig>
"""


class PrivateBus:
    """A dbus-daemon that is started and stopped as one likes; its files are folder/NAME, NAME.conf and NAME.log."""

    def __init__(self, folder, name="bus"):
        self.socket = folder / name
        self.config = folder / f"{name}.conf"
        self.log = folder / f"{name}.log"
        self.address = f"unix:path={self.socket}"
        self.process = None

    def start(self):
        policy = trb_fleet.REPO / "deploy" / "dbus" / "trbots.conf"
        self.config.write_text(CONFIG.format(socket=self.socket, policy=policy, user=trb_fleet.user()))
        self.socket.unlink(missing_ok=True)
        command = ["/usr/bin/dbus-daemon", f"--config-file={self.config}", "--nofork", "--nosyslog", "--print-address=1"]
        self.process = trb_fleet.Process(command, self.log)
        self.process.wait_line("unix:", 10)

    def stop(self, how=signal.SIGTERM):
        if self.process:
            self.process.stop(how)
            self.process = None
