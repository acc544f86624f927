"""A figure's sheet: axes, colours, and how it is written, as SVG with its numbers beside as CSV."""
import csv

import matplotlib

matplotlib.use("svg")
import matplotlib.pyplot as plt  # noqa: E402

SIZE_INCHES = (7.2, 4.4)
# Dark to light, so that print without colour tells them apart too.
COLOURS = ("#0b3c5d", "#1d6a96", "#328cc1", "#5aa9a3", "#8a9a5b", "#c58b3a", "#b5472f")
INK = "#222222"  # what the paper prints

plt.rcParams.update({"svg.hashsalt": "talkrobots", "svg.fonttype": "none", "font.family": "sans-serif", "font.size": 9})


def write_csv(path, names, rows):
    with path.open("w", newline="", encoding="utf-8") as file:
        out = csv.writer(file, lineterminator="\n")
        out.writerow(names)
        out.writerows(rows)


def prepare(axes, title, x, y, grid="both"):
    axes.set_title(title, loc="left", fontsize=11)
    axes.set_xlabel(x)
    axes.set_ylabel(y)
    axes.set_axisbelow(True)
    axes.grid(True, axis=grid, color="#dddddd", linewidth=0.6)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)


def canvas(title, x, y):
    figure, axes = plt.subplots(figsize=SIZE_INCHES)
    prepare(axes, title, x, y)
    return figure, axes


def save(figure, path, foot=0):
    """`foot`: the part of the height that is left for a line below."""
    figure.tight_layout(rect=(0, foot, 1, 1))
    figure.savefig(path, metadata={"Date": None, "Creator": None})
    plt.close(figure)
    print(path)
