"""The demonstration of ten nodes in containers."""
import itertools
import ssl
import statistics
import time
import urllib.request

import trb_fleet
from engine import Composition
from play import DEPLOY, check_rights, health, make_nodes, round_of, submit, until, view_of, wait_ended

PAPER = trb_fleet.REPO / "config/scenarios/paper-nine-tasks.json"
ROBOTS = list(trb_fleet.DEMO_ROBOTS)
ON_ROS = [name for name, (kind, *_) in trb_fleet.DEMO_ROBOTS.items() if kind in trb_fleet.ROS]


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
