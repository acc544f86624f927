#!/usr/bin/env python3
"""Checks who includes whom, what must not stand in a core or in a test, and that ARCHITECTURE.md has a line for each file and
names none that is not there. Exit 0 if all is well.

    scripts/check_layers.py          checks the repository it stands in
    scripts/check_layers.py --list   prints the layers
"""
import os
import pathlib
import re
import sys

REPO = pathlib.Path(__file__).resolve().parent.parent

# A part may include itself, everything its line names, and what those may include.
LAYERS = {
    "common/base": [],
    "proto": ["common/base"],
    "common/actor": ["proto"],
    "common/fleet": ["proto"],
    "common/security": ["proto"],
    "common/log": ["common/base"],
    "common/tls": ["common/base"],
    "common/metrics": ["common/base"],
    "common/sqlite": ["common/base"],
    "common/audit": ["common/security"],
    "common/ranking": ["proto"],
    "common/consensus": ["proto", "common/security"],
    "common/scenario": ["common/fleet", "common/security"],
    "common/simulation": ["common/scenario"],
    "common/model": ["common/scenario"],
    "common/config": ["common/fleet", "common/ranking", "common/security", "common/tls"],
    "common/drivers": ["common/actor", "common/config"],
    "common/transport": ["common/base"],
    "common/service": ["common/actor", "common/config", "common/log", "common/security", "common/transport"],
    "common/operator": ["common/ranking", "common/scenario", "common/service"],
    "common/supervisor": ["common/transport"],
    "services": ["common/service", "common/operator", "common/supervisor", "common/drivers", "common/scenario", "common/simulation",
                 "common/model", "common/ranking", "common/consensus", "common/metrics", "common/sqlite", "common/audit", "common/tls"],
}
CORE_FORBIDDEN = [
    (r'<zmq', "zmq"), (r'<nlohmann', "a JSON library"), (r'<spdlog', "a logger"),
    (r'<sqlite3|common/sqlite/', "a database"),
    (r'<sys/socket|<netinet|<arpa/inet|<poll\.h|<unistd\.h|<sys/epoll|common/base/descriptor\.hpp', "sockets or descriptors"),
    (r'<sdbus-c|<systemd/|<libudev', "D-Bus or udev"),
    (r'<thread>|<mutex>|<condition_variable>|<atomic>|<future>', "threads"),
    (r'<fstream>|<filesystem>|<cstdio>.*FILE|common/base/files\.hpp', "files"),
    (r'<unordered_|<random>', "an order or randomness that differs between machines"),
    (r'common/transport|common/service|common/log', "a shell's library"),
]
CORE_CALLS = [(r'\b(system|steady|high_resolution)_clock::now|clock_gettime|\btime\(nullptr\)', "a clock")]
ZMQ_HEADER = re.compile(r'<zmq')
# They cost a compiler seconds to half a minute, and bring sockets along: of a service only its io/ has them.
NETWORK_HEADER = re.compile(r'<(boost|openssl)/')
IGNORED = {"build", "node_modules", ".git"}
INCLUDE = re.compile(r'^\s*#\s*include\s*([<"][^>"]+[>"])')
# A benchmark measures bare sockets beside ours; everything else reaches libzmq through common/transport.
MAY_INCLUDE_ZMQ = ("common/transport/", "tests/bench/")
ZMQ_CAUGHT = re.compile(r'\bcatch\s*\(\s*(const\s+)?zmq::')
ZMQ_USED = re.compile(r'\bzmq::|\bzmq_\w+\s*\(|\bZMQ_[A-Z]')
# The simulator plays the services' cores, and only these: no shell, no test. A service's tests may have it play theirs.
PLAYS_CORES = "services/simulator/world/"
# What a service's core is told of its configuration is its own; this one still reads a file's type.
CONFIG_IN_CORE = {"services/resilience/core/criteria.hpp"}


def allowed(part):
    out, todo = {part}, list(LAYERS[part])
    while todo:
        name = todo.pop()
        if name not in out:
            out.add(name)
            todo += LAYERS[name]
    return out


def part_of(path):
    if path.startswith("services/"):
        return "services"
    if path.startswith("proto/"):
        return "proto"
    return "/".join(path.split("/")[:2])


def service_of(path):
    return path.split("/")[1] if path.startswith("services/") else None


def driver_of(path):
    """A driver's folder; `text` is what several of them need."""
    parts = path.split("/")
    return parts[2] if path.startswith("common/drivers/") and len(parts) > 3 and parts[2] != "text" else None


SENSOR_READERS = "services/sensor-bus/readers/"


def reader_of(path):
    """A sensor reader's folder."""
    parts = path.removeprefix(SENSOR_READERS).split("/")
    return parts[0] if path.startswith(SENSOR_READERS) and len(parts) > 1 and parts[0] != "test" else None


# Libraries that are pure but for the folders io/ in them.
PURE = ("common/drivers/", "common/operator/")


def is_core(path):
    """Pure code: every core/, and the pure libraries; of a sensor reader's folder all but reader.cpp, which has the device.
    Tests beside it may use more."""
    if is_test(path) or "virtual-robots" in path:
        return False
    pure_reader = reader_of(path) is not None and not path.endswith("/reader.cpp")
    return "/core/" in path or pure_reader or path.startswith(PURE) and "/io/" not in path


