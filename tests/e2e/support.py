"""What the end-to-end tests share: a fleet of their own, taken down completely, and how to kill its parts."""
import atexit
import fcntl
import json
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest

REPO = pathlib.Path(__file__).resolve().parent.parent.parent
sys.path[:0] = [str(REPO / "scripts"), str(REPO / "tests" / "support")]
import trb_fleet  # noqa: E402
from skips import main  # noqa: E402, F401

PROGRAMS = pathlib.Path(os.environ.get("TRB_PROGRAMS", REPO / "build" / "dev" / "bin"))
CLOUD = trb_fleet.CLOUD
PAPER = REPO / "config" / "scenarios" / "paper-nine-tasks.json"
QUICK_S = float(os.environ.get("TRB_QUICK_S", "1.0"))  # what a person waits for a message's effect
TRIES = 3  # other load may delay one try, but not the fastest of three
HEAL_S = 5.0  # what a fleet may take to heal from the death of one process
LONG_S = 60.0  # where no figure applies: a deadline, not a measurement


def take_block(wanted):
    """Two numbers of 127.0.x that no other test on this machine uses: `wanted`, or else the next free ones."""
    blocks = list(range(60, 100, 2))
    at = blocks.index(wanted)
    for block in blocks[at:] + blocks[:at]:
        lock = open(pathlib.Path(tempfile.gettempdir()) / f"trb-e2e-{os.getuid()}-{block}.lock", "w")
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            lock.close()
            continue
        atexit.register(lock.close)
        return block
    raise RuntimeError("every address block is in use")


def temporary_folder():
    root = tempfile.mkdtemp(prefix="trb-e2e-")
    atexit.register(shutil.rmtree, root, ignore_errors=True)
    return pathlib.Path(root)


def processes(*marks):
    """pid -> command line of every process that has one of the marks in its command line."""
    found = {}
    for path in pathlib.Path("/proc").glob("[0-9]*/cmdline"):
        try:
            line = path.read_bytes().replace(b"\0", b" ").decode(errors="replace")
        except OSError:
            continue
        if int(path.parent.name) != os.getpid() and any(str(mark) in line for mark in marks):
            found[int(path.parent.name)] = line
    return found


def processes_of(root, block):
    return processes(f"{root}/", f" 127.0.{block}.", f" 127.0.{block + 1}.")


def wait_until(what, condition, timeout=LONG_S):
    """Waits for a condition that needs no fleet; returns its value."""
    end = time.monotonic() + timeout
    while True:
        value = condition()
        if value:
            return value
        if time.monotonic() > end:
            raise TimeoutError(f"{what}: not within {timeout} s")
        time.sleep(0.02)


