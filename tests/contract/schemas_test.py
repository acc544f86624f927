"""The schemas under config/schemas accept every shipped file and the examples here, and refuse what is wrong."""

import copy
import json
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))

import skips  # noqa: E402

try:
    import jsonschema
except ImportError:
    skips.leave("/usr/bin/python3 has no jsonschema (Debian: python3-jsonschema)")

CONFIG = pathlib.Path(__file__).resolve().parents[2] / "config"

# As the end-to-end tests have them.
FIELD_ROBOTS = ["conveyor", "drone", "pioneer", "ridgeback", "turtlebot"]
FIELD = "../tests/support/robots/"

SHIPPED = {
    "network": ["network.json"],
    "profile": ["profile.json"],
    "commands": ["commands.json"],
    "places": ["places.json"],
    "robot": sorted(path.relative_to(CONFIG) for path in (CONFIG / "robots").glob("*.json"))
             + [f"{FIELD}{robot}.json" for robot in FIELD_ROBOTS],
    "sensor": sorted(path.relative_to(CONFIG) for path in (CONFIG / "sensors").glob("*.json")),
    "resilience": sorted(path.relative_to(CONFIG) for path in (CONFIG / "resilience").glob("*.json")),
    "cloud": sorted(path.relative_to(CONFIG) for path in (CONFIG / "cloud").glob("*.json")),
    "metrics": sorted(path.relative_to(CONFIG) for path in (CONFIG / "metrics").glob("*.json")),
    "rank": sorted(path.relative_to(CONFIG) for path in (CONFIG / "rank").glob("*.json")),
    "scenario": sorted(path.relative_to(CONFIG) for path in (CONFIG / "scenarios").glob("*.json")),
}

ROBOT_NODE = {
    "id": "ur3",
    "framework": "ur",
    "description": "robots/ur3.json",
    "robot": {"host": "192.168.1.20", "interface": "eth1", "fault_injection": "127.0.0.1:6000"},
    "seeds": [{"address": "10.0.0.1:45000", "key": "0" * 64}],
    "beacon": True,
    "services": ["router", "mode-adapter", "scheduler"],
    "own_services": {"fault-tally": "bin/fault-tally"},
}
CLOUD_NODE = {
    "id": "cloud",
    "role": "cloud",
    "services": ["router", "scheduler", "cloud-gateway"],
    "bus": "tcp://10.0.0.1:46000",
}

SESSIONS = {
    "abb-rws": {
        "transport": "http-json", "port": 80, "body": "form", "cookies": True, "sign_out": "GET /logout",
        "headers": {"_comment": "of its own", "X-Key": "1"}, "tls": {"fingerprint": ":".join(["AB"] * 32)}, "commands": {"stop": "POST /stop a=b"},
    },
}

FAULTY = {
    "maker": "M",
    "model": "m",
    "capabilities": ["mobile"],
    "skills": {},
    "faults": {
        "low": {"value": "battery", "below": 20, "rearm": 25, "severity": "WARNING", "capability": "mobile"},
        "stuck": {"value": "state", "equals": "stuck", "severity": "CRITICAL", "text": "it is stuck"},
        "moved": {"value": "error", "changes": True, "severity": "FATAL"},
    },
    "sensors": ["battery", "state"],
}

