"""Which source files of ours are entered by a message from robot to robot, and by a baton from a scheduler to the next.

Real nodes, whose services run under valgrind's callgrind: it says of which files lines were executed, also those of inlined
functions. It writes that down at each turn of a service's loop, so that an event is a few turns. Each event is repeated, and a
file counts if it was entered every time: what a heartbeat or a timer did meanwhile drops out.

Counted twice: every file that is entered, and those of functions that an idle turn of the loop does not enter (each turn asks
every object for its next deadline, and ticks it).

A source and its header are one file. Headers whose source was not entered are counted apart: templates, and functions that
return a member.
"""
import argparse
import json
import os
import pathlib
import re
import shutil
import socket
import subprocess
import sys
import tempfile
import time

REPO = pathlib.Path(__file__).resolve().parents[3]
sys.path[:0] = [str(REPO / "scripts"), str(REPO / "tests/bench/road")]
import roads  # noqa: E402  (found only with the line above)
import trb_fleet  # noqa: E402

OURS = re.compile(r"(?:.*/)?\b((?:common|proto|services)/[\w/.-]+\.[ch]pp)$")
BATON = re.compile(r"::handle\(trb::Baton const&")
BEGUN = re.compile(r"::Executor::begin\(")
PATIENCE_S = 300  # callgrind makes a service some fifty times slower
TRIES, MESSAGE_S, IDLE_S = 10, 12, 8
NAMED = re.compile(r"\((\d+)\)(?: (.*))?$")


class Turn:
    """What was executed between two turns of a loop: (file, function), and the names of the functions."""

    def __init__(self, text, names):
        self.entered, self.functions = set(), set()
        file = function = None
        called = False
        for line in text.splitlines():
            key, _, value = line.partition("=")
            if key in ("fl", "fi", "fe", "fn", "cfn", "cfi", "cfl", "ob", "cob"):
                value = self.resolve(key, value, names)
                if key in ("fl", "fi", "fe"):
                    file = value
                elif key == "fn":
                    function = value
                    self.functions.add(value)
            elif key == "calls":
                called = True
            elif line[:1].isdigit() or line[:1] in "+-*":
                # The line behind "calls" is what the call cost: the callee's.
                if not called and (found := OURS.match(file or "")):
                    self.entered.add((found[1], function))
                called = False

    @staticmethod
    def resolve(key, value, names):
        """Callgrind gives a name once, with a number for it."""
        kind = "file" if key in ("fl", "fi", "fe", "cfi", "cfl") else "object" if key in ("ob", "cob") else "function"
        found = NAMED.match(value)
        if not found:
            return value
        if found[2]:
            names[kind, found[1]] = found[2]
        return names.get((kind, found[1]), "")


class Observed:
    """A service under callgrind. Its output is FOLDER/NAME.PID.out.N."""

    def __init__(self, folder, pid):
        self.folder, self.pid = folder, pid
        self.taken = set()

    def control(self, *words):
        subprocess.run(["callgrind_control", *words, str(self.pid)], check=True, stdout=subprocess.DEVNULL,
                       stderr=subprocess.PIPE, timeout=PATIENCE_S)

    def open(self):
        self.fresh_turns()
        self.control("-i", "on")

    def dump(self):
        """What comes from now on is a new turn."""
        self.control("--dump")
        self.fresh_turns()

    def close(self):
        """The turns since open(), or dump()."""
        self.control("--dump")
        self.control("-i", "off")
        return self.fresh_turns()

    def fresh_turns(self):
        out = []
        found = [path for path in self.folder.glob(f"*.{self.pid}.out.*") if path not in self.taken]
        for path in sorted(found, key=lambda path: int(path.suffix[1:])):
            self.taken.add(path)
            out.append(Turn(path.read_text(), {}))
        return out


def union(turns):
    return set().union(*(turn.entered for turn in turns))


def idle_turns(service):
    """What the loop's turns enter in which no message is read or written."""
    service.open()
    time.sleep(IDLE_S)  # measures a time, and waits for nothing
    return union(turn for turn in service.close() if not any(file.startswith("proto/") for file, _ in turn.entered))


