#!/usr/bin/env python3
"""The page in Chromium, from a real gateway: what its first view sends, and how long it takes until the hall is shown; and how
often the map with 1,000 robots is drawn."""
import json
import pathlib
import statistics
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parents[1] / "browser"), str(HERE.parents[2] / "scripts"), str(HERE.parent / "gateway"), str(HERE.parent)]
import ahead  # noqa: E402
import bench_options  # noqa: E402
import fed_gateway  # noqa: E402
import gateway_page  # noqa: E402
import skips  # noqa: E402
import trb_fleet  # noqa: E402

BLOCK = 163
FIRST_KB, FIRST_S = 150, 1.0
FRAMES = 30
MAP_S = 5
CHANGES = (1, 10)  # of each robot, a second: one is what a robot's node lets through


def parse():
    parser = bench_options.parser("page", __doc__, 5, "how often it is opened (5)")
    parser.add_argument("--robots", default=1000, type=int, help="on the map (1,000)")
    parser.add_argument("--only", choices=("first", "map"), help="one of the two measurements")
    parser.add_argument("--ahead", action="store_true", help=ahead.HELP)
    options = parser.parse_args()
    if options.quick:
        options.robots = 20
    return options


def play(options, fleet, **more):
    settings = {"url": f"https://localhost:{fleet.gateway_port}/", "password": gateway_page.PASSWORD,
                "rounds": 1 if options.quick else options.rounds, **more}
    child = subprocess.Popen(["node", HERE / "page_bench.mjs", json.dumps(settings)], stdout=subprocess.PIPE, text=True,
                             preexec_fn=trb_fleet.end_with_parent)
    while True:
        fleet.pump()
        if options.ahead:
            ahead.pull(child.pid)
        try:
            child.wait(0.1)
            break
        except subprocess.TimeoutExpired:
            pass
    if child.returncode != 0:
        raise RuntimeError(f"page_bench.mjs ended with {child.returncode}")
    return json.loads(child.stdout.read())


def measure_first(options, folder):
    with trb_fleet.Fleet(folder / "fleet", options.programs, block=BLOCK, udp_port=50000 + BLOCK, robots={}, name="page",
                         gateway_port=trb_fleet.free_port()) as fleet:
        fleet.make()
        fleet.start()
        gateway_page.open_to_people(fleet)
        return play(options, fleet)["first"]


def measure_map(options, folder, changes):
    with fed_gateway.FedGateway(folder / "fleet", options.programs, options.robots, changes) as fleet:
        fleet.make()
        fleet.start()
        return play(options, fleet, robots=options.robots, seconds=1 if options.quick else MAP_S)["map"]


def tell_first(rounds):
    seconds = statistics.median(one["ms"] for one in rounds) / 1000
    kilobytes = max(one["bytes"] for one in rounds) / 1000
    print(f"first view: {kilobytes:.1f} kB sent, gzipped (goal {FIRST_KB}: {'met' if kilobytes <= FIRST_KB else 'not met'}); "
          f"shown after {seconds:.2f} s (goal {FIRST_S:g}: {'met' if seconds <= FIRST_S else 'not met'})")


def tell_map(rounds, options, changes):
    def median(what, key):
        return statistics.median(one[what][key] for one in rounds)

    frames = median("panned", "drawn")
    print(f"map, {options.robots} robots, each with {changes} changes a second: {frames:.1f} frames/s while it is panned "
          f"(goal {FRAMES}: {'met' if frames >= FRAMES else 'not met'}; the browser gives {median('panned', 'screen'):.1f}); untouched "
          f"it is drawn {median('still', 'drawn'):.1f} times a second, of {median('still', 'screen'):.1f} frames")


def main():
    options = parse()
    if options.ahead:
        ahead.go()
    if missing := gateway_page.why_not():
        skips.leave(missing)
    figures = {}
    with tempfile.TemporaryDirectory(prefix="trb-page-") as folder:
        root = pathlib.Path(folder)
        if options.only in (None, "first"):
            figures["first"] = measure_first(options, root)
            tell_first(figures["first"])
        for changes in CHANGES if options.only in (None, "map") else ():
            figures[f"map_{changes}"] = measure_map(options, root, changes)
            tell_map(figures[f"map_{changes}"], options, changes)
    if options.json:
        options.json.write_text(json.dumps(figures, indent=1) + "\n")
    return 0


if __name__ == "__main__":
    trb_fleet.run_main(main, "scripts/bench page")
