"""A fleet whose nodes are hosts of a lab: real routers, started in their namespaces, watched by the witness."""
import json
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile
import time

REPO = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(REPO / "scripts"))

import trb_fleet  # noqa: E402
import lab as lab_of  # noqa: E402
from trb_process import wait_until  # noqa: E402
from witness import Witness  # noqa: E402

PROGRAMS = pathlib.Path(os.environ.get("TRB_BIN_DIR", REPO / "build" / "dev" / "bin"))
PORT = 45000
WITHIN_S = 5.0  # every table is right this long after the healing
FAKE_TIME = "/usr/lib/x86_64-linux-gnu/faketime/libfaketime.so.1"


def seed_of(folder, host):
    """What a peer writes into its "seeds": the address, and the link key of the node's certificate."""
    import wire
    text = (folder / "keys" / "certificate.json").read_text()
    payload = bytes.fromhex(json.loads(text)["certificate"]["payload"])
    return {"address": f"{host}:{PORT}", "key": wire.unpack(payload)[0][5].hex()}


class NetFleet(trb_fleet.Fleet):
    """`hosts`: node -> HOST_INT (None: the host's IPv4 address in the lab); `more`: node -> further keys of node.json."""

    def __init__(self, lab, hosts, more=None, network=None, every=0.25, pairs=None, witness=True,
                 ask_every=0.2, look_every=0.05):
        self.folder = tempfile.mkdtemp(prefix="trbn-", dir="/tmp")
        super().__init__(pathlib.Path(self.folder) / "f", PROGRAMS, robots={}, cloud=False, name="network")
        self.lab, self.host_int = lab, dict(hosts)
        self.node_names = list(hosts)
        self.more, self.network_more = more or {}, network or {}
        self.routers, self.kept_pids = {}, {}
        self.every, self.traffic_pairs, self.with_witness = every, pairs, witness
        self.ask_every, self.look_every = ask_every, look_every
        self.witness = None
        self.boots_before = {}  # node -> boot when it was stopped last
        self.extra_start = {}  # node -> environment of its next starts

    def __enter__(self):
        self.make()
        return self

    def __exit__(self, *_):
        if self.witness:
            self.witness.end()
        for router in self.routers.values():
            router.send_signal(signal.SIGTERM)
        for router in self.routers.values():
            lab_of.end(router)
        if os.environ.get("TRB_KEEP") != "1":
            shutil.rmtree(self.folder, ignore_errors=True)

    # ---- folders

    def make_node(self, node):
        super().make_node(node)
        path = self.dir(node) / "network.json"
        network = json.loads(path.read_text())
        network["HOST_INT"] = self.host_int[node] or self.lab.address(node)
        network.update(self.network_more.get(node, {}))
        path.write_text(json.dumps(network))

    def node_json(self, node):
        return {"id": node, "role": "cloud", "services": ["router", "scheduler"], **self.more.get(node, {})}

    def change_node_json(self, node, **keys):
        path = self.dir(node) / "node.json"
        path.write_text(json.dumps({**json.loads(path.read_text()), **keys}))

    def seed(self, node, address=None):
        return seed_of(self.dir(node), address or self.lab.address(node))

    # ---- processes

    def start_router(self, node, env=None):
        log = open(self.root / f"router-{node}.txt", "ab")
        command = self.lab.inside(node, self.programs / "trb-router", self.dir(node))
        self.routers[node] = subprocess.Popen(command, stdout=log, stderr=log, stdin=subprocess.DEVNULL,
                                              env={**os.environ, **(env or {})}, preexec_fn=trb_fleet.end_with_parent)
        log.close()
        self.kept_pids[node] = self.routers[node].pid

    def stop_router(self, node, how=signal.SIGKILL):
        lab_of.end(self.routers.pop(node), how)
        self.boots_before[node] = self.boot(node)

    def start_all(self):
        for node in self.node_names:
            self.start_router(node)
        if self.witness is None and self.with_witness:
            self.witness = Witness({node: self.dir(node) for node in self.node_names}, self.every,
                                   self.traffic_pairs, self.ask_every)
            self.witness.start()

    def restarted(self):
        """Nodes whose router is not the process that was started."""
        return [n for n, r in self.routers.items() if r.poll() is not None or r.pid != self.kept_pids[n]]

    def boot(self, node):
        """The boot number of its last start, as its router has stored it; not the number from before it was stopped."""
        path = self.dir(node) / "state" / "boot"
        now = int(path.read_text()) if path.exists() else 0
        return now if now > self.boots_before.get(node, 0) else -1

    # ---- what is right

    def faults(self, since, via=None):
        """The faults of the tables that were requested after `since`; none: each knows each, by one link per pair."""
        via = via or {}
        tables = self.witness.tables(since)
        out = [f"{n}: no table" for n in self.node_names if n not in tables]
        boots = {n: self.boot(n) for n in self.node_names}
        for a, table in tables.items():
            for b in self.node_names:
                row = table.get(b)
                out += [f"{a}: {b} {what}" for what in self.row_faults(a, b, row, tables, via, boots)]
            out += [f"{a}: {row} is too much" for row in table if row not in self.node_names]
        return out

    def row_faults(self, a, b, row, tables, via, boots):
        if row is None:
            return ["is missing"]
        if row["boot"] != boots[b]:
            return [f"has boot {row['boot']}, not {boots[b]}"]
        if a == b:
            return []
        if row["state"] != "ONLINE":
            return [f"is {row['state']}"]
        relay = via.get((a, b)) or via.get((b, a))
        if relay:
            return [] if row.get("via") == relay else [f"is reached by {row.get('via') or 'a link'}, not by {relay}"]
        if row.get("via"):
            return [f"is reached by {row['via']}"]
        other = tables.get(b, {}).get(a)
        if row["link"] == 0 or other is None or other["link"] != row["link"]:
            return [f"has link {row['link']:x} there, {other['link'] if other else 0:x} here"]
        return []

    def wait_right(self, timeout, via=None, since=None):
        """Seconds until every table is right and a message arrived for every pair; None if not in time."""
        since = time.monotonic() if since is None else since
        pairs = self.witness.pairs
        self.progress = []

        def is_right():
            faults = self.faults(since, via)
            self.progress.append((round(time.monotonic() - since, 1), len(faults), faults[-3:]))
            return not faults and not self.witness.silent_pairs(since, pairs)
        took = wait_until(is_right, timeout, self.look_every)
        return None if took is None else time.monotonic() - since

    def what_is_wrong(self, since, via=None):
        return (self.faults(since, via) + [f"{a} to {b}: no message" for a, b in
                                           self.witness.silent_pairs(since, self.witness.pairs)])[:8]

    def connections(self, node):
        """Established connections between this router's host and other routers, by the kernel's count."""
        count = 0
        for name in ("tcp", "tcp6"):
            try:
                rows = pathlib.Path(f"/proc/{self.routers[node].pid}/net/{name}").read_text().splitlines()[1:]
            except OSError:
                continue
            for row in rows:
                local, remote, state = row.split()[1:4]
                count += state == "01" and f"{PORT:04X}" in (local.rsplit(":")[-1], remote.rsplit(":")[-1])
        return count

    def extra_connections(self, expected):
        """The number of connections beyond one per pair: 0 once dead ones are closed."""
        return sum(self.connections(n) - expected[n] for n in self.routers)

    def log_lines(self, node, count=12):
        path = self.dir(node) / "log" / "router.log"
        return path.read_text(errors="replace").splitlines()[-count:] if path.exists() else []

    def note(self, node):
        """The router's note in the service list."""
        return self.services(node)["router"].get("note", "")

    def doors(self, node):
        """The local addresses on which the router listens, by the kernel's table."""
        rows = pathlib.Path(f"/proc/{self.routers[node].pid}/net/tcp").read_text().splitlines()[1:]
        rows += pathlib.Path(f"/proc/{self.routers[node].pid}/net/tcp6").read_text().splitlines()[1:]
        local = [row.split()[1].rsplit(":", 1)[0] for row in rows if row.split()[3] == "0A"]
        return [".".join(str(b) for b in reversed(bytes.fromhex(a[-8:]))) for a in local]

    def counters(self, node):
        rows = self.json("service", "counters", "router", node=node)["values"]
        return {row["name"]: int(row["value"]) for row in rows}
