"""scripts/soak: the demonstration's fleet at work for hours, with all that happens to one."""
import argparse
import json
import pathlib
import random
import time

import demo_fleet
import demo_place
import fault_rounds as rounds
import soak_figures as figures
import trb_fleet
from fault_tally import print_tally, say, tally_of
from soak_side import Page, SoakFleet

PLUGGED_EVERY, VISITED_EVERY = 2, 5  # rounds


class Soak:
    def __init__(self, arguments, root):
        self.arguments, self.root = arguments, root
        self.rng = random.Random(arguments.seed)
        self.rows, self.samples, self.broken = [], [], []
        self.done = {"plugged": 0, "revoked": 0}

    def play(self, fleet):
        fleet.make()
        fleet.start()
        fleet.all_labels = sorted(fleet.victims())
        page = Page(fleet)
        try:
            self.usual_s = rounds.usual_length(fleet)
            self.begun = time.monotonic()
            while time.monotonic() - self.begun < 60 * self.arguments.minutes:
                self.round(fleet, len(self.rows) + 1)
        finally:
            page.close()
        self.done.update(page_opened=page.opened, page_heard=page.heard)
        self.broken += page.refused if page.heard else ["the page heard nothing"]

    def round(self, fleet, number):
        plan = rounds.planned(self.rng, number % 2 == 0, fleet.all_labels, self.usual_s, self.usual_s)
        self.rows.append(rounds.play_round(fleet, number, plan, self.root / "evidence"))
        if number % PLUGGED_EVERY == 0:
            self.beside("plugged", fleet.plug_anew)
        if number % VISITED_EVERY == 0:
            self.beside("revoked", lambda: fleet.visit(number))
        self.samples.append({"at_s": round(time.monotonic() - self.begun, 1),
                             **figures.sample(fleet.victims().values(), fleet.root / "nodes")})

    def beside(self, what, work):
        try:
            self.done[what] += work() is not False
        except (RuntimeError, TimeoutError, OSError) as problem:
            self.broken.append(f"{what}: {problem}")
            say(f"           BROKEN {self.broken[-1]}")

    def report(self):
        tally, judged = tally_of(self.rows, self.usual_s), figures.judge(self.samples)
        print_tally(tally)
        say(f"  plugged anew: {self.done['plugged']}, joined and revoked: {self.done['revoked']}; the page was opened "
            f"{self.done['page_opened']} times and heard {self.done['page_heard']} changes")
        say(f"\n{figures.table(judged)}")
        out = pathlib.Path(self.arguments.out)
        out.mkdir(parents=True, exist_ok=True)
        (out / "soak.svg").write_text(figures.picture(self.samples))
        (out / "soak.md").write_text(figures.table(judged) + "\n")
        (out / "soak.json").write_text(json.dumps({"seed": self.arguments.seed, "tally": tally, "beside": self.done, "figures": judged,
                                                   "broken": self.broken, "samples": self.samples}, indent=2) + "\n")
        say(f"== {out}: soak.svg, soak.md, soak.json")
        flat = all(row["flat"] for row in judged.values())
        return not tally["rounds_broken"] and not self.broken and flat


def parse():
    parser = argparse.ArgumentParser(prog="scripts/soak", description="A fleet at work for hours: runs, kills, faults, plugging, "
                                     "revocations, an open page. Exit 1 if a rule is broken, or if memory, descriptors or disk grow.")
    parser.add_argument("--minutes", type=float, default=120, help="how long (120)")
    parser.add_argument("--seed", type=int, default=1, help="what happens follows from it (1)")
    parser.add_argument("--out", default=trb_fleet.REPO / "build" / "soak", help="where the figures go (build/soak)")
    parser.add_argument("--speed", type=float, default=10.0, help="how much faster than real the robots move (10)")
    parser.add_argument("--programs", default=trb_fleet.REPO / "build/release/bin", help="the built programs (build/release/bin)")
    parser.add_argument("--root", default=trb_fleet.REPO / ".soak", help="where the fleet is kept (.soak)")
    arguments = parser.parse_args()
    if not 0 < arguments.minutes <= 60 * 24 * 7 or not 0 < arguments.speed <= 100:
        parser.error("--minutes: more than 0, at most a week; --speed: more than 0, at most 100")
    return arguments


def main():
    arguments = parse()
    root, lock = demo_fleet.take_root(arguments.root)
    place = demo_place.take(None, None, root, say)
    soak = Soak(arguments, root)
    with SoakFleet(root / "fleet", arguments.programs, block=place.block, udp_port=place.udp_port, speed=arguments.speed, name="soak",
                   gateway_port=trb_fleet.free_port()) as fleet:
        soak.play(fleet)
    lock.close()
    return 0 if soak.report() else 1


if __name__ == "__main__":
    trb_fleet.run_main(main, "scripts/soak")
