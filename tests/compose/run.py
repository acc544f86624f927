"""scripts/test-compose [images|one|demo ...] [--rounds N] [--speed N] [--json FILE]

The images of deploy/compose/Dockerfile and its two compositions, on a Docker engine of the test's own. Needs root.
"""
import argparse
import json
import os
import pathlib
import shutil
import statistics
import subprocess
import sys
import tempfile
import time

HERE = pathlib.Path(__file__).resolve().parent
REPO = HERE.parents[1]
sys.path[:0] = [str(HERE), str(REPO / "scripts"), str(HERE.parent / "support")]
import skips  # noqa: E402
import trb_fleet  # noqa: E402
from demo import demo  # noqa: E402
from engine import COMPOSE, DOCKER, Engine  # noqa: E402
from images import build_images  # noqa: E402
from one import one  # noqa: E402
from play import Report  # noqa: E402


def what_is_missing():
    if os.geteuid() != 0:
        return "needs root, for a Docker engine of its own"
    # Without rules of iptables the host would forward from network to network, and nothing that is cut would be cut.
    if pathlib.Path("/proc/sys/net/ipv4/ip_forward").read_text().strip() != "0":
        return "needs a host that does not forward: sysctl net.ipv4.ip_forward=0"
    for program in ("dockerd", DOCKER, COMPOSE, "ip", "setpriv"):
        if shutil.which(program) is None:
            return f"needs the program {program}: apt-get install docker.io docker-compose"
    return None


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("parts", nargs="*", choices=[[], "images", "one", "demo"], metavar="images|one|demo")
    parser.add_argument("--rounds", type=int, default=22, help="docker kill of a container (22: each once)")
    parser.add_argument("--speed", type=float, default=4.0)
    parser.add_argument("--json", type=pathlib.Path)
    parser.add_argument("--data", type=pathlib.Path, default=REPO / "build/docker")
    arguments = parser.parse_args()
    if missing := what_is_missing():
        skips.leave(f"scripts/test-compose {missing}")
    report, began = Report(), time.monotonic()
    with tempfile.TemporaryDirectory(prefix="trb-compose-") as folder, Engine(arguments.data) as engine:
        build_images(engine, report)
        for part, function in (("one", one), ("demo", demo)):
            if arguments.parts and part not in arguments.parts:
                continue
            try:
                function(engine, report, pathlib.Path(folder) / part, arguments)
            except (RuntimeError, TimeoutError, KeyError, OSError, subprocess.SubprocessError) as problem:
                report.check(False, f"{part}: {type(problem).__name__}: {problem}")
    if report.times:
        report.notes.update(kills=len(report.times), whole_median_s=round(statistics.median(report.times), 1), whole_most_s=round(max(report.times), 1))
    print("  ".join(f"{key} = {value}" for key, value in report.notes.items()))
    for fault in report.faults:
        print(f"FAULT {fault}")
    print(f"{len(report.faults)} faults, {time.monotonic() - began:.0f} s")
    if arguments.json:
        arguments.json.write_text(json.dumps({**report.notes, "faults": report.faults}, indent=1) + "\n")
    return 1 if report.faults else 0


if __name__ == "__main__":
    trb_fleet.run_main(main, "scripts/test-compose")