class FleetTest(unittest.TestCase):
    """A class of tests that share a fleet. Each finds it whole: all nodes up, all robots connected, none fenced."""

    BLOCK = 60
    ROBOTS = dict(trb_fleet.ROBOTS)
    SPEED = 1.0
    FLEET = trb_fleet.Fleet

    @classmethod
    def setUpClass(cls):
        cls.block = take_block(cls.BLOCK)
        cls.root = temporary_folder()
        cls.fleet = cls.FLEET(cls.root / "fleet", PROGRAMS, block=cls.block, udp_port=50000 + cls.block,
                                    robots=cls.ROBOTS, speed=cls.SPEED, name="e2e")
        cls.addClassCleanup(cls.take_down)
        cls.fleet.make()
        cls.fleet.start()
        cls.fleet.wait_formed(LONG_S)

    @classmethod
    def take_down(cls):
        for pid in processes_of(cls.root, cls.block):
            send_signal(pid, signal.SIGCONT)  # a process that a failed test left stopped could not be ended
        cls.fleet.stop()
        left = processes_of(cls.root, cls.block)
        for pid in left:
            send_signal(pid, signal.SIGKILL)
        if left:
            raise AssertionError(f"processes were left: {left}")

    def setUp(self):
        """Repairs what a failed test has left, so that it does not fail the next one."""
        robots = [robot for robot in self.fleet.robots if robot not in self.fleet.virtual]
        nodes = [node for node in self.fleet.node_names if node not in self.fleet.nodes]
        for robot in robots:
            self.fleet.start_robot(robot)
        for node in nodes:
            self.start_node(node)
        self.fleet.wait_formed(LONG_S)  # who was restarted in the test before may not be heard by all yet

    def run(self, result=None):
        before = 0 if result is None else len(result.failures) + len(result.errors)
        out = super().run(result)
        if result is not None and len(result.failures) + len(result.errors) > before:
            self.show_logs()
        return out

    def show_logs(self):
        """The services' last lines: the only source to find out why a test failed."""
        logs = [*self.root.glob("fleet/nodes/*/log/*.log"), *self.root.glob("fleet/up-*.log")]
        for path in sorted(logs):
            lines = path.read_text(errors="replace").splitlines()[-8:]
            print(f"-- {path.relative_to(self.root)}", *lines, sep="\n   ", file=sys.stderr)
        for node, robot in self.fleet.virtual.items():
            print(f"-- robot {node}: {robot.lines[-12:]}", file=sys.stderr)
        for node, up in self.fleet.nodes.items():
            print(f"-- trb up {node}: {up.lines[-8:]}", file=sys.stderr)

    # ---- requests

    def ask(self, *arguments, node=CLOUD):
        """(exit status, the JSON that was printed)"""
        done = self.fleet.trb(*arguments, "--json", node=node, check=False)
        self.fleet.pump()
        self.assertTrue(done.stdout.strip(), f"{arguments}: said nothing; {done.stderr}")
        return done.returncode, json.loads(done.stdout.splitlines()[-1])

    def refusal(self, *arguments, node=CLOUD):
        """The error of a command that must fail; each has a cure."""
        status, answer = self.ask(*arguments, node=node)
        self.assertEqual(status, 1, answer)
        self.assertIn("error", answer)
        self.assertTrue(answer["error"]["what"] and answer["error"]["cure"], answer)
        return answer["error"]

    def submit(self, scenario, node=CLOUD):
        return self.fleet.json("scenario", "run", self.scenario_file(scenario), node=node)["run"]

    def scenario_file(self, scenario):
        if isinstance(scenario, pathlib.Path):
            return scenario
        path = self.root / "scenario.json"
        path.write_text(json.dumps(scenario))
        return path

    def view(self, run, node=CLOUD):
        status, answer = self.ask("scenario", "watch", run, "--once", node=node)
        return answer if "tasks" in answer else {"state": "", "tasks": [], "waits_for": "", "status": status}

    def wait_state(self, run, *states, node=CLOUD, timeout=LONG_S):
        """Waits for one of the states; returns the view."""
        seen = {}

        def there():
            seen.update(self.view(run, node))
            return seen["state"] in states

        try:
            self.fleet.wait(f"the run is {states}", there, timeout)
        except TimeoutError as problem:
            raise AssertionError(f"{problem}; it is {json.dumps(seen)}") from None
        return seen

    def wait_task(self, run, task, *states, node=CLOUD):
        def there():
            return any(t["id"] == task and t["state"] in states for t in self.view(run, node)["tasks"])

        self.fleet.wait(f"task {task} is {states}", there, LONG_S)

    def works(self, robot, node=CLOUD, tries=1):
        """True if a message to the robot is answered: by the robot, or by its controller."""
        def once():
            return self.fleet.trb("request", robot, "position", "--timeout", "1", node=node, check=False).returncode == 0
        return any(once() for _ in range(tries))

    def abort_run(self, run, *more):
        """Once every member has confirmed it."""
        return self.fleet.trb("scenario", "abort", run, "--timeout", LONG_S, *more, node=CLOUD, timeout=2 * LONG_S)

    def robot_state(self, robot, node=CLOUD):
        routes = self.fleet.json("route", "list", node=node)["routes"]
        return next((r["profile"]["robot"] for r in routes if r["id"] == robot and r["state"] == "ONLINE"), "no node")

    def is_fenced(self, robot, node=CLOUD):
        routes = self.fleet.json("route", "list", node=node)["routes"]
        return next(r["profile"]["fenced"] for r in routes if r["id"] == robot)

    # ---- the virtual robots' output

    def mark(self):
        """The present end of every virtual robot's output."""
        self.fleet.pump()
        return {node: (robot, len(robot.lines)) for node, robot in self.fleet.virtual.items()}

    def lines_since(self, mark, node):
        """A virtual robot's output since the mark; all of it if it was started since."""
        self.fleet.pump()
        robot, at = mark[node]
        return self.fleet.virtual[node].lines[at if robot is self.fleet.virtual[node] else 0:]

    def wait_robot(self, mark, node, wanted, timeout=LONG_S):
        robot, at = mark[node]
        now = self.fleet.virtual[node]
        now.wait_line(wanted, timeout, at if robot is now else 0)

    def commanded(self, mark, node):
        """The skills (or a UR's programs) that a robot was ordered to begin since."""
        out = []
        for line in self.lines_since(mark, node):
            words = line.split()
            if words[0] == "start":
                out.append(words[1])
            elif words[0] == "program" and words[2] == "started":
                out.append("program")
        return out

    # ---- killing

    def kill_service(self, node, service):
        """kill -9; returns the pid that was."""
        pid = self.fleet.pid(node, service)
        self.assertIsNotNone(pid, f"{service} of {node} does not run")
        os.kill(pid, signal.SIGKILL)
        return pid

    def is_back(self, node, service, old):
        pid = self.fleet.pid(node, service)
        if pid in (None, old):
            return False
        done = self.fleet.trb("service", "list", "--json", node=node, check=False)
        if done.returncode != 0:
            return False
        return all(s["state"] == "up" for s in json.loads(done.stdout)["services"])

    def wait_back(self, node, service, old):
        self.fleet.wait(f"{service} of {node} is back", lambda: self.is_back(node, service, old), LONG_S)

    def kill_node(self, node):
        """kill -9 of a whole node, as if its power failed. The supervisor is stopped first: no restart."""
        up = self.fleet.nodes.pop(node)
        os.kill(up.child.pid, signal.SIGSTOP)
        pids = descendants(up.child.pid)
        for pid in pids:
            send_signal(pid, signal.SIGKILL)
        up.stop(signal.SIGKILL)
        # Only then are its ports free for an immediate restart.
        wait_until(f"the processes of {node} end", lambda: not any(map(is_alive, pids)))

    def start_node(self, node, timeout=LONG_S):
        self.fleet.start_node(node)
        self.fleet.nodes[node].wait_line("ready", timeout)

    def kill_robot(self, node):
        self.fleet.virtual.pop(node).stop(signal.SIGKILL)

    def pause_robot(self, node):
        pid = self.fleet.virtual[node].child.pid
        os.kill(pid, signal.SIGSTOP)
        self.addCleanup(send_signal, pid, signal.SIGCONT)
        return pid

    def pause_service(self, node, service):
        pid = self.fleet.pid(node, service)
        os.kill(pid, signal.SIGSTOP)
        self.addCleanup(send_signal, pid, signal.SIGCONT)
        return pid


