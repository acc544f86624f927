"""The roads that scripts/bench measures: real nodes of TalkRoBots, and bare chains of the same sockets."""
import argparse
import json
import os
import pathlib
import shutil
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[3] / "scripts"))
import trb_fleet  # noqa: E402  (found only with the line above)

VENDOR_PORT = 30100
ORDER_PATIENCE_S = 60
TICKS = os.sysconf("SC_CLK_TCK")


def parser_of(prog, description, epilog, rounds, quick):
    """Of the words that every benchmark in turns has; `rounds` and `quick` are the help for two of them."""
    parser = argparse.ArgumentParser(prog=prog, description=description, epilog=f"examples:  {epilog}")
    parser.add_argument("--rounds", type=int, help=rounds)
    parser.add_argument("--quick", action="store_true", help=quick)
    parser.add_argument("--json", metavar="FILE", help="write every figure of every round as JSON")
    parser.add_argument("--programs", type=pathlib.Path, required=True, help=argparse.SUPPRESS)
    return parser


def with_rounds(parser):
    """The arguments, with as many rounds as are measured if none are given."""
    arguments = parser.parse_args()
    if arguments.rounds is None:
        arguments.rounds = 1 if arguments.quick else 5
    if arguments.rounds < 1:
        parser.error("--rounds: at least 1")
    return arguments


class Road:
    """A driver and the processes between its two ends."""

    def __init__(self, name, driver, pids):
        self.name = name
        self.driver = driver
        self.pids = {"robots": driver.child.pid, **pids}

    def order(self, text):
        before = len(self.driver.lines)
        self.driver.say(text)
        try:
            line, _ = self.driver.wait_line("{", ORDER_PATIENCE_S, before)
        except RuntimeError:
            last = pathlib.Path(self.driver.log.name).read_text().splitlines()[-1]
            raise RuntimeError(f"{self.name}, '{text}': {last}") from None
        return json.loads(line)

    def usage(self):
        """Per process: microseconds of CPU and voluntary context switches so far."""
        return {name: (cpu_us(pid), switches(pid)) for name, pid in self.pids.items()}


def cpu_us(pid):
    """All threads together; by the scheduler's nanoseconds where the kernel has them, else by clock ticks."""
    try:
        tasks = pathlib.Path(f"/proc/{pid}/task").glob("*/schedstat")
        return sum(int(task.read_text().split()[0]) for task in tasks) / 1000 or ticks_us(pid)
    except (OSError, IndexError):
        return ticks_us(pid)


def ticks_us(pid):
    fields = pathlib.Path(f"/proc/{pid}/stat").read_text().rsplit(") ", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) * 1e6 / TICKS


def switches(pid):
    total = 0
    for status in pathlib.Path(f"/proc/{pid}/task").glob("*/status"):
        for line in status.read_text().splitlines():
            if line.startswith("voluntary_ctxt_switches"):
                total += int(line.split()[1])
    return total


class Fleet(trb_fleet.Fleet):
    """a: its robot has the field channel; b: its robot is commanded in direct mode."""

    MODES = {"a": "fields", "b": "bench"}
    FILES = {
        "profile.json": {"bench": "direct", "fields": "interpreter"},
        "commands.json": {"bench": {"port": VENDOR_PORT, "transport": "tcp-text", "language": "plain",
                                    "commands": {"move": "{data}", "stop": "stop"}}},
        "places.json": {"places": {}},
        "robots/bench.json": {"maker": "Bench", "model": "bench", "capabilities": ["move"],
                              "field_channel": {"framing": "newline", "encoding": "text", "acknowledge": False},
                              "skills": {}},
    }

    def __init__(self, root, programs, octet, **settings):
        self.octet = octet
        self.settings = settings
        super().__init__(root, programs, udp_port=50000 + octet, name="bench", cloud=False,
                         robots={node: (mode, "bench", []) for node, mode in self.MODES.items()})

    def address(self, node):
        return f"127.{self.octet}.1.{self.number(node)}"

    def robot_address(self, node):
        return f"127.{self.octet}.2.{self.number(node)}"

    def make_node(self, node):
        folder = self.dir(node)
        network = {"UDP_PORT": self.udp_port, "TCP_PORT_EXT": 45000, "TCP_PORT": 40000, "HOST_INT": self.address(node)}
        own = {"node.json": self.node_json(node), "network.json": network}
        for name, content in {**self.FILES, **own}.items():
            path = folder / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(json.dumps(content, indent=2) + "\n")
        self.trb("fleet", "request", folder)

    def node_json(self, node):
        return {**super().node_json(node), "services": ["router", "mode-adapter"], **self.settings}


