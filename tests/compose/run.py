"""scripts/test-compose [images|one|demo ...] [--rounds N] [--speed N] [--json FILE]

The images of deploy/compose/Dockerfile and its two compositions, on a Docker engine of the test's own. Needs root.
"""
import argparse
import contextlib
import itertools
import json
import os
import pathlib
import pwd
import shutil
import ssl
import statistics
import subprocess
import sys
import tempfile
import threading
import time
import urllib.request

HERE = pathlib.Path(__file__).resolve().parent
REPO = HERE.parents[1]
sys.path[:0] = [str(HERE), str(REPO / "scripts"), str(HERE.parent / "support")]
import skips  # noqa: E402
import trb_fleet  # noqa: E402
import private_bus  # noqa: E402
from engine import COMPOSE, DOCKER, Composition, Engine  # noqa: E402
from trb_process import wait_until  # noqa: E402

DEPLOY = REPO / "deploy" / "compose"
IMAGES = ("node", "cloud", "robots", "ros")
MOST_MB = 120  # of an image without ROS
LONG_S = 120  # a deadline, not a measurement
LEASE_S = 10
PAPER = REPO / "config/scenarios/paper-nine-tasks.json"
ENDED = ("FINISHED", "FAILED", "ABORTED", "EXPIRED")
PICK = {"name": "pick", "tasks": [{"id": "pick", "robot": "ur3", "skill": "pick", "data": {"side": "left"}}]}
ROBOTS = list(trb_fleet.DEMO_ROBOTS)
SERVICES = ("router", "scheduler", "mode-adapter", "sensor-bus")  # of `one`, a container and a user each
# A D-Bus lets in only users that its machine knows: here one that every Debian has plays the user of the sensor-bus.
SENSOR_USER = "games"
OWNS_NAMES = f'<policy user="{SENSOR_USER}"><allow own_prefix="trbots"/></policy>'
WARM = ["--type=signal", "/trbots/temperature", "trbots.temperature.value", "double:21.5", "string:degC"]
ON_ROS = [name for name, (kind, *_) in trb_fleet.DEMO_ROBOTS.items() if kind in trb_fleet.ROS]


class Report:
    def __init__(self):
        self.faults, self.notes, self.times = [], {}, []

    def say(self, text):
        print(text, flush=True)

    def check(self, holds, text):
        if not holds:
            self.faults.append(text)
            self.say(f"FAULT {text}")
        return holds


def until(condition, timeout=LONG_S, step=0.3):
    """Seconds until it held; None: it has not in time."""
    return wait_until(condition, timeout, step)


# ---- the images

def base_image(engine):
    """A registry's, or else one from Debian's archive."""
    own = "talkrobots-debian:12"
    if engine.docker("image", "inspect", own, check=False).returncode == 0:
        return own
    if engine.docker("pull", "debian:12-slim", check=False, timeout=300).returncode == 0:
        return "debian:12-slim"
    subprocess.run([DEPLOY / "make-base", own], check=True, stdout=subprocess.DEVNULL, env=engine.env())
    return own


def programs_image(engine, tree):
    """An install tree as an image, for PROGRAMS of the Dockerfile."""
    with tempfile.TemporaryDirectory() as folder:
        os.symlink(pathlib.Path(tree).resolve(), f"{folder}/out")
        tar = subprocess.Popen(["tar", "-C", folder, "--dereference", "-c", "out"], stdout=subprocess.PIPE)
        subprocess.run([DOCKER, "import", "-", "talkrobots-programs"], stdin=tar.stdout, check=True, stdout=subprocess.DEVNULL,
                       env=engine.env())
        if tar.wait() != 0:
            raise RuntimeError(f"{tree}: tar failed")
    return "talkrobots-programs"


