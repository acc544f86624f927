"""scripts/test-network [CASE...] [--quick] [--rounds N] [--jobs N] [--json FILE] [--list]

Builds hosts out of network namespaces (needs root), runs real routers in them, does to their network what a plant does,
and says how long the fleet took to be right again. Every case runs by itself, several at a time: most of it is waiting.
"""
import argparse
import json
import os
import pathlib
import select
import signal
import subprocess
import sys
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))

import crowd  # noqa: F401  adds its case
import doctor_cases  # noqa: F401  adds its case
import firewall_case  # noqa: F401  adds its case
import hosts
import sites  # noqa: F401  adds its cases
import skips
from cases import CASES, Report, trb_fleet


def run_one(name, rounds, tag):
    report = Report(name, tag)
    try:
        if rounds:
            CASES[name][0](report, rounds)
    except Exception as problem:  # a failing case must not lose the others' figures
        report.fail(f"{type(problem).__name__}: {problem}")
    print("RESULT " + json.dumps(report.result()), flush=True)
    return 1 if report.faults else 0


class Job:
    def __init__(self, name, rounds):
        self.name = name
        command = [sys.executable, __file__, "--one", name, "--rounds", str(rounds)]
        self.child = subprocess.Popen(command, stdout=subprocess.PIPE,
                                      preexec_fn=trb_fleet.end_with_parent)
        os.set_blocking(self.child.stdout.fileno(), False)
        self.rest, self.result = b"", None

    def pump(self):
        """Prints the child's lines; False once it has ended."""
        alive = self.child.poll() is None
        self.rest += self.child.stdout.read() or b""
        *lines, self.rest = self.rest.split(b"\n")
        for line in (raw.decode(errors="replace") for raw in lines):
            if line.startswith("RESULT "):
                self.result = json.loads(line[7:])
            else:
                print(line, flush=True)
        return alive


ALONE = ("fifty",)  # cases that would disturb the others' times, and they theirs


def run_all(wanted, jobs):
    together = [row for row in wanted if row[0] not in ALONE]
    results = run_some(together, jobs) if together else []
    for row in wanted:
        if row[0] in ALONE:
            results += run_some([row], 1)
    return results


def run_some(wanted, jobs):
    todo, running, results = list(wanted), [], []
    while todo or running:
        while todo and len(running) < jobs:
            running.append(Job(*todo.pop(0)))
        for job in list(running):
            if not job.pump():
                running.remove(job)
                results.append(job.result or {"case": job.name, "rounds": 0, "faults": ["the case ended without figures"]})
        select.select([job.child.stdout for job in running], [], [], 1)  # a line, or the end of a case
    return results


COLUMNS = ("case", "rounds", "median_s", "most_s", "formed_s", "sent", "received", "nacked", "twice", "wrong",
           "extra_connections")


def print_table(results):
    rows = [[str(r.get(c, "")) if r.get(c) is not None else "" for c in COLUMNS] + [str(len(r["faults"]))] for r in results]
    heads = [*(c.replace("_s", " s").replace("extra_connections", "extra tcp") for c in COLUMNS), "faults"]
    widths = [max(len(row[i]) for row in [heads, *rows]) for i in range(len(heads))]
    for row in [heads, *rows]:
        print("  ".join(word.rjust(width) if i else word.ljust(width) for i, (word, width) in enumerate(zip(row, widths))))
    for result in results:
        for key, value in result.items():
            if key not in COLUMNS and key != "faults":
                print(f"{result['case']}: {key} = {value}")
        for fault in result["faults"]:
            print(f"{result['case']}: FAULT {fault}")


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("cases", nargs="*")
    parser.add_argument("--quick", action="store_true", help="one or two rounds of each, in a few minutes")
    parser.add_argument("--rounds", type=int)
    parser.add_argument("--jobs", type=int, default=4)
    parser.add_argument("--json")
    parser.add_argument("--list", action="store_true")
    parser.add_argument("--one", help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.list:
        for name, (function, rounds, _) in CASES.items():
            print(f"{name:12} {rounds:3} rounds  {(function.__doc__ or '').strip().splitlines()[0] if function.__doc__ else ''}")
        return 0
    # A case that is ended from outside still removes its hosts.
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))
    if arguments.one:
        # Two runs on one machine must not meet: the tag is made of this process's number.
        return run_one(arguments.one, arguments.rounds, f"{os.getpid() % 100000}")
    if missing := hosts.why_not():
        skips.leave(f"scripts/test-network {missing}")
    unknown = [name for name in arguments.cases if name not in CASES]
    if unknown:
        sys.exit(f"scripts/test-network: no case {', '.join(unknown)}; there are: {', '.join(CASES)}")
    wanted = []
    for name, (_, rounds, quick) in CASES.items():
        count = arguments.rounds or (quick if arguments.quick else rounds)
        if (not arguments.cases or name in arguments.cases) and count:
            wanted.append((name, count))
    start = time.monotonic()
    results = run_all(wanted, arguments.jobs)
    order = list(CASES)
    results.sort(key=lambda result: order.index(result["case"]))
    print_table(results)
    faults = sum(len(result["faults"]) for result in results)
    print(f"{len(results)} cases, {faults} faults, {time.monotonic() - start:.0f} s; the limit after a healing is 5 s")
    if arguments.json:
        with open(arguments.json, "w") as file:
            json.dump(results, file, indent=1)
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
