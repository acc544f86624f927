"""The demonstration's second half: everything is built; make the fleet, run the scenario, show what happened."""
import argparse
import fcntl
import json
import os
import pathlib
import shlex
import shutil
import signal
import subprocess
import sys
import time

import demo_fault
import demo_page
import demo_place
import fleet_cost
import sensor_side
import trb_fleet

PHASES = ["boot", "identification", "devices", "task", "forward", "sensor", "fail", "upkeep"]
REST_S = 3.0
SCENARIO = trb_fleet.REPO / "config" / "scenarios" / "paper-temperature.json"
SENSOR_NODE = "conveyor"


def say(text=""):
    print(text, flush=True)


def add_counts(into, counters):
    for row in counters["phases"]:
        into[row["phase"]] = into.get(row["phase"], 0) + row["value"]


def observed_messages(fleet):
    """Every message that the fleet's routers took in or made, and all that robots and adapters said to each other."""
    total = dict.fromkeys(PHASES, 0)
    for node in fleet.node_names:
        add_counts(total, fleet.json("service", "counters", "router", node=node))
        if node in fleet.robots:
            add_counts(total, fleet.json("service", "counters", "mode-adapter", node=node))
    total["total"] = sum(total.values())
    return total


def equation12(n, k, sum_m, direct, interpreted, sensors, remote, faults):
    """Equation 12 by its terms (Equations 1, 2, 3, 7, 8, 10, 11): sensors that nobody watches, remote requests, faulty
    robots."""
    tasks = direct + interpreted
    terms = {
        "boot": 3 * n + 1,
        "identification": n * (n + 1) // 2,
        "devices": 2 * sensors,
        "task": 4 * direct + 8 * interpreted,
        "forward": tasks - sum_m + k - 1,
        "sensor": 4 * remote,
        "fail": 2 * faults,
    }
    terms["total"] = sum(terms.values())
    return terms


def print_table(rows):
    widths = [max(len(str(row[i])) for row in rows) for i in range(len(rows[0]))]
    for row in rows:
        say("  " + "  ".join(str(cell).ljust(width) for cell, width in zip(row, widths)).rstrip())


def plug_sensor(fleet, degrees):
    """A thermometer at the conveyor; waits until the cloud knows it and its first value is read."""
    side = fleet.sensor_sides[SENSOR_NODE]
    way = f"a line of shell feeds the D-Bus, for no device can be plugged in here ({side.no_hall})" if side.no_hall else \
        "a kernel event, udev, D-Bus, the fleet"
    say(f"\n== a thermometer that shows {degrees:g} degC is plugged into the {SENSOR_NODE}'s PC: {way}")
    side.plug_temperature(degrees)

    def known():
        routes = fleet.json("route", "list", node=trb_fleet.CLOUD)["routes"]
        plugged = next(route for route in routes if route["id"] == SENSOR_NODE)["profile"]["plugged"]
        return any(sensor["kind"] == "temperature" and sensor["state"] == "ok" for sensor in plugged)
    seconds = fleet.wait("the cloud knows the thermometer", known, trb_fleet.LONG_S)
    say(f"  the fleet can ask for it after {seconds:.1f} s")
    for line in fleet.trb("sensor", "list", node=trb_fleet.CLOUD).stdout.splitlines():
        say("  " + line)


def run_scenario(fleet, fault=None):
    """Submits and follows the run; progress goes straight to the person. Returns the final view."""
    command = [fleet.programs / "trb", "scenario", "run", SCENARIO, "--watch", "--node", fleet.dir(trb_fleet.CLOUD)]
    command += ["--timeout", str(fault.run_limit_s())] if fault else ["--timeout", "120", "--until-paused"]
    child = subprocess.Popen([str(word) for word in command], preexec_fn=trb_fleet.end_with_parent)
    while child.poll() is None:
        fleet.pump()
        if fault and not fault.follow():
            child.terminate()
        time.sleep(0.02)
    return fleet.json("scenario", "watch", *own_run(fleet), "--once", node=trb_fleet.CLOUD, check=False)