# Schema, good file (or document), path of the value, its bad replacement (None: removed).
BAD = [
    ("node", ROBOT_NODE, ["id"], "R 1"),
    ("node", ROBOT_NODE, ["framework"], None),
    ("node", ROBOT_NODE, ["becon"], True),
    ("node", ROBOT_NODE, ["robot", "host"], "the-robot"),
    ("node", ROBOT_NODE, ["robot", "fault_injection"], "6000"),
    ("node", ROBOT_NODE, ["seeds", 0, "key"], "12"),
    ("node", ROBOT_NODE, ["bus"], "tcp"),
    ("node", ROBOT_NODE, ["bus"], "tcp://router:46000"),
    ("node", ROBOT_NODE, ["services"], ["scheduler"]),
    ("node", ROBOT_NODE, ["services"], ["router", "resilient"]),
    ("node", ROBOT_NODE, ["own_services"], ["fault-tally"]),
    ("node", ROBOT_NODE, ["own_services", "fault-tally"], ""),
    ("node", ROBOT_NODE, ["own_services", "scheduler"], "bin/scheduler"),
    ("node", ROBOT_NODE, ["own_services", "Fault Tally"], "bin/fault-tally"),
    ("node", CLOUD_NODE, ["framework"], "ur"),
    ("node", CLOUD_NODE, ["services"], ["router", "mode-adapter"]),
    ("node", ROBOT_NODE, ["services"], ["router", "cloud-gateway"]),
    ("network", "network.json", ["TCP_PORT"], 70000),
    ("network", "network.json", ["HOST_INT"], None),
    ("network", "network.json", ["HOST_INTERFACE"], "eth0"),
    ("profile", "profile.json", ["ur"], "serial"),
    ("commands", "commands.json", ["ur", "port"], "30002"),
    ("commands", "commands.json", ["ur", "language"], "plain"),
    ("commands", "commands.json", ["ur", "monitor", "port"], None),
    ("commands", "commands.json", ["ur", "comands"], {}),
    ("commands", "commands.json", ["ur", "commands", "move"], 1),
    ("commands", "commands.json", ["ur", "unit"], 1),
    ("commands", "commands.json", ["plc", "unit"], 250),
    ("commands", "commands.json", ["plc", "poll_s"], 0),
    ("commands", "commands.json", ["plc", "cookies"], True),
    ("commands", SESSIONS, ["abb-rws", "body"], "xml"),
    ("commands", SESSIONS, ["abb-rws", "cookies"], 1),
    ("commands", SESSIONS, ["abb-rws", "headers", "A b"], "1"),
    ("commands", SESSIONS, ["abb-rws", "headers", "X-Key"], 1),
    ("commands", SESSIONS, ["abb-rws", "tls"], {}),
    ("commands", SESSIONS, ["abb-rws", "tls", "fingerprint"], "AB:CD"),
    ("commands", SESSIONS, ["abb-rws", "tls", "name"], "abb"),
    ("commands", SESSIONS, ["abb-rws", "tls", "verify"], False),
    ("commands", "commands.json", ["dobot", "answer_end"], ""),
    ("commands", "commands.json", ["dobot", "good"], "0,*"),
    ("commands", "commands.json", ["plc", "keep_alive"], "PING"),
    ("places", "places.json", ["places", "dock", "x"], None),
    ("places", "places.json", ["places", "Dock"], {"x": 0, "y": 0}),
    ("robot", FIELD + "ridgeback.json", ["skills", "go_to", "end"], None),
    ("robot", FIELD + "ridgeback.json", ["skills", "go_to", "end", "kind"], "ready"),
    ("robot", FIELD + "ridgeback.json", ["skills", "go_to", "end", "duration_s"], 1),
    ("robot", FIELD + "ridgeback.json", ["skills", "go_to", "timeout_s"], 0),
    ("robot", FIELD + "ridgeback.json", ["skills", "go_to", "command", "subtype"], "stop"),
    ("robot", FIELD + "ridgeback.json", ["skills", "go_to", "parameters", "place", "minimum"], 1),
    ("robot", FIELD + "ridgeback.json", ["field_channel", "framing"], "tab"),
    ("robot", FIELD + "drone.json", ["skills", "hover", "parameters", "duration", "unit"], "deg"),
    ("robot", "robots/abb-numeric-example.json", ["field_channel", "chunk_bytes"], 1),
    ("robot", "robots/abb-numeric-example.json", ["field_channel", "codes", "subtypes", "done"], 0),
    ("robot", "robots/pioneer.json", ["drives", 0, "part"], "wheels"),
    ("robot", "robots/pioneer.json", ["drives", 0, "capability"], None),
    ("robot", "robots/pioneer.json", ["drives", 0, "axes"], {}),
    ("robot", "robots/pioneer.json", ["drives", 0, "axes", "x"], 0),
    ("robot", "robots/pioneer.json", ["drives", 0, "axes", "w"], 1),
    ("robot", "robots/pioneer.json", ["drives", 0, "command", "subtype"], "stop"),
    ("robot", "robots/pioneer.json", ["drives", 0, "stand", "subtype"], None),
    ("robot", "robots/conveyor.json", ["drives", 0, "axes", "y"], 1),
    ("robot", "robots/drone.json", ["drives", 0, "axes", "z", "factor"], 0),
    ("robot", "robots/drone.json", ["drives", 0, "axes", "z", "limit"], None),
    ("robot", FAULTY, ["faults", "low", "above"], 90),
    ("robot", FAULTY, ["faults", "low", "below"], None),
    ("robot", FAULTY, ["faults", "low", "severity"], "BAD"),
    ("robot", FAULTY, ["faults", "low", "value"], None),
    ("robot", FAULTY, ["faults", "moved", "changes"], False),
    ("robot", FAULTY, ["sensors"], ["battery", "battery"]),
    ("sensor", "sensors/iio.json", ["match", "subsystem"], None),
    ("sensor", "sensors/iio.json", ["match", "vendor"], "x"),
    ("sensor", "sensors/iio.json", ["read"], "sysfs"),
    ("sensor", "sensors/iio.json", ["sensors", 0, "channel"], None),
    ("sensor", "sensors/iio.json", ["sensors", 0, "channel"], "../power/control"),
    ("sensor", "sensors/iio.json", ["sensors", 0, "name"], "in-temp"),
    ("sensor", "sensors/iio.json", ["sensors", 0, "pattern"], "T"),
    ("sensor", "sensors/hwmon.json", ["match", "attributes", "name"], []),
    ("sensor", "sensors/gps.json", ["baud"], 9601),
    ("sensor", "sensors/gps.json", ["sensors", 0, "value"], "height"),
    ("sensor", "sensors/line.json", ["sensors", 0, "field"], 1),
    ("sensor", "sensors/line.json", ["identity", "attribute"], "serial"),
    ("sensor", "sensors/camera.json", ["sensors", 0, "every_s"], 1),
    ("sensor", "sensors/w1.json", ["timeout_s"], 0),
    ("resilience", "resilience/automatic.json", ["criteria", "battery"], -1),
    ("resilience", "resilience/automatic.json", ["criteria", "charge"], 1),
    ("resilience", "resilience/automatic.json", ["judgments"], [["battery", "distance", 3], ["distance", "availability", 2]]),
    ("resilience", "resilience/automatic.json", ["policy", "mode"], "never"),
    ("resilience", "resilience/automatic.json", ["policy", "conditions", "max_severity"], "BAD"),
    ("resilience", "resilience/automatic.json", ["policy", "conditions", "min_lead"], 2),
    ("resilience", "resilience/automatic.json", ["expires_s"], 0),
    ("resilience", "resilience/automatic.json", ["policy", "max_moves"], 17),
    ("resilience", "resilience/payload.json", ["criteria", "payload"], 2),
    ("resilience", "resilience/payload.json", ["criteria", "payload", "from"], None),
    ("resilience", "resilience/payload.json", ["criteria", "payload", "best"], None),
    ("resilience", "resilience/payload.json", ["criteria", "payload", "bast"], 1),
    ("resilience", "resilience/payload.json", ["criteria", "battery", "from"], "robot"),
    ("resilience", "resilience/payload.json", ["criteria", "Pay load"], {"from": "robot", "best": 1, "worst": 0}),
    ("resilience", "resilience/payload.json", ["criteria", "payLoad"], {"from": "robot", "best": 1, "worst": 0}),
    ("resilience", "resilience/figure-8.json", ["criteria"], {"battery": {"weight": 1}}),
    ("resilience", "resilience/figure-8.json", ["judgments", 0, 2], 0),
    ("resilience", "resilience/figure-8.json", ["judgments", 0], ["distance", "battery"]),
    ("cloud", "cloud/every-interface.json", ["listen"], "hall.example:8443"),
    ("cloud", "cloud/every-interface.json", ["listen"], 8443),
    ("cloud", "cloud/every-interface.json", ["names"], "hall.example"),
    ("cloud", "cloud/every-interface.json", ["names", 0], "Hall Example"),
    ("cloud", "cloud/every-interface.json", ["proxies"], ["proxy.example"]),
    ("cloud", "cloud/every-interface.json", ["proxies"], "10.0.0.7"),
    ("cloud", "cloud/every-interface.json", ["port"], 8443),
    ("metrics", "metrics/this-machine.json", ["listen"], "0.0.0.0:9464"),
    ("metrics", "metrics/this-machine.json", ["listen"], 9464),
    ("metrics", "metrics/this-machine.json", ["port"], 9464),
    ("rank", "rank/paper-figure-8.json", ["goal"], None),
    ("rank", "rank/paper-figure-8.json", ["criteria", 1, "direction"], "less"),
    ("rank", "rank/paper-figure-8.json", ["judgments", "replace ridgeback", 0, 2], 0),
    ("rank", "rank/paper-figure-8.json", ["judgments", "replace ridgeback", 0], ["distance", "battery"]),
    ("rank", "rank/paper-figure-8.json", ["alternatives", 0, "values", "battery"], -1),
    ("rank", "rank/paper-figure-8.json", ["alternatives"], []),
    ("rank", "rank/paper-figure-8.json", ["people"], []),
    ("scenario", "scenarios/paper-nine-tasks.json", ["tasks", 0, "robot"], None),
    ("scenario", "scenarios/find-and-fetch.json", ["tasks", 1, "requires"], None),
    ("scenario", "scenarios/find-and-fetch.json", ["tasks", 1, "requires"], []),
    ("scenario", "scenarios/find-and-fetch.json", ["tasks", 1, "requires"], ["carry", "carry"]),
    ("scenario", "scenarios/find-and-fetch.json", ["tasks", 1, "data", "from", "from"], None),
    ("scenario", "scenarios/find-and-fetch.json", ["tasks", 1, "data", "from", "value"], ""),
    ("scenario", "scenarios/find-and-fetch.json", ["tasks", 1, "data", "from", "name"], "place"),
    ("scenario", "scenarios/find-and-fetch.json", ["tasks", 0, "retries"], 17),
    ("scenario", "scenarios/find-and-fetch.json", ["tasks", 0, "retry_after_s"], 0),
    ("scenario", "scenarios/find-and-fetch.json", ["tasks", 2, "on_failure"], "ignore"),
    ("scenario", "scenarios/find-and-fetch.json", ["tasks", 0, "start_within_s"], 0),
    ("scenario", "scenarios/find-and-fetch.json", ["tasks", 0, "start_within_s"], 86401),
    ("scenario", "scenarios/find-and-fetch.json", ["repeat"], 0),
    ("scenario", "scenarios/paper-nine-tasks.json", ["tasks", 1, "after"], "fetch_box"),
    ("scenario", "scenarios/paper-nine-tasks.json", ["tasks"], []),
    ("scenario", "scenarios/paper-temperature.json", ["tasks", 5, "when", "op"], "=>"),
    ("scenario", "scenarios/paper-temperature.json", ["tasks", 5, "when", "unit"], None),
    ("scenario", "scenarios/paper-temperature.json", ["tasks", 5, "when", "value"], "warm"),
]

