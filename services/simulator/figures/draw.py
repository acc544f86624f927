#!/usr/bin/env python3
"""Draws figures of the paper. Of 11 to 13 every point is a simulation (`trb simulate`), every line the model (`trb model`); 16 to
18 are counted and measured on real processes, and are drawn only if they are named."""
import argparse
import importlib
import pathlib
import sys

import trb
from sheet import COLOURS, canvas, save, write_csv

HERE = pathlib.Path(__file__).resolve().parent
ROBOTS = (1, 5, 10, 20, 30, 40, 50)
TASKS = (1, 10, 20, 40, 60, 80, 100)
DISTRIBUTION_ROBOTS = (5, 10, 20, 50)
PAPER_BYTES = 1.4e6  # section 5.2.2: 50 robots, 100 tasks


class Programs(trb.Trb):
    def simulate(self, robots, tasks):
        return self.ask("simulate", "--robots", robots, "--tasks", tasks)

    def model(self, robots, tasks):
        """Tasks in turn: one robot's are one block, else there is none."""
        block = ("--blocks", 1, "--block-tasks", tasks) if robots == 1 and tasks > 1 else ()
        return self.ask("model", "--robots", robots, "--direct", tasks, *block)["terms"]


def grid_of(programs):
    """Both figures of robots and tasks are of the same simulations."""
    rows = []
    for robots in ROBOTS:
        for tasks in TASKS:
            counted = programs.simulate(robots, tasks)
            rows.append((robots, tasks, counted["messages"], int(programs.model(robots, tasks)["total"]), counted["bytes"],
                         counted["between_computers"]["bytes"]))
        print(f"figures: {robots} robots", file=sys.stderr)
    return rows


def draw_lines(axes, rows, points, line=None, scale=1):
    for colour, robots in zip(COLOURS, ROBOTS):
        mine = [row for row in rows if row[0] == robots]
        tasks = [row[1] for row in mine]
        if line is not None:
            axes.plot(tasks, [row[line] / scale for row in mine], color=colour, linewidth=1.2)
        axes.plot(tasks, [row[points] / scale for row in mine], "o" if line is not None else "o-", color=colour, markersize=4,
                  linewidth=1.2, label=f"{robots} robot{'s' if robots > 1 else ''}")
    axes.legend(frameon=False, fontsize=8, loc="upper left", bbox_to_anchor=(1, 1))
    axes.set_xlim(0, max(TASKS) + 2)
    axes.set_ylim(bottom=0)


def figure_11(programs, into, rows):
    figure, axes = canvas("Figure 11: messages; points counted, lines Equation 12", "tasks", "messages")
    draw_lines(axes, rows, 2, 3)
    save(figure, into / "figure-11.svg")
    write_csv(into / "figure-11.csv", ("robots", "tasks", "counted_messages", "equation_12"), [row[:4] for row in rows])


def figure_12(programs, into, rows):
    figure, axes = canvas("Figure 12: data exchanged; points counted, Figure 3's datagrams", "tasks", "kB")
    draw_lines(axes, rows, 4, scale=1000)
    axes.set_ylim(0, PAPER_BYTES / 1000 * 1.08)
    axes.plot([100], [PAPER_BYTES / 1000], "x", color="#222222", markersize=8)
    axes.annotate("paper: 50 robots, 1.4 MB", (100, PAPER_BYTES / 1000), xytext=(-8, -4), textcoords="offset points", ha="right",
                  fontsize=8)
    save(figure, into / "figure-12.svg")
    write_csv(into / "figure-12.csv", ("robots", "tasks", "bytes", "bytes_between_computers"),
              [(*row[:2], *row[4:]) for row in rows])


def figure_13(programs, into, _rows):
    figure, axes = canvas("Figure 13: messages over time, 50 tasks of 3 s", "time (s)", "messages in a second")
    rows = []
    for colour, robots in zip(COLOURS[::2], DISTRIBUTION_ROBOTS):
        over_time = programs.simulate(robots, 50)["over_time"]
        seconds = [i * over_time["interval_s"] for i in range(len(over_time["messages"]))]
        axes.plot(seconds, over_time["messages"], drawstyle="steps-post", color=colour, linewidth=1.2,
                  label=f"{robots} robots: {over_time['messages'][0]} in the first second")
        rows += [(robots, f"{at:g}", *counts) for at, *counts in zip(seconds, over_time["messages"], over_time["bytes"])]
    axes.set_yscale("symlog", linthresh=10)
    axes.set_ylim(bottom=0)
    axes.legend(frameon=False, fontsize=8)
    save(figure, into / "figure-13.svg")
    write_csv(into / "figure-13.csv", ("robots", "time_s", "messages", "bytes"), rows)


FIGURES = {"11": figure_11, "12": figure_12, "13": figure_13}
MEASURED = ("16", "17", "18")  # each a module of its own


def parse():
    parser = argparse.ArgumentParser(prog="scripts/figures", description=__doc__)
    parser.add_argument("figures", nargs="*", choices=[*FIGURES, *MEASURED, []], default=[], help="which (11 12 13)")
    parser.add_argument("--into", type=pathlib.Path, default=HERE, help="where they are written")
    parser.add_argument("--programs", type=pathlib.Path, required=True, help="the folder with trb")
    parser.add_argument("--rounds", type=int, default=15, help="of 17 and 18: how often each is measured (15)")
    parser.add_argument("--ahead", action="store_true",
                        help="of 17 and 18: before other programs (nice -19, as root), for a machine that others use, too")
    given = parser.parse_args()
    if not 1 <= given.rounds <= 1000:
        parser.error("--rounds: between 1 and 1000")
    given.programs = given.programs.resolve()
    return given


def main():
    given = parse()
    given.into.mkdir(parents=True, exist_ok=True)
    programs = Programs(given.programs)
    wanted = given.figures or list(FIGURES)
    rows = grid_of(programs) if {"11", "12"} & set(wanted) else []
    for name in wanted:
        if name in FIGURES:
            FIGURES[name](programs, given.into, rows)
        else:
            importlib.import_module(f"figure_{name}").draw(given)


if __name__ == "__main__":
    main()
