"""What a fleet uses over hours: samples, whether they are flat, a table and a picture."""
import os
import pathlib

PAGE_MB = os.sysconf("SC_PAGE_SIZE") / 1024 / 1024
WARM = 0.34  # the part at the beginning in which caches fill
# What may be added over the measured time, beside a tenth: processes are killed, and begin small again.
FIGURES = {"memory_mb": ("memory, MB", 24.0), "descriptors": ("descriptors", 40.0), "disk_mb": ("disk, MB", 24.0)}


def of_process(pid):
    """(resident MB, open descriptors); zeros for one that has just ended."""
    try:
        resident = int(pathlib.Path(f"/proc/{pid}/statm").read_text().split()[1]) * PAGE_MB
        return resident, len(os.listdir(f"/proc/{pid}/fd"))
    except OSError:
        return 0.0, 0


def disk_mb(folder):
    """Without the proof logs, which grow to the size that node.json gives them, and no further (tests/integration/proof_test.py)."""
    size = 0
    for path in pathlib.Path(folder).rglob("*"):
        try:
            if path.is_file() and not path.is_symlink() and "proof" not in path.parts:
                size += path.stat().st_size
        except OSError:
            pass  # it has just gone
    return size / 1024 / 1024


def sample(pids, folder):
    each = [of_process(pid) for pid in pids]
    return {"processes": sum(memory > 0 for memory, _ in each), "memory_mb": sum(memory for memory, _ in each),
            "descriptors": sum(open_ for _, open_ in each), "disk_mb": disk_mb(folder)}


def slope(points):
    """Of the straight line that fits best, by the least squares."""
    count = len(points)
    mean_x, mean_y = sum(x for x, _ in points) / count, sum(y for _, y in points) / count
    spread = sum((x - mean_x) ** 2 for x, _ in points)
    return sum((x - mean_x) * (y - mean_y) for x, y in points) / spread if spread else 0.0


def growth(samples, figure):
    """By the line through what follows the warm part: (at its beginning, at its end, by the hour)."""
    warm = samples[int(len(samples) * WARM):]
    points = [(one["at_s"] / 3600, one[figure]) for one in warm]
    by_hour = slope(points)
    mean_x, mean_y = sum(x for x, _ in points) / len(points), sum(y for _, y in points) / len(points)
    return [mean_y + by_hour * (x - mean_x) for x in (points[0][0], points[-1][0])] + [by_hour]


def judge(samples):
    """figure -> its row; `flat` is what the soak promises."""
    out = {}
    for figure, (_, more) in FIGURES.items():
        first, last, by_hour = growth(samples, figure)
        values = [one[figure] for one in samples]
        out[figure] = {"begins": round(first, 1), "ends": round(last, 1), "by_hour": round(by_hour, 1),
                       "least": round(min(values), 1), "most": round(max(values), 1),
                       "flat": last - first <= 0.1 * first + more}
    return out


def table(judged):
    rows = ["| | after warming up | at the end | by the hour | least | most | flat |", "|---|---|---|---|---|---|---|"]
    for figure, row in judged.items():
        rows.append(f"| {FIGURES[figure][0]} | {row['begins']} | {row['ends']} | {row['by_hour']:+} | {row['least']} | {row['most']} | "
                    f"{'yes' if row['flat'] else 'NO'} |")
    return "\n".join(rows)


def curve(samples, figure, top, width, height):
    most = max(one[figure] for one in samples) * 1.1 or 1.0
    end = samples[-1]["at_s"] or 1.0
    points = " ".join(f"{60 + one['at_s'] / end * width:.1f},{top + height - one[figure] / most * height:.1f}" for one in samples)
    name = FIGURES[figure][0]
    return (f'<text x="60" y="{top - 6}">{name}, at most {max(one[figure] for one in samples):.0f}</text>'
            f'<rect x="60" y="{top}" width="{width}" height="{height}" fill="none" stroke="#bbb"/>'
            f'<text x="54" y="{top + 10}" text-anchor="end">{most:.0f}</text>'
            f'<text x="54" y="{top + height}" text-anchor="end">0</text>'
            f'<polyline points="{points}" fill="none" stroke="#06c" stroke-width="1.5"/>')


def picture(samples):
    """The same as a picture (SVG), each figure from 0."""
    width, height, gap = 640, 120, 44
    parts = [curve(samples, figure, 30 + i * (height + gap), width, height) for i, figure in enumerate(FIGURES)]
    tall = 30 + len(FIGURES) * (height + gap)
    end = f'<text x="{60 + width}" y="{tall - 22}" text-anchor="end">{samples[-1]["at_s"] / 60:.0f} minutes</text>'
    return (f'<svg xmlns="http://www.w3.org/2000/svg" width="{width + 90}" height="{tall}" font-family="sans-serif" font-size="12">'
            f'<rect width="100%" height="100%" fill="#fff"/>{"".join(parts)}{end}</svg>\n')