def own_run(fleet):
    """The newest run of this scenario, if there is one: in the page, people may have started others meanwhile."""
    name = json.loads(pathlib.Path(SCENARIO).read_text())["name"]
    runs = fleet.json("run", "list", "--all", node=trb_fleet.CLOUD)["runs"]
    own = sorted((run for run in runs if run["name"] == name), key=lambda run: run["created"])
    return [run["run"] for run in own[-1:]]


def wait_acknowledged(fleet):
    """The robots' last upkeep (proofs of delivery) may still be under way when the last task has ended."""
    fleet.pump()
    time.sleep(0.5)


def cost(fleet):
    return fleet_cost.sample([process.child.pid for process in fleet.processes()])


def cost_at_rest(fleet):
    """Two samples, some seconds apart, in which nobody asks the fleet for anything."""
    say(f"\n== at rest: {REST_S:.0f} s")
    before = cost(fleet)
    end = time.monotonic() + REST_S
    while time.monotonic() < end:
        fleet.pump()
        time.sleep(0.1)
    return before, cost(fleet)


def report_cost(rows):
    say("\n== what it costs: memory (shared pages counted once), processor in percent of one core")
    print_table([["PROCESSES", "NUMBER", "MEMORY", "AT REST", "RUNNING"]]
                + [[row["group"], row["processes"], f"{row['memory_mb']:.0f} MB", f"{row['rest_percent']:.1f} %",
                    f"{row['run_percent']:.1f} %"] for row in rows])


def report_fault(fault, view, result):
    """Equation 11's row, taken apart: from which node to which, by the tap."""
    fault.pump()
    result["fault"] = fault.result(view)
    wire = result["messages"]["fault_on_the_wire"] = fault.wire(view)
    say("\n== Equation 11: two messages for a faulty robot. What went from node to node, by the tap at two routers")
    print_table(demo_fault.wire_rows(wire))
    say("  The row 'fail' above counts at their senders, each broadcast once, what also stays within a node: the decision on its\n"
        "  way to the own scheduler. Batons of the new epoch count as forward, the failed attempt as a task.")
    times = result["fault"].get("times")
    if times:
        say(f"\n== fault to alert {times['fault_to_alert_s']:.3f} s, alert to decision {times['alert_to_decision_s']:.3f} s, "
            f"decision to the replacement's command {times['decision_to_commanded_s']:.3f} s")


def report(fleet, view, wall_s, faults):
    rows = [["#", "TASK", "ROBOT", "SKILL", "MODE", "TRANSPORT", "STATE", "DURATION"]]
    for i, task in enumerate(view["tasks"], 1):
        rows.append([i, task["id"], task["robot"], task["skill"], task.get("mode", ""), task.get("transport", ""),
                     task["state"], f"{task['duration_s']:.2f} s"])
    say(f"\n== the run {view['state']}" + (f": {view['waits_for']}" if view["waits_for"] else ""))
    print_table(rows)
    # A topic takes a task as a direct robot does: whole, not field by field.
    done = [task for task in view["tasks"] if task["state"] != "SKIPPED"]
    direct = sum(task.get("mode") in ("direct", "ros") for task in done)
    n, k, sum_m = len(fleet.robots), view["blocks_k"], view["blocks_sum_m"]
    observed = observed_messages(fleet)
    model = equation12(n, k, sum_m, direct, len(done) - direct, sensors=1, remote=1, faults=faults)
    say(f"\n== messages by phase, beside Equation 12 for n={n}, k={k}, sum m={sum_m}, "
        f"N_d={direct}, N_i={len(done) - direct}, s=1 (watched by nobody), R_e=1, N_f={faults}")
    print_table([["PHASE", "OBSERVED", "EQUATION 12"]] + [[p, observed[p], model.get(p, "-")] for p in PHASES + ["total"]])
    say(f"  without upkeep: {observed['total'] - observed['upkeep']}. Observed counts every message that a router took in or\n"
        "  made and every field or word between robot and node. More than the model: services join their own bus (boot),\n"
        "  both ends of a link say Hello and nodes repeat their beacon (identification), each node tells every other one what\n"
        "  its robot can do and what is plugged in (devices), a robot acknowledges each field or answers (task), definitions\n"
        "  are fetched by digest (forward), an arm tells its mode and safety (sensor); upkeep is keep-alives, signatures,\n"
        "  proofs of delivery and these lists, which the model leaves out.")
    say(f"\n== {wall_s:.1f} s from the first process to the end of the run")
    fields = ["id", "robot", "skill", "mode", "transport", "state", "duration_s"]
    return {"run": {"id": view["run"], "state": view["state"],
                    "tasks": [{f: task.get(f, "") for f in fields} for task in view["tasks"]]},
            "messages": {"observed": observed, "equation12": model}, "wall_s": round(wall_s, 2)}