def build_images(engine, report):
    began = time.monotonic()
    arguments = {"BASE": base_image(engine)}
    if tree := os.environ.get("TRB_PROGRAMS"):
        arguments["PROGRAMS"] = programs_image(engine, tree)
    for image in IMAGES:
        engine.build(image, arguments, REPO)
        facts = engine.inspect(f"talkrobots-{image}")
        size = facts["Size"] / 1e6
        report.notes[f"{image}_mb"] = round(size, 1)
        report.check(size <= MOST_MB or image == "ros", f"the image {image} has {size:.0f} MB, over {MOST_MB}")
        report.check(facts["Config"]["User"].split(":")[0] not in ("", "0", "root"), f"the image {image} runs as root")
    report.say("images: " + ", ".join(f"{image} {report.notes[f'{image}_mb']} MB" for image in IMAGES)
               + f", {time.monotonic() - began:.0f} s")


# ---- what holds of each container

def check_rights(report, composition):
    """By the kernel's word on its first process: no root, no capability, nothing more to gain, a root that is not written to."""
    for service in composition.names:
        proc = pathlib.Path(f"/proc/{composition.pid(service)}")
        status = dict(line.split(":\t", 1) for line in (proc / "status").read_text().splitlines() if ":\t" in line)
        report.check(status["Uid"].split()[0] != "0", f"{service} runs as root")
        for kind in ("CapEff", "CapPrm", "CapBnd", "CapInh", "CapAmb"):
            report.check(int(status[kind], 16) == 0, f"{service} has capabilities: {kind} {status[kind]}")
        report.check(status["NoNewPrivs"] == "1", f"{service} may gain rights")
        root = next(line.split() for line in (proc / "mountinfo").read_text().splitlines() if line.split()[4] == "/")
        report.check("ro" in root[5].split(","), f"{service}'s root can be written to: {root[5]}")


def check_keys(report, composition, root):
    """Each service of `one` has its own key and no other; the node's keys are the router's."""
    for service in SERVICES:
        inside = pathlib.Path(f"/proc/{composition.pid(service)}/root/node/keys")
        found = sorted(str(path.relative_to(inside)) for path in inside.rglob("*.key"))
        want = ["bus/probe.key", "bus/router.key", "identity.key", "link.key"] if service == "router" else [f"bus/{service}.key"]
        report.check(found == want, f"{service} has the keys {found}, not {want}")
        folder = root / "services" / service
        owner = folder.stat().st_uid
        for other in {64100, 64101, 64102, 64103, pwd.getpwnam(SENSOR_USER).pw_uid} - {owner}:
            done = subprocess.run(["setpriv", "--reuid", str(other), "--regid", "64100", "--clear-groups", "cat",
                                   folder / "keys/bus" / f"{service}.key"], capture_output=True)
            report.check(done.returncode != 0, f"user {other} reads the key of {service}")
    report.check(len({(root / "services" / s).stat().st_uid for s in SERVICES}) == len(SERVICES), "two services have one user")


def health(composition, service):
    return composition.engine.inspect(composition.names[service])["State"].get("Health", {}).get("Status", "")


# ---- runs

def submit(composition, service, scenario, folder):
    """The scenario's file goes by the node's own folder: the images have no shell to write it with."""
    text = scenario.read_text() if isinstance(scenario, pathlib.Path) else json.dumps(scenario)
    path = folder / "scenario.json"
    path.write_text(text)
    path.chmod(0o644)
    answer = composition.json(service, "scenario", "run", "/node/scenario.json")
    if "run" not in answer:
        raise RuntimeError(f"scenario run at {service}: {answer}")
    return answer["run"]


def view_of(composition, service, run):
    answer = composition.json(service, "scenario", "watch", run, "--once")
    return answer if "tasks" in answer else {"state": "", "tasks": [], "waits_for": ""}


def wait_ended(report, composition, service, run, tasks, what):
    seen = {}

    def ended():
        seen.update(view_of(composition, service, run))
        return seen["state"] in ENDED
    took = until(ended, 240, 1)
    states = {task["id"]: task["state"] for task in seen.get("tasks", [])}
    good = report.check(took is not None and seen["state"] == "FINISHED", f"{what}: the run is {seen.get('state')}, {states}, {seen.get('waits_for')}")
    if tasks:
        report.check(not good or list(states.values()) == ["FINISHED"] * tasks, f"{what}: {states}")
    return took


