"""What a fleet on this machine costs: memory and processor of its processes, from /proc."""
import os
import pathlib
import time

TICKS = os.sysconf("SC_CLK_TCK")
GROUPS = {
    "trb": "supervisors", "trb-router": "routers", "trb-mode-adapter": "mode-adapters", "trb-ros-bridge": "ROS bridges",
    "trb-ros-worker": "ROS bridges", "trb-sensor-bus": "sensor-buses", "trb-scheduler": "schedulers",
    "trb-resilience": "resilience", "trb-cloud-gateway": "gateway",
    "rosmaster": "ROS master",
}


def group_of(pid):
    words = pathlib.Path(f"/proc/{pid}/cmdline").read_bytes().split(b"\0")
    names = [pathlib.Path(word.decode(errors="replace")).name for word in words[:2]]
    return next((GROUPS[name] for name in names if name in GROUPS), "virtual robots")


def children():
    found = {}
    for path in pathlib.Path("/proc").glob("[0-9]*/stat"):
        try:
            parent = int(path.read_text().rsplit(") ", 1)[1].split()[1])
        except OSError:
            continue
        found.setdefault(parent, []).append(int(path.parent.name))
    return found


def family(roots):
    """The processes and all their descendants."""
    below, out, todo = children(), [], list(roots)
    while todo:
        pid = todo.pop()
        out.append(pid)
        todo += below.get(pid, [])
    return out


def proportional_kb(pid):
    for line in pathlib.Path(f"/proc/{pid}/smaps_rollup").read_text().splitlines():
        if line.startswith("Pss:"):
            return int(line.split()[1])
    return 0


def cpu_s(pid):
    fields = pathlib.Path(f"/proc/{pid}/stat").read_text().rsplit(") ", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / TICKS


def sample(roots):
    """By group: how many processes, their memory (shared pages counted once, in MB) and processor time so far (s)."""
    out = {"at": time.monotonic(), "groups": {}}
    for pid in family(roots):
        try:
            row = group_of(pid), proportional_kb(pid) / 1024, cpu_s(pid)
        except OSError:  # it has just ended
            continue
        count, memory, cpu = out["groups"].get(row[0], (0, 0.0, 0.0))
        out["groups"][row[0]] = (count + 1, memory + row[1], cpu + row[2])
    return out


def percent(before, after, group):
    """Of one core, between two samples."""
    used = after["groups"].get(group, (0, 0, 0))[2] - before["groups"].get(group, (0, 0, 0))[2]
    return 100 * max(used, 0) / (after["at"] - before["at"])


def rows(rest, run):
    """`rest` and `run`: two samples each. One row a group and their sum."""
    out = []
    for group in sorted(run[1]["groups"]):
        count, memory, _ = run[1]["groups"][group]
        out.append({"group": group, "processes": count, "memory_mb": round(memory, 1),
                    "rest_percent": round(percent(*rest, group), 1), "run_percent": round(percent(*run, group), 1)})
    keys = ("processes", "memory_mb", "rest_percent", "run_percent")
    out.append({"group": "all", **{key: round(sum(row[key] for row in out), 1) for key in keys}})
    return out
