#!/usr/bin/env python3
"""What 200 sensors at 10 Hz and 50 remote streams of them cost the control messages of the same two nodes: their round
trip idle and beside the sensors, in turns, in one run. Control has one core, the sensors the other: see README.md.
"""
import json
import os
import pathlib
import statistics
import sys
import tempfile
import time

import zmq

REPO = pathlib.Path(__file__).resolve().parents[3]
sys.path[:0] = [str(REPO / "tests" / each) for each in ("support", "integration", "bench", "bench/lane")] + [str(REPO / "scripts")]

import bench_options  # noqa: E402
import sensor_side  # noqa: E402
import skips  # noqa: E402
import support  # noqa: E402
import trb_fleet  # noqa: E402
import udev_hall  # noqa: E402
from lane_bench import CONTROL, FROM, GOAL, LOAD, TO, pin  # noqa: E402
from lane_ends import Probe  # noqa: E402

EVERY_S = 0.1
RULE = {"match": {"subsystem": "hwmon", "attributes": {"name": ["lm75*"]}}, "read": "attributes",
        "sensors": [{"kind": "temperature", "unit": "degC", "attribute": "temp?_input", "scale": 0.001, "every_s": EVERY_S}]}


class Load:
    """The sensors' side of FROM and its watchers at TO: all of it on the load's core, running or stopped."""

    def __init__(self, fleet, side, sensors, streams):
        self.fleet, self.side = fleet, side
        for number in range(sensors):
            side.hall.plug_temperature(20 + number / 10)
        self.wait_read(sensors)
        names = sorted(sensor["name"] for sensor in self.sensors())[:streams]
        self.watchers = [trb_fleet.Process([fleet.programs / "trb", "sensor", "watch", name, "--of", FROM, "--every", EVERY_S,
                                            "--node", fleet.dir(TO)], fleet.root / f"watch-{name}.log") for name in names]
        for watcher in self.watchers:
            os.sched_setaffinity(watcher.child.pid, LOAD)
            watcher.wait_line("degC", 20)

    def sensors(self):
        return self.fleet.json("request", FROM, "sensor_list", "{}", node=FROM)["body"]["sensors"]

    def wait_read(self, count):
        self.fleet.wait(f"{count} sensors are read", lambda: sum(s["state"] == "ok" for s in self.sensors()) == count, 60)

    def pids(self):
        return [process.child.pid for process in [*self.watchers, *self.side.processes()]]

    def cpu_s(self):
        ticks = 0
        for pid in self.pids():
            words = pathlib.Path(f"/proc/{pid}/stat").read_text().rsplit(") ", 1)[1].split()
            ticks += int(words[11]) + int(words[12])
        return ticks / os.sysconf("SC_CLK_TCK")

    def values(self):
        """How many values all watchers have received so far."""
        for watcher in self.watchers:
            watcher.pump(0)
        return sum(len(watcher.lines) for watcher in self.watchers)

    def still(self, still):
        """Stopped processes cost nothing. The turns are short, because leases would end."""
        for pid in self.pids():
            os.kill(pid, 19 if still else 18)

    def stop(self):
        for watcher in self.watchers:
            watcher.stop()


def measure(asker, load, questions, rounds, seconds):
    idle, loaded, heard, cpu, time_s = [], [], 0, 0.0, 0.0

    def ask(count=questions):
        times = sorted(asker.ask(TO) for _ in range(count))
        return statistics.median(times), times[int(len(times) * 0.99)]

    for _ in range(rounds):
        load.still(True)
        idle.append(ask())
        load.still(False)
        end = time.monotonic() + 0.5
        while time.monotonic() < end:  # drops what has waited meanwhile
            ask(10)
        before, began, burnt = load.values(), time.monotonic(), load.cpu_s()
        rows = []
        while time.monotonic() - began < seconds:
            rows.append(ask())
        time_s += time.monotonic() - began
        heard += load.values() - before
        cpu += load.cpu_s() - burnt
        loaded.append(tuple(statistics.median(row[i] for row in rows) for i in (0, 1)))
    figures = {"idle": idle, "loaded": loaded}
    out = {f"{name}_{which}_us": 1e6 * statistics.median(row[i] for row in rows)
           for name, rows in figures.items() for i, which in enumerate(("p50", "p99"))}
    return {**out, "ratio": out["loaded_p50_us"] / out["idle_p50_us"], "values_per_s": heard / time_s,
            "load_percent": 100 * cpu / time_s}


def make_fleet(folder, programs):
    fleet = support.RouterFleet(pathlib.Path(folder) / "fleet", programs, {FROM: ["router"], TO: ["router"]}, block=172,
                                udp_port=50172)
    side = sensor_side.SensorSide(fleet, FROM)
    fleet.make()
    (fleet.dir(FROM) / "sensors" / "hwmon.json").write_text(json.dumps(RULE))
    return fleet, side


def main():
    parser = bench_options.parser("sensors", __doc__, 5)
    parser.add_argument("--sensors", default=200, type=int)
    parser.add_argument("--streams", default=50, type=int)
    options = parser.parse_args()
    if options.quick:
        options.rounds, options.sensors, options.streams = 1, options.sensors // 10, options.streams // 10
    missing = udev_hall.why_not() or ("" if len(os.sched_getaffinity(0)) > 1 else "it needs two cores")
    if missing:
        skips.leave(missing)
    load = None
    with tempfile.TemporaryDirectory(prefix="trb-sensors-") as folder:
        fleet, side = make_fleet(folder, options.programs)
        try:
            os.sched_setaffinity(0, LOAD)  # processes started from here on inherit it; the routers are moved
            fleet.bring_up(FROM, TO)
            os.sched_setaffinity(0, CONTROL)
            for node in (FROM, TO):
                pin(fleet.pid(node, "router"))
            fleet.wait("the two are linked", lambda: fleet.formed(FROM) and fleet.formed(TO), 10)
            load = Load(fleet, side, options.sensors, options.streams)
            result = measure(Probe(zmq.Context(), fleet, FROM), load, 100 if options.quick else 500, options.rounds,
                             1 if options.quick else 3)
        finally:
            if load:
                load.stop()
            fleet.stop()
    wanted = options.streams / EVERY_S
    print("| Sensors, streams | idle p50 | p50 beside them | ratio | p99 idle, beside | values/s heard (wanted) | load's core |")
    print("|---|---|---|---|---|---|---|")
    print(f"| {options.sensors}, {options.streams} | {result['idle_p50_us']:.0f} us | {result['loaded_p50_us']:.0f} us | "
          f"{result['ratio']:.2f} | {result['idle_p99_us']:.0f}, {result['loaded_p99_us']:.0f} us | "
          f"{result['values_per_s']:.0f} ({wanted:.0f}) | {result['load_percent']:.0f} % |")
    if options.json:
        options.json.write_text(json.dumps(result, indent=1))
    print(f"goal {GOAL}: {'met' if result['ratio'] <= GOAL else 'not met'}")
    return 1 if options.quick and result["values_per_s"] < wanted / 2 else 0


if __name__ == "__main__":
    sys.exit(main())
