"""A tenant's fleet over its VPN: the cloud's node on a host that other tenants share, each robot's node behind a translator
of its own. Real processes, all of them: `trb up` of each node, robots of tests/support/robots on the fields."""
import json
import os
import pathlib
import shutil
import sqlite3
import subprocess
import sys

REPO = pathlib.Path(__file__).resolve().parents[2]
sys.path[:0] = [str(REPO / "scripts"), str(REPO / "tests/network"), str(REPO / "tests/integration"), str(REPO / "tests/support")]

import net_fleet  # noqa: E402
import trb_fleet  # noqa: E402
from trb_fleet import CLOUD  # noqa: E402

ENDED = ("FINISHED", "FAILED", "ABORTED", "EXPIRED")


class VpnFleet(trb_fleet.Fleet):
    """`user`: whose the cloud's node is, a number; nobody else may read its folder."""

    def __init__(self, root, programs, lab, tenant, tunnels, cloud_host, robots, user):
        super().__init__(root, programs, robots=robots, name=tenant.name, udp_port=50000)
        self.lab, self.tenant, self.tunnels, self.cloud_host, self.user = lab, tenant, tunnels, cloud_host, user

    # ---- addresses: a robot's node has its hall's, and the tunnel besides

    def host(self, node):
        return self.cloud_host if node == CLOUD else node

    def address(self, node):
        return self.tenant.cloud if node == CLOUD else f"{self.inner(node)}.2"

    def robot_address(self, node):
        return f"{self.inner(node)}.3"

    def inner(self, node):
        return f"192.168.{100 + self.lab.hosts[f'{node}-nat']}"

    # ---- folders

    def make(self):
        super().make()
        seed = net_fleet.seed_of(self.dir(CLOUD), self.tenant.cloud)
        for robot in self.robots:
            self.change(robot, "node.json", seeds=[seed])
        for path in (self.root, self.root / "nodes"):
            path.chmod(0o755)
        for path in (self.dir(CLOUD), *self.dir(CLOUD).rglob("*")):
            os.chown(path, self.user, self.user)
        self.dir(CLOUD).chmod(0o700)

    def make_node(self, node):
        super().make_node(node)
        network = {"VPN_INT": "" if node == CLOUD else self.tunnels.robot_device}
        if node == CLOUD:
            network["HOST_INT"] = self.tunnels.device(self.tenant)
        self.change(node, "network.json", **network)

    def change(self, node, file, **keys):
        path = self.dir(node) / file
        path.write_text(json.dumps({**json.loads(path.read_text()), **keys}))

    def node_json(self, node):
        more = {"beacon": False, "relay": True} if node == CLOUD else {}
        return {**super().node_json(node), **more}

    # ---- processes, each on its host

    def virtual_robot(self, node):
        return self.lab.inside(node, *super().virtual_robot(node))

    def as_user(self, *words):
        number = str(self.user)
        return ["setpriv", "--reuid", number, "--regid", number, "--clear-groups", *map(str, words)]

    def start_supervisor(self, node):
        up = [self.programs / "trb", "up", self.dir(node), "--die-with-parent"]
        command = self.lab.inside(self.host(node), *(self.as_user(*up) if node == CLOUD else up))
        self.nodes[node] = trb_fleet.Process(command, self.root / f"up-{node}.log")

    # ---- what a test asks

    def routes(self, node):
        return {row["id"]: row for row in self.json("route", "list", node=node)["routes"]}

    def counters(self, node, service="router"):
        rows = self.json("service", "counters", service, node=node)["values"]
        return {row["name"]: int(row["value"]) for row in rows}

    def submit(self, scenario):
        path = self.root / "scenario.json"
        path.write_text(json.dumps(scenario))
        return self.json("scenario", "run", path, node=CLOUD)["run"]

    def view(self, run, node=CLOUD):
        done = self.trb("scenario", "watch", run, "--once", "--json", node=node, check=False)
        answer = json.loads(done.stdout.splitlines()[-1]) if done.stdout.strip() else {}
        return answer if "tasks" in answer else {"state": "", "tasks": []}

    def wait_ended(self, run, timeout=90):
        seen = {}

        def ended():
            seen.update(self.view(run))
            return seen["state"] in ENDED
        self.wait(f"the run {run} ends", ended, timeout)
        return seen

    def begun(self):
        """What each robot was told to begin, by its own words."""
        self.pump()
        return {name: [line.split()[1] for line in robot.lines if line.startswith("start ")]
                for name, robot in self.virtual.items()}

    def words_of_database(self):
        """Everything that the cloud's capability.db has, as one text."""
        copy = self.root / "capability-copy.db"
        for end in ("", "-wal"):
            source = self.dir(CLOUD) / "state" / f"capability.db{end}"
            if source.exists():
                shutil.copy(source, f"{copy}{end}")
        with sqlite3.connect(copy) as db:
            tables = [row[0] for row in db.execute("SELECT name FROM sqlite_master WHERE type = 'table'")]
            return "\n".join(repr(row) for table in tables for row in db.execute(f'SELECT * FROM "{table}"'))

    def tap(self, seconds):
        """`trb tap` of the cloud's node, all that passes for so long."""
        command = [self.programs / "trb", "tap", "--all", "--json", "--timeout", seconds, "--node", self.dir(CLOUD)]
        return subprocess.Popen([str(word) for word in command], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                                preexec_fn=trb_fleet.end_with_parent)

    def log_lines(self, node, service="router", count=10):
        path = self.dir(node) / "log" / f"{service}.log"
        return path.read_text(errors="replace").splitlines()[-count:] if path.exists() else []
