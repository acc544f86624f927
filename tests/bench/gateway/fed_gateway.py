"""A real gateway whose fleet is fed: trb-bench-gateway has the place of its node's router, and plays the robots behind it."""
import json
import os
import pathlib
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parents[1] / "browser"), str(HERE.parents[2] / "scripts")]
import gateway_page  # noqa: E402
import trb_fleet  # noqa: E402
from trb_fleet import CLOUD  # noqa: E402

BLOCK = 165
BUS = f"tcp://127.0.{BLOCK}.1:46000"
TICK = os.sysconf("SC_CLK_TCK")


class FedGateway(trb_fleet.Fleet):
    """One cloud node, of which only the gateway runs. Its bus is TCP with CURVE, and the feeder is the other end."""

    def __init__(self, folder, programs, robots, changes):
        super().__init__(folder, programs, block=BLOCK, udp_port=50000 + BLOCK, robots={}, name="bench",
                         gateway_port=trb_fleet.free_port())
        self.robot_count, self.changes = robots, changes
        self.parts = {}

    def node_json(self, node):
        return {**super().node_json(node), "bus": BUS}

    def processes(self):
        return list(self.parts.values())

    def start(self):
        """Returns once the gateway has its router's welcome, and has people."""
        self.start_feeder()
        log = self.root / "gateway.log"
        self.parts["gateway"] = trb_fleet.Process([self.programs / "trb-cloud-gateway", self.dir(CLOUD)], log)
        gateway_page.open_to_people(self)

    def start_feeder(self):
        feeder = [self.programs / "trb-bench-gateway", "feed", self.dir(CLOUD), self.robot_count, self.changes]
        self.parts["feeder"] = trb_fleet.Process(feeder, self.root / "feeder.log")
        self.parts["feeder"].wait_line("feeding", 10)

    def stop_feeder(self):
        """What it has sent."""
        feeder = self.parts.pop("feeder")
        feeder.child.terminate()
        line, _ = feeder.wait_line("sent", 10)
        feeder.stop()
        return json.loads(line)

    def stop(self):
        for part in self.parts.values():
            part.stop()
        self.parts.clear()

    def certificate(self):
        return self.dir(CLOUD) / "keys/gateway.crt"

    def token(self, name):
        """Of a program that only reads."""
        admin = gateway_page.client(self)
        admin.sign_in("admin", gateway_page.PASSWORD)
        made = admin.ask("POST", "/api/v1/tokens", {"name": name, "role": "viewer", "read_only": True, "days": 1})
        if made.status != 201:
            raise RuntimeError(f"POST /api/v1/tokens: {made.status} {made.bytes.decode()}")
        return made.json["secret"]

    def pid(self, part):
        return self.parts[part].child.pid

    def cpu_s(self, part):
        """Of all of its threads, since its start."""
        words = pathlib.Path(f"/proc/{self.pid(part)}/stat").read_text().rsplit(") ", 1)[1].split()
        return (int(words[11]) + int(words[12])) / TICK

    def memory_mb(self, part):
        status = pathlib.Path(f"/proc/{self.pid(part)}/status").read_text()
        return int(status.split("VmRSS:")[1].split()[0]) / 1024
