"""What every bench with a fleet of processes can be told."""
import argparse
import pathlib

import trb_fleet


def parser(name, description, rounds, rounds_help=None):
    """`rounds`: how many, if nothing is said."""
    made = argparse.ArgumentParser(prog=f"scripts/bench {name}", description=description)
    made.add_argument("--programs", default=trb_fleet.REPO / "build" / "release" / "bin", type=pathlib.Path)
    made.add_argument("--rounds", default=rounds, type=int, help=rounds_help or f"({rounds})")
    made.add_argument("--quick", action="store_true", help="a little of everything: only that it works")
    made.add_argument("--json", type=pathlib.Path, metavar="FILE", help="write the figures there, too")
    return made
