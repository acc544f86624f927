"""What the integration tests share: fleets in temporary folders, a node's log and counters read as differences."""
import functools
import json
import os
import pathlib
import socket
import sys
import tempfile
import time

REPO = pathlib.Path(__file__).resolve().parents[2]
sys.path[:0] = [str(REPO / "scripts"), str(REPO / "tests" / "support")]

import demo_place  # noqa: E402
import trb_fleet  # noqa: E402
from skips import main  # noqa: E402, F401

PROGRAMS = pathlib.Path(os.environ.get("TRB_BIN_DIR", REPO / "build" / "dev" / "bin"))


def is_sanitized():
    """Such programs take longer, and reserve more of addresses and memory than they use."""
    return any(name in (PROGRAMS / "trb-router").read_bytes() for name in (b"__asan_init", b"__tsan_init"))


_held = {}  # block: the socket that holds it, until this program ends


def hold_blocks(*blocks, seconds=300):
    """Waits until no other program has these addresses: two tests with one block would take each other's ports."""
    for block in blocks:
        deadline = time.monotonic() + seconds
        while block not in _held:
            held = demo_place.hold(block)
            if held:
                _held[block] = held
            elif not demo_place.wait_for_end(block, deadline - time.monotonic()):
                raise TimeoutError(f"127.0.{block}.x is held by {demo_place.in_words(demo_place.pid_of_holder(block))}")


def assert_quick(case, times, most):
    """But for the two slowest: a stall of the machine is one or two of them, what delays by itself delays more."""
    times = sorted(times)
    case.assertLess(times[-3:][0], most, times[-9:])
    case.assertLess(times[-1], 20, times[-9:])


def told_again(watch, most=3):
    """Of a test: it is told anew, at most so many times, if it fails and what watch(case) has returned before it says that a
    stall of the machine ended it, as it must."""
    def decorate(story):
        @functools.wraps(story)
        def told(case):
            for _ in range(most - 1):
                has_stalled = watch(case)
                try:
                    return story(case)
                except Exception:
                    if not has_stalled():
                        raise
                case.doCleanups()
                case.setUp()
            return story(case)
        return told
    return decorate


def adder_of(case):
    """How a test case or class is told what to do at its end."""
    return case.addClassCleanup if isinstance(case, type) else case.addCleanup


def temporary_folder(case):
    """It goes with the test case or class."""
    folder = tempfile.TemporaryDirectory(prefix="trb-", ignore_cleanup_errors=True)
    adder_of(case)(folder.cleanup)
    return pathlib.Path(folder.name)


def make_fleet(case, kind=trb_fleet.Fleet, programs=PROGRAMS, **arguments):
    """A fleet in a temporary folder; it ends, and the folder goes, with the test case or class."""
    fleet = kind(temporary_folder(case) / "fleet", programs, **arguments)
    fleet.patience_s = 30
    hold_blocks(fleet.block, fleet.block + 1)
    adder_of(case)(fleet.stop)
    fleet.make()
    return fleet


def beacon_listener(case, port, timeout_s):
    """A socket that hears every beacon of this machine's fleet, and may shout itself."""
    listener = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    case.addCleanup(listener.close)
    listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    listener.setsockopt(socket.SOL_SOCKET, socket.SO_BROADCAST, 1)
    listener.bind(("127.255.255.255", port))
    listener.settimeout(timeout_s)
    return listener


class RouterFleet(trb_fleet.Fleet):
    """Nodes without robots: all have the role cloud, each with the named services."""

    def __init__(self, root, programs, services, **more):
        super().__init__(root, programs, robots={}, cloud=False, **more)
        self.services_of = services
        self.node_names = list(services)

    def node_json(self, node):
        return {"id": node, "role": "cloud", "services": self.services_of[node]}

    def bring_up(self, *nodes):
        for node in nodes:
            self.start_node(node)
        for node in nodes:
            self.nodes[node].wait_line("ready", 60)


class Watch:
    """A node's refusals and router log since this object was made."""

    def __init__(self, fleet, node):
        self.fleet, self.node = fleet, node
        self.log_path = fleet.dir(node) / "log" / "router.log"
        self.start = self.log_path.stat().st_size
        self.before = self.counters()

    def counters(self):
        rows = self.fleet.json("service", "counters", "router", node=self.node)["values"]
        return {row["name"]: int(row["value"]) for row in rows}

    def rise(self, prefixes=("refused.", "beacon.")):
        """The counters of these names that have risen, and by how much."""
        now = self.counters()
        risen = {name: value - self.before.get(name, 0) for name, value in now.items() if name.startswith(prefixes)}
        return {name: value for name, value in risen.items() if value}

    def log(self):
        with open(self.log_path, "rb") as file:
            file.seek(self.start)
            return file.read().decode()

    def wait_counted(self, name, count=1, timeout=60, prefixes=("refused.", "beacon.")):
        self.fleet.wait(f"{name} >= {count}", lambda: self.rise(prefixes).get(name, 0) >= count, timeout)

    def wait_logged(self, text, timeout=60):
        self.fleet.wait(f"{text!r} in {self.log_path}", lambda: text in self.log(), timeout)


class Tap:
    """Everything that the node sends and receives from now on: after its first message it misses none."""

    def __init__(self, fleet, node):
        command = [PROGRAMS / "trb", "tap", "--all", "--json", "--node", fleet.dir(node)]
        self.fleet = fleet
        self.child = trb_fleet.Process(command, fleet.root / f"tap-{node}.log")
        fleet.listeners.append(self.child)
        self.child.wait_line("{", 60)
        self.start = 0

    def bodies(self, subtype):
        self.child.drain()
        messages = [json.loads(line) for line in self.child.lines[self.start:] if f'"subtype":"{subtype}"' in line]
        return [message["body"] for message in messages]

    def wait(self, subtype, what, found, timeout=60):
        self.fleet.wait(f"{subtype}: {what}", lambda: any(found(body) for body in self.bodies(subtype)), timeout)
        return next(body for body in self.bodies(subtype) if found(body))
