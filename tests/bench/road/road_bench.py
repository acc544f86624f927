"""scripts/bench, after everything is built: measures the roads in turns and prints what they cost."""
import json
import os
import pathlib
import platform
import statistics
import tempfile
import time

import roads
import trb_fleet  # found by roads

WINDOW = 256
ROADS = ("floor", "bare", "unsealed", "unlogged", "sealed", "each")
FULL = {"warm": 500, "messages": 2000, "seconds": 2.0}
QUICK = {"warm": 50, "messages": 200, "seconds": 0.2}


def say(text=""):
    print(text, flush=True)


def usage_between(before, after, messages):
    return {name: {"cpu_us": round((after[name][0] - before[name][0]) / messages, 2),
                   "switches": round((after[name][1] - before[name][1]) / messages, 2)} for name in before}


def observed(road, order):
    before = road.usage()
    result = road.order(order)
    result["processes"] = usage_between(before, road.usage(), max(result["messages"], 1))
    result["cpu_us"] = round(sum(row["cpu_us"] for name, row in result["processes"].items() if name != "robots"), 2)
    return result


def measure(road, plan):
    road.order(f"latency {plan['warm']}")
    latency = observed(road, f"latency {plan['messages']}")
    throughput = observed(road, f"throughput {plan['seconds']} {WINDOW}")
    return {"latency": latency, "throughput": throughput}


def run_regime(regime, arguments, plan, core):
    """Every road once a round, in turns, each round beginning with another one."""
    everywhere = os.sched_getaffinity(0)
    os.sched_setaffinity(0, {core} if regime == "PIN" else everywhere)
    results = {}
    octet = 64 + os.getpid() % 128
    try:
        with tempfile.TemporaryDirectory(prefix="trb-bench-") as root, \
                roads.Roads(root, arguments.programs, octet) as all_roads:
            measured = all_roads.all()
            for number in range(arguments.rounds):
                turn = number % len(measured)
                for road in measured[turn:] + measured[:turn]:
                    results.setdefault(road.name, []).append(measure(road, plan))
                    all_roads.pump()
                say(f"  {regime} round {number + 1} of {arguments.rounds}: " + ", ".join(
                    f"{name} {rows[-1]['latency']['median_us']:.0f} us" for name, rows in sorted(results.items())))
    finally:
        os.sched_setaffinity(0, everywhere)
    return {name: summary(rows) for name, rows in results.items()}


def middle(rows, *path):
    def value(row):
        for key in path:
            row = row[key]
        return row
    return round(statistics.median(value(row) for row in rows), 2)


def summary(rows):
    """The medians over the rounds, and the rounds themselves."""
    out = {"median_us": middle(rows, "latency", "median_us"), "p99_us": middle(rows, "latency", "p99_us"),
           "per_second": middle(rows, "throughput", "per_second"),
           "lost": sum(row["throughput"]["lost"] for row in rows),
           "latency_cpu_us": middle(rows, "latency", "cpu_us"),
           "throughput_cpu_us": middle(rows, "throughput", "cpu_us")}
    out["p99_to_median"] = round(out["p99_us"] / out["median_us"], 2)
    out["processes"] = {
        name: {"latency_cpu_us": middle(rows, "latency", "processes", name, "cpu_us"),
               "latency_switches": middle(rows, "latency", "processes", name, "switches"),
               "throughput_cpu_us": middle(rows, "throughput", "processes", name, "cpu_us"),
               "throughput_switches": middle(rows, "throughput", "processes", name, "switches")}
        for name in rows[0]["latency"]["processes"]}
    return {**out, "rounds": rows}


def add_ratios(result):
    floor = result["floor"]
    for name, row in result.items():
        row["latency_to_floor"] = round(row["median_us"] / floor["median_us"], 2)
        row["throughput_to_floor"] = round(row["per_second"] / floor["per_second"], 2)
        ratios = [mine["latency"]["median_us"] / bare["latency"]["median_us"]
                  for mine, bare in zip(row["rounds"], floor["rounds"])]
        row["latency_to_floor_by_round"] = [round(ratio, 2) for ratio in ratios]


def print_table(rows):
    widths = [max(len(str(row[i])) for row in rows) for i in range(len(rows[0]))]
    for row in rows:
        say("  " + "  ".join(str(cell).rjust(width) if i else str(cell).ljust(width)
                             for i, (cell, width) in enumerate(zip(row, widths))))


