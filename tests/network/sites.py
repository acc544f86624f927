"""Fleets over more than one network: several subnets by seeds, a robot behind a VPN that is lost and comes back."""
import time

from cases import LEASE_S, NODES, case, fleet_with_seeds
from doctor_cases import expect, findings
from lab import Lab
from net_fleet import NetFleet
from trb_process import wait_until

HERE, THERE = NODES[:2], NODES[2:]


def two_halls(lab, relay):
    lab.add_hosts(HERE)
    lab.add_hall(THERE)
    return NetFleet(lab, {name: None for name in NODES}, more={relay: {"relay": True}} if relay else {})


@case("subnets", 5, 1)
def subnets(report, rounds):
    """Two halls, two subnets: whoever is in the second names one seed in the first. The way between them is cut."""
    with Lab(report.tag) as lab:
        fleet = two_halls(lab, relay=HERE[0])
        with fleet_with_seeds(report, fleet, NODES, {name: HERE[:1] for name in THERE}):
            for number in range(1, rounds + 1):
                lab.pull_cable("gate")
                time.sleep(LEASE_S + 3)
                near = fleet.witness.tables(time.monotonic() - 1).get(HERE[0], {})
                if near.get(HERE[1], {}).get("state") != "ONLINE":
                    report.fail(f"round {number}: the cut between the halls took {HERE[1]} from its neighbour")
                lab.plug_cable("gate")
                report.healed(number, rounds, time.monotonic())


@case("vpn", 5, 1)
def vpn(report, rounds):
    """A robot that only a tunnel of the cloud reaches: the others talk to it by the cloud. The tunnel is lost, and comes."""
    cloud, far = "cat", "dog"
    with Lab(report.tag) as lab:
        lab.add_hosts([n for n in NODES if n != far])
        lab.add_far_host(far)
        lab.raise_tunnel(cloud, far)
        fleet = NetFleet(lab, {**{n: None for n in NODES}, far: "tun0"}, more={n: {"relay": n == cloud} for n in NODES},
                         network={cloud: {"VPN_INT": "tun0"}})
        # What crosses no tunnel is reached by the cloud, and nothing else is.
        report.via = {(near, far): cloud for near in NODES if near not in (cloud, far)}
        links = {n: 1 if n == far else 3 if n == cloud else 2 for n in NODES}
        make = fleet.make

        def make_with_seed():
            make()
            fleet.change_node_json(far, seeds=[fleet.seed(cloud, f"10.88.0.{lab.hosts[cloud]}")])
        fleet.make = make_with_seed
        with report.standing(fleet, links=links, via=report.via):
            for number in range(1, rounds + 1):
                lab.drop_tunnel(cloud)
                took = wait_until(lambda: is_lost(fleet, far), LEASE_S + 6)
                if took is None:
                    report.fail(f"round {number}: {far} is still ONLINE {LEASE_S + 6:.0f} s after the tunnel's end")
                lab.raise_tunnel(cloud, far)
                report.healed(number, rounds, time.monotonic())
            report.notes["relayed"] = fleet.counters(cloud).get("relayed.sent", 0)


def is_lost(fleet, far):
    tables = fleet.witness.tables(time.monotonic() - 1)
    return all(table.get(far, {}).get("state") == "OFFLINE" for name, table in tables.items() if name != far)


@case("doctor-subnet", 1, 1)
def doctor_subnet(report, rounds):
    """Another subnet that no seed names: the doctor says so, and what it tells to do is the cure."""
    with Lab(report.tag) as lab:
        fleet = two_halls(lab, relay=None)
        there = f"{lab.address(THERE[0])}:45000"
        with fleet:
            fleet.start_all()
            report.fleet, report.links = fleet, None
            wait_until(lambda: fleet.witness.tables(), 10)
            expect(report, fleet, HERE[0], "other_subnet", there, there)
            since = time.monotonic()
            for name in HERE:
                fleet.stop_router(name)
                fleet.change_node_json(name, seeds=[fleet.seed(other) for other in THERE])
                fleet.start_router(name)
            report.healed(1, 1, since)
            left = findings(fleet, HERE[0], there)
            if any(found["cause"] == "other_subnet" for found in left):
                report.fail(f"the seed is there and the doctor still says other_subnet: {left}")