def wrap(programs, folder, output, services, node):
    """A folder of programs in which those services run under callgrind, at that node (or any: "")."""
    folder.mkdir()
    for path in programs.iterdir():
        if path.name in services:
            wrapper = folder / path.name
            wrapper.write_text(f"""#!/bin/sh
case "$PWD $*" in *{node}*) ;; *) exec "{path}" "$@" ;; esac
echo $$ >>"{output}/{path.name}.pids"
exec valgrind --tool=callgrind --quiet --instr-atstart=no --dump-line=yes --compress-strings=no --compress-pos=no \\
  --dump-before='trb::Loop::turn*' --callgrind-out-file="{output}/{path.name}.%p.out" "{path}" "$@"
""")
            wrapper.chmod(0o755)
        elif path.is_file():
            shutil.copy2(path, folder)
    return folder


def own_pid(output, program, folder):
    """The pid of a node's service, by the node's folder."""
    for pid in (output / f"{program}.pids").read_text().split():
        try:
            if os.path.realpath(f"/proc/{pid}/cwd") == os.path.realpath(folder) or \
                    str(folder) in pathlib.Path(f"/proc/{pid}/cmdline").read_text():
                return int(pid)
        except OSError:
            continue
    raise RuntimeError(f"no {program} of {folder} was started")


class Robots:
    """The robots at both ends of the benchmark's road: a's writes the fields of a command, b's is commanded line by line."""

    def __init__(self, fleet):
        self.fleet = fleet
        self.listener = socket.create_server((fleet.robot_address("b"), roads.VENDOR_PORT))
        self.listener.settimeout(PATIENCE_S)
        self.sender = self.receiver = None

    def connect(self):
        self.receiver = self.listener.accept()[0]
        self.fleet.wait("the mode-adapter of a listens", self.dials, PATIENCE_S)

    def dials(self):
        try:
            self.sender = socket.create_connection((self.fleet.address("a"), 40000), PATIENCE_S,
                                                   source_address=(self.fleet.robot_address("a"), 0))
        except ConnectionRefusedError:
            return False
        return True

    def exchange(self, number):
        """True if the message arrived at the first try; a service that has just been slowed down may lose it."""
        for attempt in range(TRIES):
            wanted = f"{number * TRIES + attempt:048}"
            self.sender.sendall(f"command\nmove\nb\n48\n{wanted}\n".encode())
            if self.receives(wanted):
                return attempt == 0
        raise RuntimeError(f"no message arrived, in {TRIES} tries of {MESSAGE_S} s each")

    def receives(self, wanted):
        end = time.monotonic() + MESSAGE_S
        received = ""
        while wanted not in received and (left := end - time.monotonic()) > 0:
            self.receiver.settimeout(left)
            try:
                received += self.receiver.recv(4096).decode()
            except TimeoutError:
                break
        return wanted in received

    def close(self):
        for end in (self.sender, self.receiver, self.listener):
            if end:
                end.close()


def message(root, programs, output, rounds):
    """From the robot of node a to that of node b: {process: files}."""
    fleet = roads.Fleet(root / "fleet", programs, 64 + os.getpid() % 128)
    fleet.make()
    robots = Robots(fleet)
    with fleet:
        try:
            for node in fleet.node_names:
                fleet.start_node(node)
            robots.connect()
            fleet.wait_formed(PATIENCE_S)
            robots.exchange(0)
            return observe_message(fleet, robots, output, rounds)
        finally:
            robots.close()


def observe_message(fleet, robots, output, rounds):
    observed = {f"{service} {node}": Observed(output, own_pid(output, f"trb-{service}", fleet.dir(node)))
                for node, service in (("a", "mode-adapter"), ("a", "router"), ("b", "router"), ("b", "mode-adapter"))}
    seen, idle = {name: [] for name in observed}, {}
    for name, service in observed.items():
        for number in range(rounds):
            service.open()
            robots.exchange(0)  # what is executed for the first time takes long
            service.dump()
            while not robots.exchange(number):
                service.dump()
            seen[name].append(union(service.close()))
        idle[name] = idle_turns(service)
    return {name: (set.intersection(*entered), idle[name]) for name, entered in seen.items()}


SECOND = "pioneer2"
SCENARIO = {"name": "turns", "tasks": [
    {"id": f"task-{number}", "robot": f"pioneer{number % 2 + 1}", "skill": "go_to", "data": {"place": "dock"},
     **({"after": [f"task-{number - 1}"]} if number else {})} for number in range(4)]}


class OwnFleet(trb_fleet.Fleet):
    def __init__(self, *arguments, octet, **more):
        super().__init__(*arguments, **more)
        self.octet = octet

    def address(self, node):
        return f"127.{self.octet}.1.{self.number(node)}"

    def robot_address(self, node):
        return f"127.{self.octet}.2.{self.number(node)}"


