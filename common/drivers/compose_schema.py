#!/usr/bin/python3
"""config/schemas/commands.schema.json is made of schema.base.json and of every driver's schema.json.

compose_schema.py          compares: prints what differs, exits with 1
compose_schema.py --write  writes it

A driver's part, all of it optional:
  monitors, languages, wraps   names that it adds to those enumerations
  keys                         keys of commands.json of its own; one of several drivers has a number's limits and default
  rules                        schemas that a vendor's part must match
"""
import copy
import json
import pathlib
import re
import sys

HERE = pathlib.Path(__file__).resolve().parent
WHOLE = HERE.parents[1] / "config" / "schemas" / "commands.schema.json"


def names():
    """As registry.cpp lists them."""
    rows = re.findall(r"ROW\((\w+)_row\)", (HERE / "registry.cpp").read_text(encoding="utf-8"))
    return [row.replace("_", "-") for row in rows]


def parts():
    out = {}
    for name in names():
        path = HERE / name / "schema.json"
        out[name] = json.loads(path.read_text(encoding="utf-8")) if path.exists() else {}
    return out


def shared_number(keys):
    """A number that several drivers take: its widest limits, and each one's own in the text."""
    def own(name, key):
        return f"{name} {key['minimum']} to {key['maximum']} ({key['default']})"
    first = next(iter(keys.values()))
    return {
        "description": f"{first['description']}: " + ", ".join(own(name, key) for name, key in keys.items()),
        "type": "number",
        "minimum": min(key["minimum"] for key in keys.values()),
        "maximum": max(key["maximum"] for key in keys.values()),
    }


def own_key(name, key):
    return {**key, "description": f"{name}: {key['description']}"}


def key_rules(owners):
    """That a key stands only with the transports that have it; one rule for all keys of the same ones."""
    groups = {}
    for key, who in owners.items():
        groups.setdefault(tuple(who), []).append(key)
    for who, keys in groups.items():
        needs = [{"required": [key]} for key in keys]
        transport = {"const": who[0]} if len(who) == 1 else {"enum": list(who)}
        yield {
            "if": needs[0] if len(needs) == 1 else {"anyOf": needs},
            "then": {"properties": {"transport": transport}, "required": ["transport"]},
        }


def compose(base, drivers):
    whole = copy.deepcopy(base)
    (vendor,) = whole["patternProperties"].values()
    properties = vendor["properties"]
    properties["transport"]["enum"] += list(drivers)
    keys = {}
    for name, part in drivers.items():
        properties["monitor"]["properties"]["protocol"]["enum"] += part.get("monitors", [])
        properties["language"]["enum"] += part.get("languages", [])
        properties["wrap"]["enum"] += part.get("wraps", [])
        for key, schema in part.get("keys", {}).items():
            keys.setdefault(key, {})[name] = schema
    comment = properties.pop("_comment")
    for key, owned in keys.items():
        properties[key] = own_key(*next(iter(owned.items()))) if len(owned) == 1 else shared_number(owned)
    properties["_comment"] = comment
    vendor["allOf"] += list(key_rules({key: list(owned) for key, owned in keys.items()}))
    vendor["allOf"] += [rule for part in drivers.values() for rule in part.get("rules", [])]
    return whole


def main():
    base = json.loads((HERE / "schema.base.json").read_text(encoding="utf-8"))
    text = json.dumps(compose(base, parts()), indent=2, ensure_ascii=False) + "\n"
    if sys.argv[1:] == ["--write"]:
        WHOLE.write_text(text, encoding="utf-8")
        return 0
    if WHOLE.read_text(encoding="utf-8") == text:
        print("the schema of commands.json is made of its parts")
        return 0
    print(f"{WHOLE} is not what its parts make: run common/drivers/compose_schema.py --write", file=sys.stderr)
    return 1


if __name__ == "__main__":
    sys.exit(main())