def below(here, path):
    """An absolute path for a shell, short if it lies below this folder."""
    path = os.path.realpath(path)
    inside = os.path.relpath(path, here)
    return shlex.quote(path) if inside.startswith("..") else '"$PWD"/' + shlex.quote(inside)


def print_next_steps(fleet, fault):
    here = os.path.realpath(os.curdir)
    say("\n== the fleet stays up until Ctrl-C. Try in another terminal, from this folder:")
    say(f"  export PATH={below(here, fleet.programs)}:$PATH TRB_NODE={below(here, fleet.dir('cloud'))}")
    mended = fault.next_steps() if fault else []
    for line in [*mended, "trb robot list", "trb send ur3 command move '[0.5,-1.2,1.0,-1.4,-1.57,0]'", "trb request ur3 position",
                 "trb send pioneer1 command turn '[90]'", "trb send pioneer2 command turn 90", "trb request drone altitude", "trb sensor list", "trb sensor read temperature", "trb sensor watch temperature",
                 "trb tap", "trb scenario run config/scenarios/paper-temperature.json --watch",
                 "trb run list --all", "trb stop --all", "trb release --all", "trb help"]:
        say("  " + line)


def take_lock(root):
    """One demonstration at a time in this folder: the next one would pull the floor from under it."""
    root.parent.mkdir(parents=True, exist_ok=True)
    lock = open(root.with_name(root.name + ".lock"), "w")
    try:
        fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        sys.exit(f"scripts/demo: another demonstration is running in {root}; stop it first (Ctrl-C there)")
    return lock


def take_root(folder):
    """The folder of a fleet, and the lock that makes it this process's, without the evidence of an earlier one."""
    root = pathlib.Path(folder).resolve()
    lock = take_lock(root)
    shutil.rmtree(root / "evidence", ignore_errors=True)
    return root, lock