def without_seals(programs, folder):
    """The programs of a node whose router was built without seals: there is no such setting."""
    folder.mkdir()
    for name, source in (("trb", "trb"), ("trb-mode-adapter", "trb-mode-adapter"),
                         ("trb-router", "trb-bench-router-unsealed")):
        shutil.copy2(programs / source, folder / name)
    return folder


class Roads:
    """Builds the roads of one regime below `root`; everything ends with the `with` block."""

    def __init__(self, root, programs, octet):
        self.root = pathlib.Path(root)
        programs = pathlib.Path(programs).resolve()
        self.program = programs / "trb-bench-road"
        self.octet = octet
        self.fleets = {
            "unsealed": Fleet(self.root / "unsealed", without_seals(programs, self.root / "programs"), octet),
            "unlogged": Fleet(self.root / "unlogged", programs, octet + 1, proof_log_mb=0),
            "sealed": Fleet(self.root / "sealed", programs, octet + 2),
            "each": Fleet(self.root / "each", programs, octet + 3, seal="before_delivery")}
        self.processes = []

    def __enter__(self):
        return self

    def __exit__(self, *_):
        for process in reversed(self.processes):
            process.stop()
        for fleet in self.fleets.values():
            fleet.stop()

    def pump(self):
        for fleet in self.fleets.values():
            fleet.pump()

    def start(self, name, *arguments, until="ready"):
        log = self.root / f"{len(self.processes)}-{name}.log"
        process = trb_fleet.Process([self.program, name, *arguments], log, stdin=subprocess.PIPE)
        self.processes.append(process)
        process.first, _ = process.wait_line(until, 10)
        return process

    def routers(self, name, address):
        """Two bare routers joined by CURVE: their processes and the sockets of their buses."""
        buses = [self.root / f"{name}-{end}.ipc" for end in ("in", "out")]
        second = self.start("curve-bus", address, buses[1], until="listening")
        first = self.start("bus-curve", buses[0], address, second.first.split()[1])
        second.wait_line("ready", 10)
        return {"router a": first.child.pid, "router b": second.child.pid}, buses

    def floor(self):
        """DEALER - ipc - process - CURVE tcp - process - ipc - DEALER."""
        pids, buses = self.routers("floor", f"127.{self.octet}.3.1:45001")
        return Road("floor", self.start("drive-bus", *buses), pids)

    def plain(self):
        """The floor without encryption; its second router is ready once it listens."""
        address, buses = f"127.{self.octet}.3.4:45003", [self.root / f"plain-{end}.ipc" for end in ("in", "out")]
        second, first = self.start("plain-bus", address, buses[1]), self.start("bus-plain", buses[0], address)
        return Road("plain", self.start("drive-bus", *buses), {"router a": first.child.pid, "router b": second.child.pid})

    def bare(self):
        """The floor with one more process and TCP connection at each end: the road without the work of TalkRoBots."""
        node, robot = f"127.{self.octet}.3.2:40000", f"127.{self.octet}.3.3:{VENDOR_PORT}"
        pids, buses = self.routers("bare", f"127.{self.octet}.3.2:45002")
        driver = self.start("drive-tcp", node, "", robot, until="listening")
        first = self.start("tcp-bus", node, buses[0], until="listening")
        last = self.start("bus-tcp", buses[1], robot)
        driver.wait_line("ready", 10)
        first.wait_line("ready", 10)
        return Road("bare", driver, {"adapter a": first.child.pid, **pids, "adapter b": last.child.pid})

    def road(self, name):
        """Two real nodes, from the robot of a to the robot of b."""
        fleet = self.fleets[name]
        fleet.make()
        driver = self.start("drive-tcp", f"{fleet.address('a')}:40000", fleet.robot_address("a"),
                            f"{fleet.robot_address('b')}:{VENDOR_PORT}", "b", until="listening")
        for node in fleet.node_names:
            fleet.start_node(node)
        fleet.wait_formed(30)
        driver.wait_line("ready", 10)
        return Road(name, driver, {"adapter a": fleet.pid("a", "mode-adapter"), "router a": fleet.pid("a", "router"),
                                     "router b": fleet.pid("b", "router"), "adapter b": fleet.pid("b", "mode-adapter")})

    def all(self):
        return [self.floor(), self.bare(), *(self.road(name) for name in self.fleets)]
