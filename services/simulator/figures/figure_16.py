"""Figure 16: how many messages the paper's scenario takes, and how many bytes, counted on the wire of a real fleet."""
import paper_fleet
from paper_count import COLUMNS, PHASES, model_words, rows_of, subtypes_of
from sheet import COLOURS, INK, plt, prepare, save, write_csv
from trb import Trb

PAPER_MESSAGES, PAPER_BYTES = 284, 15_100


def bars(axes, rows, columns, labels, scale=1):
    height = 0.8 / len(columns)
    for at, (column, label) in enumerate(zip(columns, labels)):
        places = [i + (at - (len(columns) - 1) / 2) * height for i in range(len(rows))]
        values = [row[column] / scale for row in rows]
        colour = COLOURS[(5, 2, 0)[at] if len(columns) > 1 else 0]
        axes.barh(places, values, height, color=colour, label=label)
        for place, value in zip(places, values):
            axes.annotate(f"{value:.3g}" if scale > 1 else f"{value:,.0f}", (value, place), xytext=(3, 0),
                          textcoords="offset points", va="center", fontsize=7)
    axes.set_yticks(range(len(rows)), [row[0] for row in rows])
    axes.invert_yaxis()


def mark(axes, value, label, rows):
    """What the paper prints, above the total's bars."""
    at = len(rows) - 1.6
    axes.plot([value], [at], "v", color=INK, markersize=6)
    axes.annotate(label, (value, at), xytext=(6, -1), textcoords="offset points", fontsize=8, color=INK, va="center")


def draw_rows(path, rows, seconds):
    shown = rows[:len(PHASES) + 1]
    figure, (messages, sizes) = plt.subplots(1, 2, figsize=(10, 5.2), width_ratios=(3, 2))
    prepare(messages, "Figure 16: messages of a scenario", "messages", "", grid="x")
    bars(messages, shown, (1, 2, 3), ("Equation 12 for this run", "everything, within a computer too", "between computers"))
    mark(messages, PAPER_MESSAGES, f"paper: {PAPER_MESSAGES}", shown)
    messages.legend(frameon=False, fontsize=8, loc="upper right")
    total = shown[-1]
    prepare(sizes, "Bytes between computers", "kB", "", grid="x")
    bars(sizes, shown, (4,), ("between computers",), scale=1000)
    mark(sizes, PAPER_BYTES / 1000, "paper: 15.1 kB, 83 B/s", shown)
    upkeep = rows[len(PHASES) + 1]
    figure.text(0.01, 0.01, f"Five robots, nine tasks, one fault, a sensor at 1 Hz, {seconds} s. Total {total[4] / 1000:.1f} kB, "
                f"{total[5]} B/s, seals and keep-alives apart ({upkeep[3]:,} messages, {upkeep[4] / 1000:,.0f} kB, {upkeep[5]:,} B/s).",
                fontsize=8, color="#555555")
    save(figure, path, foot=0.04)


def draw(arguments):
    seconds = paper_fleet.SECONDS
    counted = paper_fleet.count(arguments.programs, seconds)
    view = counted["view"]
    words = model_words(len(paper_fleet.ROBOTS), view["tasks"], view["blocks_k"], view["blocks_sum_m"], seconds)
    terms = Trb(arguments.programs).ask("model", *words)["terms"]
    rows = rows_of(counted, terms, seconds)
    draw_rows(arguments.into / "figure-16.svg", rows, seconds)
    write_csv(arguments.into / "figure-16.csv", COLUMNS, rows)
    write_csv(arguments.into / "figure-16-subtypes.csv", ("phase", "subtype", "messages", "bytes"),
              subtypes_of(counted["taps"], counted["capture"]))