def parse():
    parser = argparse.ArgumentParser(
        prog="scripts/demo", description="Starts a fleet of ten nodes on this machine (127.0.1.x), nine robots over six makers' protocols, and runs the paper's nine-task scenario.",
        epilog="examples:  scripts/demo      scripts/demo --once --json run.json      scripts/demo --speed 4 --temperature 25\n          scripts/demo --fault --once      scripts/demo --fault --policy ask",
        formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--once", action="store_true", help="end after the run; exit 0 only if it FINISHED")
    parser.add_argument("--json", metavar="FILE", help="write the run, the message counts and the time as JSON")
    parser.add_argument("--speed", type=float, default=1.0, help="how much faster than real the robots move (1)")
    parser.add_argument("--temperature", type=float, default=15.0, metavar="DEGREES",
                        help="what the thermometer at the conveyor shows: up to 20 degC the UR3 picks left, above right (15)")
    parser.add_argument("--fault", action="store_true",
                        help="the Ridgeback's base fails on its way to the UR3, another robot takes over (section 6.1 whole)")
    parser.add_argument("--policy", choices=["automatic", "ask"], help="of --fault: the best one takes over at once (automatic), "
                        "or you are asked, and decide in another terminal")
    parser.add_argument("--patience", type=float, default=600, metavar="SECONDS",
                        help="of --policy ask: how long the demonstration waits for you (600)")
    parser.add_argument("--only-parse", action="store_true", help=argparse.SUPPRESS)
    parser.add_argument("--programs", required=True, help=argparse.SUPPRESS)
    parser.add_argument("--root", required=True, help=argparse.SUPPRESS)
    parser.add_argument("--block", type=int, help=argparse.SUPPRESS)
    parser.add_argument("--udp-port", type=int, help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if not 0 < arguments.speed <= 100:
        parser.error("--speed: between 0 and 100")
    if not -40 <= arguments.temperature <= 125:
        parser.error("--temperature: between -40 and 125")
    if arguments.policy and not arguments.fault:
        parser.error("--policy: only with --fault")
    if not 1 <= arguments.patience <= 86400:
        parser.error("--patience: between 1 and 86400")
    return arguments


def start(fleet, fault):
    say(f"== making the fleet '{fleet.name}': an authority, {len(fleet.node_names)} nodes, their keys and certificates")
    fleet.make()
    if fault:
        fault.configure()
    say("== starting the virtual robots and the nodes, each service a process of its own")
    fleet.start()
    seconds = fleet.wait_formed()
    say(f"== every node knows every other ({seconds:.1f} s); the cloud node's table:")
    for line in fleet.trb("route", "list", node=trb_fleet.CLOUD).stdout.splitlines():
        say("  " + line)
    for line in fleet.trb("robot", "list", node=trb_fleet.CLOUD).stdout.splitlines():
        say("  " + line)
    demo_page.open_to_people(fleet, say)


def main():
    arguments = parse()
    if arguments.only_parse:
        return
    root = pathlib.Path(arguments.root)
    lock = take_lock(root)
    place = demo_place.take(arguments.block, arguments.udp_port, root, say)
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))
    began = time.monotonic()
    with trb_fleet.Fleet(root, arguments.programs, block=place.block, udp_port=place.udp_port,
                         robots=demo_fault.ROBOTS if arguments.fault else trb_fleet.DEMO_ROBOTS,
                         speed=arguments.speed, gateway_port=demo_page.take_port()) as fleet:
        sensor_side.SensorSide(fleet, SENSOR_NODE)
        fault = None
        if arguments.fault:
            fault = demo_fault.Fault(fleet, arguments.policy or "automatic", arguments.patience, say)
        start(fleet, fault)
        rest = cost_at_rest(fleet)
        plug_sensor(fleet, arguments.temperature)
        say(f"\n== the scenario {SCENARIO.relative_to(trb_fleet.REPO)}")
        before = cost(fleet)
        if fault:
            fault.begin()
        view = run_scenario(fleet, fault)
        run = before, cost(fleet)
        wall_s = time.monotonic() - began - REST_S
        wait_acknowledged(fleet)
        result = report(fleet, view, wall_s, faults=1 if fault else 0)
        if fault:
            report_fault(fault, view, result)
            fault.stop()
        result["cost"] = fleet_cost.rows(rest, run)
        report_cost(result["cost"])
        if arguments.json:
            pathlib.Path(arguments.json).write_text(json.dumps(result, indent=2) + "\n")
        if not arguments.once:
            print_next_steps(fleet, fault)
            while True:
                fleet.pump()
                time.sleep(0.2)
    place.close()
    lock.close()
    return 0 if result["run"]["state"] == "FINISHED" else 1


if __name__ == "__main__":
    try:
        sys.exit(main())
    except KeyboardInterrupt:
        say("\n== stopped")
        sys.exit(130)
    except (RuntimeError, TimeoutError) as problem:
        sys.exit(f"scripts/demo: {problem}")