class Demonstration:
    """For a test case: scripts/demo_fleet.py in a folder and an address block of the test's own; ended completely."""

    def make_demonstration(self, block, *options):
        self.block, self.options = block, options
        self.folder = temporary_folder()
        self.root = self.folder / "demo"
        self.addCleanup(self.end_all)

    def end_all(self):
        for pid in self.left():
            send_signal(pid, signal.SIGKILL)

    def left(self):
        return processes_of(self.root, self.block)

    def start(self, *arguments):
        command = [sys.executable, REPO / "scripts" / "demo_fleet.py", "--programs", PROGRAMS, "--root", self.root,
                   "--block", self.block, "--udp-port", 50000 + self.block, *self.options, *arguments]
        child = subprocess.Popen([str(word) for word in command], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                                 stderr=subprocess.STDOUT, text=True, start_new_session=True)
        self.addCleanup(child.stdout.close)
        self.addCleanup(lambda: child.poll() is None and child.kill())
        return child

    def read_until(self, child, wanted):
        """The script's output up to a line; ctest's time limit is the deadline."""
        seen = []
        for line in child.stdout:
            seen.append(line)
            if wanted in line:
                return "".join(seen)
        self.fail(f"the demonstration ended without {wanted!r}:\n" + "".join(seen))


def send_signal(pid, number):
    try:
        os.kill(pid, number)
    except ProcessLookupError:
        pass


def descendants(ancestor):
    """All processes that it has started, and those that these have."""
    of = {}
    for path in pathlib.Path("/proc").glob("[0-9]*/stat"):
        try:
            of.setdefault(int(path.read_text().rsplit(")", 1)[1].split()[1]), []).append(int(path.parent.name))
        except OSError:
            continue
    out = list(of.get(ancestor, []))
    for pid in out:
        out += of.get(pid, [])
    return out


def is_alive(pid):
    """A zombie that was not reaped holds nothing any more, once all its threads have ended."""
    def state(path):
        try:
            return path.read_text().rsplit(")", 1)[1].split()[0]
        except (FileNotFoundError, ProcessLookupError):
            return "X"

    return any(state(path) not in "ZX" for path in pathlib.Path(f"/proc/{pid}/task").glob("*/stat"))


def tell(text):
    print(text, file=sys.stderr, flush=True)
