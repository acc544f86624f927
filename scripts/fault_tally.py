"""What many rounds of faults have come to, as figures and for people."""
import statistics
from collections import Counter


def say(text=""):
    print(text, flush=True)


def text_of(row):
    kill, fault = row["kill"], row["fault"]
    out = f"round {row['round']:3d}  {kill['at_s']:5.2f} s kill {kill['who']}"
    if fault:
        out += f"; {fault['at_s']:.2f} s {fault['severity']} {fault['robot']} {fault['capability']}"
    out += f"  ->  {row.get('state', '?')} in {row.get('run_s', 0):.1f} s"
    if row.get("state") == "PAUSED":
        out += f" ({row['waits_for']}); then {row.get('after_words', '?')}"
    return out + "".join(f"\n           BROKEN {text}" for text in row["broken"])


KINDS = {"twice": "tasks commanded twice", "lost": "results lost", "apart": "views that disagree",
         "end": "ends without a reason", "word": "runs that a person's words did not end", "heal": "fleets that did not heal",
         "script": "rounds that the script did not finish"}


def tally_of(rows, usual_s):
    broken = Counter(text.split(":")[0] for row in rows for text in row["broken"])
    states = Counter((bool(row["fault"]), row.get("state", "unknown")) for row in rows)
    killed = Counter(row["kill"]["who"].split(" ", 1)[1] for row in rows)
    healed = [row["healed_s"] for row in rows if "healed_s" in row]
    return {"rounds": len(rows), "usual_run_s": round(usual_s, 2),
            "rounds_with_a_fault": sum(bool(row["fault"]) for row in rows),
            "ends": {"kill": {s: n for (f, s), n in sorted(states.items()) if not f},
                     "kill_and_fault": {s: n for (f, s), n in sorted(states.items()) if f}},
            "after_words": dict(Counter(row["after_words"] for row in rows if "after_words" in row)),
            "decisions": sum(max(row.get("epoch", 1), 1) - 1 for row in rows),
            "killed": dict(killed.most_common()),
            "killed_of_the_cloud": sum(row["kill"]["who"].startswith("cloud") for row in rows),
            "healed_s": {"median": statistics.median(healed), "most": max(healed)} if healed else {},
            "broken": {kind: broken[kind] for kind in KINDS},
            "rounds_broken": sum(bool(row["broken"]) for row in rows)}


def print_tally(tally):
    say(f"\n== {tally['rounds']} rounds, {tally['rounds_with_a_fault']} of them with a robot's fault; "
        f"the usual run takes {tally['usual_run_s']} s")
    for kind, ends in tally["ends"].items():
        say(f"  {kind.replace('_', ' '):15} " + ", ".join(f"{n} {state}" for state, n in ends.items()))
    if tally["after_words"]:
        say("  PAUSED, then a person's word: " + ", ".join(f"{n} {state}" for state, n in tally["after_words"].items()))
    say(f"  decisions (epochs) in the runs before any person's word: {tally['decisions']}")
    say("  killed: " + ", ".join(f"{n} {who}" for who, n in tally["killed"].items())
        + f"; {tally['killed_of_the_cloud']} of them the cloud's")
    if tally["healed_s"]:
        say(f"  whole again after the round: median {tally['healed_s']['median']:.1f} s, "
            f"at most {tally['healed_s']['most']:.1f} s")
    for kind, what in KINDS.items():
        say(f"  {what}: {tally['broken'][kind]}")
