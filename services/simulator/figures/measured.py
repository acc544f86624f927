"""What the measured figures share: rounds in turns on one core, their medians, and a chart of delays."""
import contextlib
import os
import platform
import statistics
import sys

from sheet import COLOURS, INK, plt, prepare, save, write_csv
from tapped import REPO

sys.path[:0] = [str(REPO / "tests" / "bench" / folder) for folder in ("road", "fields", "gateway")]
import ahead  # noqa: E402  (found only with the line above)

CSV_NAMES = ("what", "rounds", "median_ms", "smallest_ms", "largest_ms", "paper_ms")


@contextlib.contextmanager
def one_core():
    """For latency: steadier than two cores that others use, too."""
    everywhere = os.sched_getaffinity(0)
    os.sched_setaffinity(0, {min(everywhere)})
    try:
        yield
    finally:
        os.sched_setaffinity(0, everywhere)


def in_turns(measures, rounds):
    """Name -> the milliseconds of each round; each round begins with another one."""
    names, out = list(measures), {name: [] for name in measures}
    for number in range(rounds):
        turn = number % len(names)
        for name in names[turn:] + names[:turn]:
            out[name].append(measures[name]())
        print(f"figures: round {number + 1} of {rounds}: "
              + ", ".join(f"{name} {values[-1]:.3f} ms" for name, values in out.items()), file=sys.stderr)
    return out


def row(name, values, paper=""):
    return (name, len(values), *(f"{value:.4f}" for value in (statistics.median(values), min(values), max(values))), paper)


def conditions(arguments, load):
    """Where and how it was measured, as the foot of a figure."""
    priority = ", nice -19" if arguments.ahead else ""
    return (f"Linux {platform.release().split('-')[0]}, {os.cpu_count()} cores, everything on one of them{priority}, "
            f"load {load:.0f}; medians of {arguments.rounds} rounds, each round a small dot")


def draw_delays(path, title, bars, paper, foot):
    """`bars`: (label, the rounds' milliseconds), from above; `paper`: two of (label, milliseconds)."""
    figure, axes = plt.subplots(figsize=(7.2, 1.5 + 0.46 * len(bars)))
    prepare(axes, title, "delay (ms)", "", grid="x")
    axes.set_xscale("log")
    for at, (label, values) in enumerate(bars):
        colour, middle = COLOURS[at % len(COLOURS)], statistics.median(values)
        axes.plot(values, [at] * len(values), ".", color=colour, alpha=0.35, markersize=5)
        axes.plot([middle], [at], "o", color=colour, markersize=8)
        axes.annotate(f"{middle:#.3g} ms", (middle, at), xytext=(0, 7), textcoords="offset points", ha="center", fontsize=8,
                      bbox={"facecolor": "white", "edgecolor": "none", "pad": 0.5})
    every = [value for _, values in bars for value in values] + [value for _, value in paper]
    axes.set_xlim(min(every) * 0.6, max(every) * 3)
    axes.set_yticks(range(len(bars)), [label for label, _ in bars])
    axes.set_ylim(len(bars) - 0.4, -0.8)
    for (label, value), (side, offset) in zip(paper, (("right", -3), ("left", 3))):
        axes.axvline(value, color=INK, linewidth=0.9, linestyle=(0, (4, 3)))
        axes.annotate(label, (value, len(bars) - 0.5), xytext=(offset, 0), textcoords="offset points", ha=side, fontsize=8, color=INK)
    axes.xaxis.set_major_formatter(lambda value, _: f"{value:g}")
    figure.text(0.01, 0.01, foot, fontsize=7, color="#555555")
    save(figure, path, foot=0.04)


def draw(arguments, number, title, measure, paper, printed):
    """Measures and draws; `printed`: name of a bar -> what the paper prints for it, in ms."""
    if arguments.ahead:
        ahead.go()
    load = os.getloadavg()[0]
    with one_core():
        times = measure(arguments)
    draw_delays(arguments.into / f"figure-{number}.svg", title, list(times.items()), paper, conditions(arguments, load))
    write_csv(arguments.into / f"figure-{number}.csv", CSV_NAMES,
              [row(name, values, printed.get(name, "")) for name, values in times.items()])