# ---- one node, a container for each service

def one_ready(composition):
    services = {s["service"]: s["state"] for s in composition.json("router", "service", "list").get("services", [])}
    robots = composition.json("router", "route", "list").get("routes", [])
    return list(services.values()).count("up") == len(SERVICES) and any(row["profile"]["robot"] == "ONLINE" for row in robots)


def check_health(report, composition):
    """By each container's own doctor: well; a service that hangs is ill, and well again."""
    for service in SERVICES:
        well = until(lambda: health(composition, service) == "healthy")
        report.check(well is not None, f"one: {service}'s container is {health(composition, service)}")
    composition.kill("scheduler", "STOP")
    report.check(until(lambda: health(composition, "scheduler") == "unhealthy") is not None, "one: a scheduler that hangs is not seen to be ill")
    report.check(health(composition, "mode-adapter") == "healthy", "one: a scheduler that hangs makes the mode-adapter ill")
    composition.kill("scheduler", "CONT")
    report.check(until(lambda: health(composition, "scheduler") == "healthy") is not None, "one: a scheduler that goes on is not well again")


def check_visitor(report, composition):
    """A service's key shows its doctor how it is; it opens nothing to trb."""
    shown = composition.engine.docker("exec", composition.names["scheduler"], "/usr/bin/trb", "doctor", "--service", "scheduler",
                                      "--node", "/node").stdout
    report.check("scheduler is up" in shown, f"one: the scheduler's doctor says: {shown}")
    for words in (("route", "list"), ("stop", "ur3"), ("doctor", "--service", "router")):
        done = composition.trb("scheduler", *words, check=False)
        report.check(done.returncode != 0, f"one: with the scheduler's key alone, trb {' '.join(words)} works: {done.stdout}")


def check_sensor(report, composition, bus):
    """What a program of the host feeds the D-Bus comes by the container's sensor-bus, which owns its name there."""
    with feeding(bus):
        read = until(lambda: "21.5" in composition.trb("router", "sensor", "read", "temperature", check=False).stdout, 30)
    shown = composition.trb("router", "sensor", "list", "--unknown", check=False).stdout
    report.check(read is not None, f"one: the host's thermometer is not read: {shown}")
    report.check("does not let" not in shown and "gone" not in shown, f"one: the sensor-bus is not well on its D-Bus: {shown}")


@contextlib.contextmanager
def feeding(bus):
    """A thermometer of the host: a value every 0.3 s."""
    end = threading.Event()

    def feed():
        while not end.wait(0.3):
            subprocess.run(["/usr/bin/dbus-send", f"--bus={bus.address}", *WARM], check=False)
    thread = threading.Thread(target=feed, daemon=True)
    thread.start()
    try:
        yield
    finally:
        end.set()
        thread.join()


def host_bus(folder):
    """The host's system bus, as the sensor-bus's container finds it."""
    folder.mkdir(mode=0o755)
    return private_bus.PrivateBus(folder, "system_bus_socket", OWNS_NAMES)


def one(engine, report, root, arguments):
    uid = str(pwd.getpwnam(SENSOR_USER).pw_uid)
    make_nodes(engine, "one", root, TRB_UID_SENSOR_BUS=uid)
    bus, udev = host_bus(root / "dbus"), root / "udev"
    udev.mkdir(mode=0o755)
    bus.start()
    try:
        with Composition(engine, DEPLOY / "docker-compose.one.yml", "trb-one", TRB_NODES=str(root), TRB_SPEED=str(arguments.speed),
                         TRB_DBUS=str(root / "dbus"), TRB_UDEV=str(udev), TRB_UID_SENSOR_BUS=uid) as node:
            play_one(report, node, bus, root, arguments)
    finally:
        bus.stop()
    report.say(f"one: {arguments.rounds} times docker kill, the bus cut and back, down: nothing left")


