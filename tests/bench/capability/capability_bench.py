"""scripts/bench capability, after everything is built: the capability index beside SQLite and a bare loop (goal P7)."""
import argparse
import json
import pathlib
import platform
import statistics
import subprocess
import sys

TITLES = {"query": "8 of 256 skills, a model's robots", "everybody": "8 skills that everybody has",
          "ten_best": "ten best of 10,000 that can", "ten_best_of_a_tenth": "ten best of 1,000 that can of 10,000"}
WAYS = ("index", "index_rank", "loop", "sql_group", "sql_intersect", "sql_join")
GOAL_US = 1000
GOAL_RATIO = 1.3


def arguments():
    parser = argparse.ArgumentParser(prog="scripts/bench capability", description=__doc__)
    parser.add_argument("--programs", type=pathlib.Path, required=True, help="where trb-bench-capability is")
    parser.add_argument("--robots", type=int, default=1_000_000)
    parser.add_argument("--rounds", type=int, default=9)
    parser.add_argument("--free", action="store_true", help="not on one core alone")
    parser.add_argument("--quick", action="store_true", help="only that all ways find the same")
    parser.add_argument("--json", type=pathlib.Path, help="where to write the figures")
    options = parser.parse_args()
    if options.quick:
        options.robots, options.rounds = 20_000, 1
    return options


def rounds_of(options):
    command = [options.programs / "trb-bench-capability", str(options.robots), str(options.rounds)]
    if not options.free:
        command = ["taskset", "-c", "0", *command]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        lines = [json.loads(line) for line in process.stdout]
    if process.returncode != 0:
        sys.exit(f"trb-bench-capability ended with {process.returncode}")
    return lines


def figures_of(lines):
    """For each measurement: the medians of each method, and of each round's ratios to the index."""
    figures = {}
    for what in dict.fromkeys(line["what"] for line in lines):
        rounds = [line for line in lines if line["what"] == what]
        ways = [way for way in WAYS if way in rounds[0]]
        figures[what] = {
            "robots": rounds[0]["robots"], "found": rounds[0]["found"], "rounds": len(rounds),
            "us": {way: round(statistics.median(one[way] for one in rounds), 2) for way in ways},
            "range_us": {way: [min(one[way] for one in rounds), max(one[way] for one in rounds)] for way in ways},
            "index_to_loop": round(statistics.median(one["index"] / one["loop"] for one in rounds), 3)}
    return figures


def show(figures, quick):
    print(f"{'':38}{'robots':>9}{'found':>9}" + "".join(f"{way:>15}" for way in WAYS) + f"{'index/loop':>12}")
    for what, one in figures.items():
        cells = "".join(f"{one['us'][way]:>12.1f} us" if way in one["us"] else f"{'':>15}" for way in WAYS)
        print(f"{TITLES[what]:38}{one['robots']:>9}{one['found']:>9}{cells}{one['index_to_loop']:>12.3f}")
    if quick:
        return
    asked, ten = figures["query"]["us"]["index"], figures["ten_best"]["index_to_loop"]
    print(f"\nP7: the question {asked:.0f} us of {GOAL_US}: {'met' if asked <= GOAL_US else 'NOT MET'};"
          f" with the ten best {ten:.2f} of {GOAL_RATIO} bare loops: {'met' if ten <= GOAL_RATIO else 'NOT MET'}")


def main():
    options = arguments()
    figures = figures_of(rounds_of(options))
    show(figures, options.quick)
    if options.json:
        report = {"machine": platform.platform(), "regime": "FREE" if options.free else "PIN", "figures": figures}
        options.json.write_text(json.dumps(report, indent=2) + "\n")


if __name__ == "__main__":
    main()