def from_baton_to_start(turns):
    """Of the last baton that the scheduler received: the turn that brought it, and that in which its task began."""
    batons = [at for at, turn in enumerate(turns) if any(BATON.search(name) for name in turn.functions)]
    for first in reversed(batons):
        for last in range(first, len(turns)):
            if any(BEGUN.search(name) for name in turns[last].functions):
                return [turns[first], turns[last]]
    raise RuntimeError("no baton, or no task that began after one, at the second scheduler")


def baton(root, programs, output, rounds):
    """The second baton of a run, at the second robot's scheduler, which knows the run already: {process: files}."""
    octet = 64 + os.getpid() % 128
    path = root / "turns.json"
    path.write_text(json.dumps(SCENARIO))
    robots = {node: trb_fleet.ROBOTS[node] for node in ("pioneer1", SECOND)}
    fleet = OwnFleet(root / "fleet", programs, octet=octet, udp_port=50000 + octet, robots=robots, speed=20)
    fleet.make()
    with fleet:
        for node in robots:
            fleet.start_robot(node)
        for node in fleet.node_names:
            fleet.start_node(node)
        fleet.wait_formed(PATIENCE_S)
        scheduler = Observed(output, own_pid(output, "trb-scheduler", fleet.dir(SECOND)))
        seen = []
        for _ in range(rounds):
            scheduler.open()
            run = fleet.json("scenario", "run", path, node="cloud", timeout=PATIENCE_S)["run"]
            fleet.wait("it ends", lambda: fleet.json("run", "show", run, node="cloud")["state"] == "FINISHED", PATIENCE_S)
            seen.append(union(from_baton_to_start(scheduler.close())))
        idle = idle_turns(scheduler)
    return {"scheduler": (set.intersection(*seen), idle)}


def files_of(entered):
    return {file for file, _ in entered}


def split(files):
    """(sources without their endings, headers whose source is not among them)."""
    stems = {str(pathlib.PurePath(file).with_suffix("")) for file in files if file.endswith(".cpp")}
    headers = {str(pathlib.PurePath(file).with_suffix("")) for file in files if file.endswith(".hpp")} - stems
    return sorted(stems), sorted(headers)


def counted(files):
    sources, headers = split(files)
    services = sum(file.startswith("services/") for file in sources)
    return f"{services} files of services, {len(sources) - services} others, {len(headers)} headers"


def report(title, processes, with_names):
    """All that is entered, and what is left without the functions that an idle turn enters, too."""
    everything = set().union(*(files_of(entered) for entered, _ in processes.values()))
    by_itself = set().union(*(files_of(entered - idle) for entered, idle in processes.values()))
    print(f"{title}: {counted(everything)}; without what an idle turn enters: {counted(by_itself)}", flush=True)
    for process, (entered, idle) in processes.items():
        print(f"  {process}: {counted(files_of(entered))}; {counted(files_of(entered - idle))}")
    sources, headers = split(everything)
    own = set().union(*split(by_itself))
    if with_names:
        for file in [*sources, *(f"{header} (header)" for header in headers)]:
            print(f"    {'' if file.split()[0] in own else 'any turn: '}{file}")
    return {"what": title, "sources": sources, "headers": headers, "of_the_event": sorted(own)}


STORIES = {"message": ("a message from robot to robot", message, ("trb-router", "trb-mode-adapter"), ""),
           "baton": ("a baton, from its receipt to the start of its task", baton, ("trb-scheduler",), SECOND)}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--programs", required=True, type=pathlib.Path, help="built with -g1 or more")
    parser.add_argument("--only", choices=STORIES)
    parser.add_argument("--rounds", type=int, default=3, help="how often each event is repeated (3)")
    parser.add_argument("--list", action="store_true", help="name the files")
    parser.add_argument("--json", type=pathlib.Path, metavar="FILE")
    arguments = parser.parse_args()
    if not 1 <= arguments.rounds <= 100:
        parser.error("--rounds: 1 to 100")
    rows = []
    for name in [arguments.only] if arguments.only else STORIES:
        title, story, services, node = STORIES[name]
        with tempfile.TemporaryDirectory(prefix="trb-entered-", ignore_cleanup_errors=True) as folder:
            root = pathlib.Path(folder)
            output = root / "callgrind"
            output.mkdir()
            programs = wrap(arguments.programs.resolve(), root / "programs", output, services, node)
            rows.append(report(title, story(root, programs, output, arguments.rounds), arguments.list))
    if arguments.json:
        arguments.json.write_text(json.dumps(rows, indent=2) + "\n")


if __name__ == "__main__":
    main()