def play_one(report, node, bus, root, arguments):
    folder = root / "services/router"
    report.check(until(lambda: one_ready(node)) is not None, f"one: not ready: {node.trb('router', 'service', 'list', check=False).stdout}")
    check_rights(report, node)
    check_keys(report, node, root)
    check_health(report, node)
    check_visitor(report, node)
    check_sensor(report, node, bus)
    wait_ended(report, node, "router", submit(node, "router", PICK, folder), 1, "one")
    report.say("one: a container for each service, each with its own key alone, and well; a sensor read; a run FINISHED")
    for number, service in zip(range(arguments.rounds), itertools.cycle((*SERVICES, "robot"))):
        round_of(report, node, service, lambda: one_ready(node), lambda: not one_ready(node), f"one, round {number + 1}")
        if service == "robot" or number + 1 == arguments.rounds:
            wait_ended(report, node, "router", submit(node, "router", PICK, folder), 1, f"one, after round {number + 1}")
    address = node.cut("mode-adapter", "bus")
    report.check(until(lambda: not one_ready(node), 30) is not None, "one: a mode-adapter without its bus is not missed")
    node.mend("mode-adapter", "bus", address)
    report.check(until(lambda: one_ready(node)) is not None, "one: the mode-adapter does not come back to its bus")
    wait_ended(report, node, "router", submit(node, "router", PICK, folder), 1, "one, after the bus was cut")
    left = node.down()
    report.check(not left, f"one: docker-compose down leaves {left}")


def round_of(report, composition, service, is_whole, is_missed, what):
    """docker kill; what is gone is missed; docker start; everything is there again."""
    composition.kill(service)
    until(is_missed, 15)
    began = time.monotonic()
    composition.start(service)
    took = until(is_whole)
    report.times.append(time.monotonic() - began)
    report.check(took is not None, f"{what}: not whole {LONG_S} s after {service} was killed and started")


# ---- the demonstration

def routes_of(composition):
    return {row["id"]: row for row in composition.json("cloud", "route", "list").get("routes", [])}


def route_of(composition, node):
    """The cloud's row of that node; {} if it has none, or does not answer in time."""
    return routes_of(composition).get(node, {})


def formed(composition, boots=None):
    """Everybody is there, with a robot; the nodes of `boots` with a later start than that."""
    routes = routes_of(composition)
    nodes = all(routes.get(name, {}).get("state") in ("self", "ONLINE") for name in (*ROBOTS, "cloud"))
    robots = nodes and all(routes[name]["profile"].get("robot") == "ONLINE" for name in ROBOTS)
    return robots and all(routes[name]["boot"] > boot for name, boot in (boots or {}).items())


def page_answers(port):
    try:
        context = ssl._create_unverified_context()  # its certificate is its own
        with urllib.request.urlopen(f"https://127.0.0.1:{port}/api/v1/ready", timeout=5, context=context) as answer:
            return answer.status == 200
    except OSError:
        return False


def demo(engine, report, root, arguments):
    make_nodes(engine, "demo", root)
    port = trb_fleet.free_port()
    env = {"TRB_NODES": str(root), "TRB_SPEED": str(arguments.speed), "TRB_PAGE": str(port)}
    began = time.monotonic()
    with Composition(engine, DEPLOY / "docker-compose.demo.yml", "trb-demo", **env) as fleet:
        whole = report.check(until(lambda: formed(fleet)) is not None, f"demo: not formed: {short(routes_of(fleet))}")
        report.notes["demo_formed_s"] = round(time.monotonic() - began, 1)
        report.check(until(lambda: page_answers(port)) is not None, "demo: the page does not answer")
        check_rights(report, fleet)
        report.say(f"demo: {len(fleet.names)} containers, ten nodes formed in {report.notes['demo_formed_s']} s, the page answers")
        if not whole:
            return
        nine_tasks(report, fleet, root, "demo")
        ill = {name: until(lambda n=name: health(fleet, n) == "healthy", 90) for name in (*ROBOTS, "cloud")}
        report.check(None not in ill.values(), f"demo: not healthy: {[n for n, took in ill.items() if took is None]}")
        kills(report, fleet, root, arguments.rounds)
        cuts(report, fleet, root)
        left = fleet.down()
        report.check(not left, f"demo: docker-compose down leaves {left}")
    report.say("demo: down: nothing left")