def print_regime(regime, result):
    say(f"\n== {regime}: one way, medians of {len(result['floor']['rounds'])} rounds")
    rows = [["ROAD", "MEDIAN us", "P99 us", "P99/MEDIAN", "TO FLOOR", "CPU us", "MSG/s", "TO FLOOR", "CPU us", "LOST"]]
    for name in ROADS:
        row = result[name]
        rows.append([name, f"{row['median_us']:.1f}", f"{row['p99_us']:.1f}", f"{row['p99_to_median']:.2f}",
                     f"{row['latency_to_floor']:.2f}", f"{row['latency_cpu_us']:.1f}", f"{row['per_second']:,.0f}",
                     f"{row['throughput_to_floor']:.2f}", f"{row['throughput_cpu_us']:.2f}", row["lost"]])
    print_table(rows)
    rows = [["ROAD, PROCESS", "CPU us", "SWITCHES", "CPU us", "SWITCHES", ""]]
    for name in ROADS:
        for process, use in result[name]["processes"].items():
            rows.append([f"{name}, {process}", *[f"{value:.2f}" for value in use.values()], ""])
    say("\n  a message, with one in flight and with many: CPU and voluntary context switches")
    print_table([row[:-1] for row in rows])


def print_split(result):
    floor, bare, unsealed, unlogged, road = (
        result[name]["median_us"] for name in ("floor", "bare", "unsealed", "unlogged", "sealed"))
    say("\n== where the time goes (PIN, us one way)")
    print_table([["PART", "us", "SHARE"],
                 ["floor: ipc, two processes, CURVE tcp, ipc", f"{floor:.1f}", f"{floor / road:.0%}"],
                 ["two more processes and the robots' TCP, bare", f"{bare - floor:.1f}",
                  f"{(bare - floor) / road:.0%}"],
                 ["what the routers and mode-adapters do", f"{unsealed - bare:.1f}", f"{(unsealed - bare) / road:.0%}"],
                 ["seals", f"{unlogged - unsealed:.1f}", f"{(unlogged - unsealed) / road:.0%}"],
                 ["the log of proof", f"{road - unlogged:.1f}", f"{(road - unlogged) / road:.0%}"],
                 ["the road, robot to robot", f"{road:.1f}", "100%"]])


def goals(regimes):
    pin, free = regimes["PIN"], regimes["FREE"]
    per_second = {name: row["per_second"] for name, row in free.items()}
    return [
        ("P1", "sealed / floor, PIN", pin["sealed"]["latency_to_floor"], "at most", 1.5),
        ("P1", "before_delivery / floor, PIN", pin["each"]["latency_to_floor"], "at most", 2.3),
        ("P1", "p99 / median, sealed, PIN", pin["sealed"]["p99_to_median"], "at most", 1.4),
        ("P2", "sealed / unsealed messages a second, FREE", per_second["sealed"] / per_second["unsealed"], "at least", 0.9),
        ("P2", "unlogged / unsealed messages a second, FREE", per_second["unlogged"] / per_second["unsealed"], "at least", 0.9),
        ("P2", "sealed / one signature a message, FREE", per_second["sealed"] / per_second["each"], "at least", 12)]


def add_goals(report):
    report["goals"] = [{"goal": name, "what": what, "value": round(value, 2), "wanted": f"{which} {limit}",
                        "met": value <= limit if which == "at most" else value >= limit}
                       for name, what, value, which, limit in goals(report["regimes"])]


def print_goals(report):
    say()
    for row in report["goals"]:
        say(f"  {row['goal']}: {row['what']} {row['value']:.2f}, goal {row['wanted']}: {'met' if row['met'] else 'NOT met'}")


def parse():
    return roads.with_rounds(roads.parser_of(
        "scripts/bench",
        "Measures the road from robot to robot in direct mode (robot, mode-adapter, router, CURVE, router, mode-adapter, "
        "robot: real processes on 127.x) beside bare chains of the same sockets, in turns.",
        "scripts/bench      scripts/bench --quick      scripts/bench --rounds 9 --json road.json",
        rounds="how often each road is measured in each regime (5; quick: 1)",
        quick="few messages, only to see that it works"))


def main():
    arguments = parse()
    plan = QUICK if arguments.quick else FULL
    core = min(os.sched_getaffinity(0))
    began = time.monotonic()
    say(f"== {arguments.rounds} rounds a regime, 48 bytes of data a message; "
        f"PIN: everything on core {core}; FREE: unpinned")
    report = {"rounds": arguments.rounds, "quick": arguments.quick, "bytes": 48, "window": WINDOW, "plan": plan,
              "cores": os.cpu_count(), "kernel": platform.release(), "regimes": {}}
    for regime in ("PIN", "FREE"):
        report["regimes"][regime] = run_regime(regime, arguments, plan, core)
        add_ratios(report["regimes"][regime])
    for regime, result in report["regimes"].items():
        print_regime(regime, result)
    print_split(report["regimes"]["PIN"])
    add_goals(report)
    print_goals(report)
    say(f"  {time.monotonic() - began:.0f} s")
    if arguments.json:
        pathlib.Path(arguments.json).write_text(json.dumps(report, indent=1) + "\n")
    return 0 if all(road["lost"] == 0 for result in report["regimes"].values() for road in result.values()) else 1


if __name__ == "__main__":
    trb_fleet.run_main(main, "scripts/bench")
