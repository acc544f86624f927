"""One node, a container for each of its services."""
import contextlib
import itertools
import pathlib
import pwd
import subprocess
import threading

import private_bus
from engine import Composition
from play import DEPLOY, check_rights, health, make_nodes, round_of, submit, until, wait_ended

PICK = {"name": "pick", "tasks": [{"id": "pick", "robot": "ur3", "skill": "pick", "data": {"side": "left"}}]}
SERVICES = ("router", "scheduler", "mode-adapter", "sensor-bus")  # of `one`, a container and a user each
# A D-Bus lets in only users that its machine knows: here one that every Debian has plays the user of the sensor-bus.
SENSOR_USER = "games"
OWNS_NAMES = f'<policy user="{SENSOR_USER}"><allow own_prefix="trbots"/></policy>'
WARM = ["--type=signal", "/trbots/temperature", "trbots.temperature.value", "double:21.5", "string:degC"]


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