def short(routes):
    return {name: f"{row['state']}/{row['profile'].get('robot', '')}" for name, row in routes.items()}


def nine_tasks(report, fleet, root, what, at="cloud", under=None):
    run = submit(fleet, at, PAPER, root / "nodes" / at)
    if under:
        under()
    # A member has its part of a run that is over, the cloud all of it.
    took = wait_ended(report, fleet, at, run, 9 if at == "cloud" else 0, what)
    if at != "cloud":
        whole = until(lambda: [t["state"] for t in view_of(fleet, "cloud", run)["tasks"]] == ["FINISHED"] * 9, 60, 1)
        report.check(whole is not None, f"{what}: the cloud has {view_of(fleet, 'cloud', run)}")
    if took is not None:
        report.say(f"{what}: nine tasks FINISHED, {took:.0f} s")


def kills(report, fleet, root, rounds):
    """Each container in turn; after each lap a run, the first of them with the cloud killed under it."""
    order = [*ROBOTS, *(f"robot-{name}" for name in ROBOTS), "on-board-pioneer2", "ros-master", "cloud"]
    report.check(sorted(order) == sorted(fleet.names), f"the containers are {sorted(fleet.names)}")
    for number, service in zip(range(1, rounds + 1), itertools.cycle(order)):
        kill_one(report, fleet, root, service, f"demo, round {number}")
        if number % 10 == 0:
            report.say(f"demo: round {number} of {rounds}; so far {statistics.median(report.times):.1f} s median, {max(report.times):.1f} s at most")
        if number % len(order) == 0 or number == rounds:
            nine_tasks(report, fleet, root, f"demo, after round {number}")
    nine_tasks(report, fleet, root, "demo, the cloud killed under the run", "ridgeback", lambda: (fleet.kill("cloud"), fleet.start("cloud")))
    report.check(until(lambda: formed(fleet)) is not None, f"demo: not formed after the cloud's end: {short(routes_of(fleet))}")


def workers_of(root, node):
    """How often its bridge to ROS has begun anew."""
    return (root / "nodes" / node / "log" / "ros-bridge.log").read_text(errors="replace").count("worker_started")


def boot_of(fleet, node):
    """{node: the number of its start}; a machine that is busy may take more than one question."""
    told = {}

    def tells():
        told.update(route_of(fleet, node))
        return "boot" in told
    if until(tells) is None:
        raise TimeoutError(f"the cloud does not say which start of {node} it knows")
    return {node: told["boot"]}


def kill_one(report, fleet, root, service, what):
    boots = boot_of(fleet, service) if service in (*ROBOTS, "cloud") else {}
    robot = service.removeprefix("robot-").removeprefix("on-board-")
    workers = {name: workers_of(root, name) for name in ON_ROS}

    def missed():
        row = route_of(fleet, robot)
        return boots or service == "ros-master" or (row and row["profile"].get("robot") != "ONLINE")

    def whole():
        return formed(fleet, boots)
    round_of(report, fleet, service, whole, missed, what)
    if service == "ros-master":  # it has forgotten who is there, and ROS' own programs do not tell it again
        anew = until(lambda: all(workers_of(root, name) > count for name, count in workers.items()), 40)
        report.check(anew is not None, f"{what}: the bridges to ROS do not see that the master is a new one")
        for name in ON_ROS:
            fleet.engine.docker("restart", "-t", "8", fleet.names[f"robot-{name}"])
        report.check(until(whole) is not None, f"{what}: not whole after the ROS robots were started again")


