#!/usr/bin/env python3
"""The gateway under load: 1,000 robots whose states change, and 50 pages that show them, one of which stalls; and how many
requests a second it answers beside nginx. What stands in for what: tests/bench/README.md."""
import json
import os
import pathlib
import statistics
import sys
import tempfile
import time

HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent), str(HERE.parents[2] / "scripts")]
import ahead  # noqa: E402
import bench_options  # noqa: E402
import beside_nginx  # noqa: E402
import fed_gateway  # noqa: E402
import skips  # noqa: E402
import trb_fleet  # noqa: E402

P99_MS, CORES = 250, 1.0
TO_NGINX = 0.8
FLAT_MB = 4  # more than an allocator's noise; what a client could leave behind is counted in rounds


def parse():
    parser = bench_options.parser("gateway", __doc__, 3, "each without and with a stalled page (3)")
    parser.add_argument("--robots", default=1000, type=int)
    parser.add_argument("--changes", default=10, type=float, help="of each robot, a second (10)")
    parser.add_argument("--pages", default=50, type=int)
    parser.add_argument("--seconds", default=10, type=float, help="of a measurement (10)")
    parser.add_argument("--only", choices=("pages", "nginx"), help="one of the two measurements")
    parser.add_argument("--ahead", action="store_true", help=ahead.HELP)
    options = parser.parse_args()
    if options.quick:
        options.robots, options.pages, options.rounds, options.seconds = 50, 5, 1, 1
    return options


def look(fleet, options, token, stalled, warm_s):
    """One measurement: what the pages found, and what the gateway took."""
    words = [fleet.programs / "trb-bench-gateway", "look", fleet.gateway_port, fleet.certificate(), token, options.pages,
             stalled, options.robots, options.changes, warm_s, options.seconds]
    pages = trb_fleet.Process(words, fleet.root / "pages.log")
    pages.wait_line("measuring", warm_s + 30)
    began, cpu, feeder = time.monotonic(), fleet.cpu_s("gateway"), fleet.cpu_s("feeder")
    memory = fleet.memory_mb("gateway")
    line, _ = pages.wait_line("p99_ms", options.seconds + 30)
    seconds = time.monotonic() - began
    found = json.loads(line)
    found.update(cores=(fleet.cpu_s("gateway") - cpu) / seconds, feeder_cores=(fleet.cpu_s("feeder") - feeder) / seconds,
                 memory_mb=[memory, fleet.memory_mb("gateway")])
    pages.child.wait(10)
    if pages.child.returncode != 0:
        raise RuntimeError(f"the pages ended with {pages.child.returncode}; see {fleet.root}/pages.log")
    pages.stop()
    return found


def measure_pages(options, folder):
    with fed_gateway.FedGateway(folder / "fleet", options.programs, options.robots, options.changes) as fleet:
        fleet.make()
        fleet.start()
        token = fleet.token("pages")
        warm_s = 1 if options.quick else 4
        look(fleet, options, token, 0, warm_s)  # grows what it will need
        rounds = [{stalled: look(fleet, options, token, stalled, warm_s) for stalled in (0, 1)} for _ in range(options.rounds)]
        return {"all": [one[0] for one in rounds], "stalled": [one[1] for one in rounds], "feeder": fleet.stop_feeder()}


def median(rounds, key):
    return statistics.median(one[key] for one in rounds)


def growth_mb(rounds):
    return rounds[-1]["memory_mb"][1] - rounds[0]["memory_mb"][0]


def judge(what, good, text):
    print(f"{'PASS' if good else 'FAIL'}  {what}: {text}")
    return good


def tell_pages(figures, options):
    print(f"{options.robots} robots, each with {options.changes:g} changes a second; {options.pages} pages; medians of "
          f"{options.rounds} rounds, load {os.getloadavg()[0]:.1f}")
    print("| pages | p50 | p99 | longest | frames/s a page | kB/s a page | the gateway's cores | feeder, pages | memory |")
    print("|---|---|---|---|---|---|---|---|---|")
    for name, key in (("all read", "all"), ("one stalled", "stalled")):
        rounds = figures[key]
        print(f"| {name} | {median(rounds, 'p50_ms'):.0f} ms | {median(rounds, 'p99_ms'):.0f} ms | "
              f"{max(one['most_ms'] for one in rounds):.0f} ms | {median(rounds, 'frames_per_s'):.1f} | "
              f"{median(rounds, 'kB_per_s'):.0f} | {median(rounds, 'cores'):.2f} | {median(rounds, 'feeder_cores'):.2f}, "
              f"{median(rounds, 'own_cores'):.2f} | {rounds[0]['memory_mb'][0]:.1f} to {rounds[-1]['memory_mb'][1]:.1f} MB |")
    feeder = figures["feeder"]
    print(f"the feeder: {feeder['sent']} changes sent, {feeder['no_room']} found no room at the gateway, "
          f"latest {feeder['latest_ms']:.0f} ms")
    good = []
    for name, key in (("", "all"), (", one stalled", "stalled")):
        rounds = figures[key]
        p99, cores = median(rounds, "p99_ms"), median(rounds, "cores")
        good.append(judge(f"robot to page{name}", p99 <= P99_MS, f"p99 {p99:.0f} ms, goal {P99_MS}"))
        good.append(judge(f"processor{name}", cores <= CORES, f"{cores:.2f} cores, goal {CORES:g}"))
    grown = growth_mb(figures["all"] + figures["stalled"][-1:])
    good.append(judge("memory", grown <= FLAT_MB, f"{grown:+.1f} MB from the first round to the last, goal {FLAT_MB}"))
    return all(good)


def tell_nginx(figures):
    gateway, nginx = (statistics.median(figures[name]) for name in ("gateway", "nginx"))
    return judge("P8, GET of one robot", figures["ratio"] >= TO_NGINX,
                 f"{gateway:.0f} a second, nginx with the same {figures['body_bytes']} bytes as a file {nginx:.0f}: "
                 f"{figures['ratio']:.2f}, goal {TO_NGINX}")


def main():
    options = parse()
    if options.ahead:
        ahead.go()
    figures, good = {}, []
    with tempfile.TemporaryDirectory(prefix="trb-gateway-") as folder:
        root = pathlib.Path(folder)
        if options.only in (None, "pages"):
            figures["pages"] = measure_pages(options, root / "pages")
            good.append(tell_pages(figures["pages"], options))
        missing = beside_nginx.why_not()
        if missing and options.only == "nginx":
            skips.leave(missing)
        if missing and options.only is None:
            print(f"skipped: GET beside nginx: {missing}")
        if not missing and options.only in (None, "nginx"):
            seconds = max(1, int(options.seconds / 2))
            figures["nginx"] = beside_nginx.measure(options.programs, root / "nginx", options.rounds, seconds)
            good.append(tell_nginx(figures["nginx"]))
    if options.json:
        options.json.write_text(json.dumps(figures, indent=1) + "\n")
    return 0 if all(good) or options.quick else 1


if __name__ == "__main__":
    trb_fleet.run_main(main, "scripts/bench gateway")