failures = []


def load(name):
    with open(CONFIG / name, encoding="utf-8") as file:
        return json.load(file)


def validator(name):
    schema = load(f"schemas/{name}.schema.json")
    jsonschema.Draft202012Validator.check_schema(schema)
    return jsonschema.Draft202012Validator(schema)


def expect_good(name, what, document):
    for error in validator(name).iter_errors(document):
        failures.append(f"{what}: {error.json_path}: {error.message}")


def expect_bad(name, good, path, value):
    document = copy.deepcopy(good) if isinstance(good, dict) else load(good)
    place = document
    for key in path[:-1]:
        place = place[key]
    if value is None:
        del place[path[-1]]
    else:
        place[path[-1]] = value
    if validator(name).is_valid(document):
        failures.append(f"schema {name}: {path} = {value!r} was not refused")


def main():
    count = 0
    for name, files in SHIPPED.items():
        for file in files:
            expect_good(name, str(file), load(file))
            count += 1
    for what, node in (("a robot's node", ROBOT_NODE), ("a cloud node", CLOUD_NODE)):
        expect_good("node", what, node)
    expect_good("robot", "a robot with faults", FAULTY)
    expect_good("commands", "a robot with sessions", SESSIONS)
    for case in BAD:
        expect_bad(*case)
    known = {f"{name}.schema.json" for name in (*SHIPPED, "node")}
    for path in (CONFIG / "schemas").iterdir():
        if path.name not in known:
            failures.append(f"{path.name}: no test reads this schema")
    print("\n".join(failures) or f"{count} files and {len(BAD)} faults: all as expected")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