def cuts(report, fleet, root):
    """A node loses the hall: the cloud carries. It loses both networks under a run: the run waits, and goes on."""
    address = fleet.cut("ur3", "hall")
    by_cloud = until(lambda: any(row["id"] == "ur3" and row.get("via") == "cloud" for row in fleet.json("ridgeback", "route", "list").get("routes", [])), 60)
    report.check(by_cloud is not None, "demo: without the hall's network ur3 is not reached by the cloud")
    nine_tasks(report, fleet, root, "demo, ur3 without the hall's network")
    fleet.mend("ur3", "hall", address)
    report.check(until(lambda: formed(fleet)) is not None, "demo: ur3 does not come back to the hall")

    def under():
        addresses = {network: fleet.cut("ur3", network) for network in ("hall", "way")}
        report.check(until(lambda: route_of(fleet, "ur3").get("state") == "OFFLINE", 40) is not None, f"demo: a cut of ur3 is not seen: {route_of(fleet, 'ur3')}")
        for network, address in addresses.items():
            fleet.mend("ur3", network, address)
    nine_tasks(report, fleet, root, "demo, ur3 cut off under the run", under=under)
    report.check(until(lambda: formed(fleet)) is not None, "demo: not formed after the cut")


# ---- all of it

def make_nodes(engine, which, root, **env):
    done = subprocess.run([DEPLOY / "make-nodes", which, root], capture_output=True, text=True, env=engine.env(**env))
    if done.returncode != 0:
        raise RuntimeError(f"make-nodes {which}: {done.stderr[-600:]}")


def what_is_missing():
    if os.geteuid() != 0:
        return "needs root, for a Docker engine of its own"
    # Without rules of iptables the host would forward from network to network, and nothing that is cut would be cut.
    if pathlib.Path("/proc/sys/net/ipv4/ip_forward").read_text().strip() != "0":
        return "needs a host that does not forward: sysctl net.ipv4.ip_forward=0"
    for program in ("dockerd", DOCKER, COMPOSE, "ip", "setpriv"):
        if shutil.which(program) is None:
            return f"needs the program {program}: apt-get install docker.io docker-compose"
    return None


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("parts", nargs="*", choices=[[], "images", "one", "demo"], metavar="images|one|demo")
    parser.add_argument("--rounds", type=int, default=22, help="docker kill of a container (22: each once)")
    parser.add_argument("--speed", type=float, default=4.0)
    parser.add_argument("--json", type=pathlib.Path)
    parser.add_argument("--data", type=pathlib.Path, default=REPO / "build/docker")
    arguments = parser.parse_args()
    if missing := what_is_missing():
        skips.leave(f"scripts/test-compose {missing}")
    report, began = Report(), time.monotonic()
    with tempfile.TemporaryDirectory(prefix="trb-compose-") as folder, Engine(arguments.data) as engine:
        build_images(engine, report)
        for part, function in (("one", one), ("demo", demo)):
            if arguments.parts and part not in arguments.parts:
                continue
            try:
                function(engine, report, pathlib.Path(folder) / part, arguments)
            except (RuntimeError, TimeoutError, KeyError, OSError, subprocess.SubprocessError) as problem:
                report.check(False, f"{part}: {type(problem).__name__}: {problem}")
    if report.times:
        report.notes.update(kills=len(report.times), whole_median_s=round(statistics.median(report.times), 1), whole_most_s=round(max(report.times), 1))
    print("  ".join(f"{key} = {value}" for key, value in report.notes.items()))
    for fault in report.faults:
        print(f"FAULT {fault}")
    print(f"{len(report.faults)} faults, {time.monotonic() - began:.0f} s")
    if arguments.json:
        arguments.json.write_text(json.dumps({**report.notes, "faults": report.faults}, indent=1) + "\n")
    return 1 if report.faults else 0


if __name__ == "__main__":
    trb_fleet.run_main(main, "scripts/test-compose")
