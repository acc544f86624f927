"""Figure 16's fleet: section 6's demonstration, five robots over their makers' protocols, a thermometer that the cloud
watches at 1 Hz, nine tasks, a fault whose tasks another robot takes over. Real processes, from the first one on."""
import collections
import pathlib
import sys
import tempfile
import time

from tapped import REPO, Capture, Taps

sys.path.insert(0, str(REPO / "scripts"))
import demo_fault  # noqa: E402  (found only with the line above)
import demo_fleet  # noqa: E402
import demo_place  # noqa: E402
import sensor_side  # noqa: E402
import trb_fleet  # noqa: E402

ROBOTS = {name: demo_fault.ROBOTS[name] for name in ("ridgeback", "ur3", "pioneer2", "drone", "conveyor")}
SECONDS = 180
TEMPERATURE = 15  # degC: the UR3 picks on the left


def say(text=""):
    print(text, file=sys.stderr, flush=True)


def counters(fleet):
    """By phase: what the routers took in or made, and what robots and mode-adapters said to each other."""
    total = collections.Counter()
    for node in fleet.node_names:
        services = ["router", *(["mode-adapter"] if node in fleet.robots else [])]
        for service in services:
            answer = fleet.json("service", "counters", service, node=node)
            total.update({row["phase"]: row["value"] for row in answer["phases"]})
            if service == "router":
                values = {row["name"]: row["value"] for row in answer["values"]}
                total["hellos"] += values.get("sent.hello", 0)
                total["lost"] += values.get("dropped.tap_full", 0)
    return total


def watch(fleet):
    """The cloud gets each value, once a second."""
    command = [fleet.programs / "trb", "sensor", "watch", "temperature", "--every", 1, "--timeout", SECONDS,
               "--node", fleet.dir(trb_fleet.CLOUD)]
    return trb_fleet.Process(command, fleet.root / "watch.log")


def run(fleet, seconds):
    """Everything from the first process until so long after it. What has been counted, and the run's view."""
    fault = demo_fault.Fault(fleet, "automatic", 60, say)
    fleet.make()
    fault.configure()
    taps, capture = Taps(fleet.dir(node) / "bus" for node in fleet.node_names), Capture(f"127.0.{fleet.block}.")
    watching = None
    try:
        taps.start()
        capture.start()
        began = time.monotonic()
        fleet.start()
        fleet.wait_formed(60)
        say(f"figures: the fleet is formed after {time.monotonic() - began:.1f} s")
        demo_fleet.plug_sensor(fleet, TEMPERATURE)
        watching = watch(fleet)
        fault.begin()
        view = demo_fleet.run_scenario(fleet, fault)
        if view["state"] != "FINISHED":
            raise RuntimeError(f"the run is {view['state']}: {view['waits_for']}; no figure of that")
        took = time.monotonic() - began
        fault.pump()
        fleet.wait(f"{seconds} s", lambda: watching.pump(0) and time.monotonic() - began >= seconds, seconds + 60)
        values = sum("degC" in line for line in watching.lines)
        said = counters(fleet)
    finally:
        fault.stop()
        if watching:
            watching.stop()
        capture.end()
        taps.end()
    check(said, taps, capture)
    return {"said": said, "taps": taps, "capture": capture, "view": view, "run_ended_s": took, "values": values}


def check(said, taps, capture):
    """The taps have heard everything: from the first Hello on, and nearly all that TCP has carried."""
    if said["lost"] or taps.messages["identification", "hello"] != said["hellos"]:
        raise RuntimeError("a tap has lost messages, or came too late: count again on a quieter machine")
    tapped = sum(taps.bytes.values())
    if not tapped <= capture.tcp <= 1.1 * tapped:
        raise RuntimeError(f"TCP has carried {capture.tcp} bytes, the taps tell of {tapped}: more than connections need lies between")


def count(programs, seconds=SECONDS):
    with tempfile.TemporaryDirectory(prefix="trb-figure-") as folder:
        root = pathlib.Path(folder) / "fleet"
        place = demo_place.take(None, None, root, say)
        with trb_fleet.Fleet(root, programs, block=place.block, udp_port=place.udp_port, robots=ROBOTS) as fleet:
            sensor_side.SensorSide(fleet, demo_fleet.SENSOR_NODE)
            try:
                return run(fleet, seconds)
            finally:
                place.close()
