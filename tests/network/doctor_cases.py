"""What `trb doctor` must name where only a network can be at fault."""
import json
import subprocess
import time

from cases import NODES, case, four
from net_fleet import PROGRAMS
from trb_process import wait_until


def findings(fleet, node, *peer):
    """The report for a person at that host."""
    command = fleet.lab.inside(node, PROGRAMS / "trb", "doctor", *peer, "--json", "--node", fleet.dir(node))
    done = subprocess.run(command, capture_output=True, text=True, timeout=60)
    of_the_machine = {"clock_not_set", "disk_low", "few_inodes"}  # that runs the test
    return [row for row in json.loads(done.stdout)["findings"] if row["cause"] not in of_the_machine]


def expect(report, fleet, node, cause, subject, *peer):
    """Waits until the doctor of `node` names it, as a problem with a cure."""
    seen = []

    def named():
        seen[:] = findings(fleet, node, *peer)
        return any(f["cause"] == cause and f["subject"] == subject and f["cure"] for f in seen)

    took = wait_until(named, 30, 0.5)
    if took is None:
        report.fail(f"the doctor of {node} does not name {cause} of {subject}: {seen}")
    else:
        report.say(f"the doctor of {node} names {cause} of {subject}")


@case("doctor", 2, 1)
def doctor(report, rounds):
    """A one-way cut, and a path on which large frames vanish: under a link that is up, and before one can be."""
    ant, bee, cat = NODES[:3]
    with four(report) as (lab, fleet):
        before = findings(fleet, ant)
        if before:
            report.fail(f"the doctor of {ant} finds something where all is well: {before}")
        for number in range(1, rounds + 1):
            lab.one_way_cut(ant)
            expect(report, fleet, ant, "one_way", bee, bee)
            lab.heal_rules()
            report.healed(number, rounds, time.monotonic())
            lab.drop_large(bee, 700)
            expect(report, fleet, ant, "mtu", bee, bee)
            lab.heal_rules()
            report.healed(number, rounds, time.monotonic())
            lab.pull_cable(cat)
            expect(report, fleet, ant, "silent", cat, cat)
            lab.plug_cable(cat)
            report.healed(number, rounds, time.monotonic())