def check_include(path, line, included, faults):
    where = f"{path}:{line}"
    if is_core(path):
        for pattern, what in CORE_FORBIDDEN:
            if re.search(pattern, included):
                faults.append(f"{where}: a core includes {included}: {what}")
    if is_core(path) and path.startswith("services/") and path not in CONFIG_IN_CORE and "common/config/" in included:
        faults.append(f"{where}: a service's core includes {included}: the configuration's reader")
    if ZMQ_HEADER.search(included) and not path.startswith(MAY_INCLUDE_ZMQ):
        faults.append(f"{where}: {included} belongs to common/transport alone")
    if NETWORK_HEADER.search(included) and service_of(path) not in (None, "virtual-robots") and "/io/" not in path:
        faults.append(f"{where}: {included} belongs to a service's io/")
    if path.startswith("common/service/service.hpp") and re.search(r'zmq|nlohmann|spdlog|transport|/log', included):
        faults.append(f"{where}: the public header must not show {included}")
    if not included.startswith('"'):
        return
    target = included.strip('"')
    mine, theirs = part_of(path), part_of(target)
    of, other = driver_of(path), driver_of(target)
    shared = path.startswith("common/drivers/") and not is_test(path) and path != "common/drivers/registry.cpp"
    if shared and other is not None and of != other:
        faults.append(f"{where}: {of or 'what drivers share'} includes the driver {other}")
    reader, other = reader_of(path), reader_of(target)
    if path.startswith(SENSOR_READERS) and not is_test(path) and other is not None and reader != other:
        faults.append(f"{where}: {reader or 'what sensor readers share'} includes the sensor reader {other}")
    if theirs not in LAYERS:
        return
    if mine in LAYERS and theirs not in allowed(mine) and not is_test(path):
        faults.append(f"{where}: {mine} may not include {theirs} ({target})")
    if service_of(path) == "virtual-robots" and theirs != "services":
        faults.append(f"{where}: a virtual robot shares no code with the middleware ({target})")
    played = path.startswith(PLAYS_CORES) and "/core/" in target
    played = played or is_test(path) and target.startswith(PLAYS_CORES) and not is_test(target)
    if service_of(path) and service_of(target) and service_of(path) != service_of(target) and not played:
        faults.append(f"{where}: a service includes another one ({target})")


def check_file(path, faults):
    text = (REPO / path).read_text(errors="replace")
    for number, line in enumerate(text.splitlines(), 1):
        match = INCLUDE.match(line)
        if match:
            check_include(path, number, match.group(1), faults)
            continue
        code = line.split("//")[0]
        if is_core(path):
            for pattern, what in CORE_CALLS:
                if re.search(pattern, code):
                    faults.append(f"{path}:{number}: a core reads {what}")
        if not path.startswith(MAY_INCLUDE_ZMQ):
            if ZMQ_CAUGHT.search(code):
                faults.append(f"{path}:{number}: libzmq's exceptions stay in common/transport; it returns Status")
            elif ZMQ_USED.search(code) and not is_test(path):
                faults.append(f"{path}:{number}: libzmq is used by common/transport alone")
        if is_test(path) and re.search(r'sleep_for|sleep_until|\busleep\(|nanosleep', line.split('//')[0]):
            faults.append(f"{path}:{number}: a test sleeps; wait on an event with a deadline")


def is_test(path):
    beside = re.search(r"/(test|fuzz)/", path) is not None
    return path.startswith("tests/") and "/bench/" not in path or beside or path.endswith("_test.cpp")


def check_document(faults):
    """Every file that ARCHITECTURE.md names under "Where would I change ...?" exists: before the colon by its whole path, after it
    by that or as one of the same folder (or of the subject's). Every source but the test beside a file has such a line, or its
    folder has one."""
    text = (REPO / "ARCHITECTURE.md").read_text()
    lines = text.partition("## Where would I change")[2].partition("\n## ")[0].splitlines()
    there = {name for path in REPO.rglob("*") if not IGNORED & set(path.relative_to(REPO).parts)
             for name in (path.relative_to(REPO).as_posix(), path.relative_to(REPO).with_suffix("").as_posix())}
    subject, named = "", set()
    for line in lines:
        subject = (re.findall(r"^\*\*.*\*\* `([\w/-]+/)`$", line) or [subject])[0]
        files, _, text = line.partition(": ") if line.startswith("- ") else ("", "", "")
        paths = re.findall(r"`([\w/.-]+)`", files)
        named.update(paths)
        folders = ["", subject, *(path.rpartition("/")[0] + "/" for path in paths)]
        for name, below in [(path, [""]) for path in paths] + [(name, folders) for name in re.findall(r"`([\w/.-]+)`", text)]:
            if "NAME" not in name and there.isdisjoint((folder + name).rstrip("/") for folder in below):
                faults.append(f"ARCHITECTURE.md: '{name}' names no file")
    patterns = [re.compile(re.escape(name).replace("NAME", "[^/]+") + ("" if name.endswith("/") else "$"))
                for name in named if "NAME" in name or name.endswith("/")]
    for name in sorted(there):
        path, ending = os.path.splitext(name)
        tried = re.sub(r"(_test|\.test)$", "", path).replace("/test/", "/")
        is_known = (path in named or tried != path and {tried, tried + ".svelte"} & there or re.search(r"\.d$|/main$|/io/start$", path)
                    or any(p.match(path) for p in patterns))
        if ending in (".hpp", ".cpp", ".ts", ".svelte", ".py") and (REPO / name).is_file() and not is_known:
            faults.append(f"ARCHITECTURE.md: '{name}' has no line; say below its folder's subject what it contains")


def main():
    if "--list" in sys.argv:
        for part in LAYERS:
            print(part, "<-", ", ".join(sorted(allowed(part) - {part})) or "nothing")
        return 0
    faults = []
    files = [p.relative_to(REPO).as_posix() for top in ("common", "proto", "services", "tests")
             for p in sorted((REPO / top).rglob("*")) if p.suffix in (".hpp", ".cpp")]
    for path in files:
        check_file(path, faults)
    check_document(faults)
    for fault in faults:
        print(fault)
    print(f"check_layers: {len(files)} files, {len(faults)} faults")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
