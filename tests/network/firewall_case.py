"""The handbook's firewall and the router's rule against floods, as they stand there, on every host: the fleet forms and heals
behind them, and no other door is open."""
import pathlib
import subprocess
import sys
import time

REPO = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(REPO / "tests/integration"))

import lab as lab_of  # noqa: E402
import shell_blocks  # noqa: E402
from cases import NODES, addresses_of, case  # noqa: E402
from lab import Lab  # noqa: E402
from net_fleet import NetFleet  # noqa: E402
from trb_process import wait_until  # noqa: E402

PAGES = REPO / "deploy/handbook/network.md", REPO / "services/router/README.md"
SSH, FLEET, LANES, ROBOT = 22, 45000, 45001, 40000
TOPICS = 33333  # where a process on ROS might listen, and the network page's rule for such a robot
FOR_ROS = "1024-65535"
FLOOD = 600
WALL = "wall"  # a host that accepts whatever its rules let through
NODE_SIDE, ARM, OTHER = "192.168.1.1", "192.168.1.5", "192.168.1.6"
LISTEN = """
import socket, sys
doors = [socket.create_server((address, int(port)), backlog=1024) for address, port in (word.rsplit(":", 1) for word in sys.argv[1:])]
print("ready", flush=True)
sys.stdin.read()
"""


def blocks():
    return [block.text for page in PAGES for block in shell_blocks.blocks_of(page) if block.text.startswith("nft ")]


def rules():
    """The block of each page that loads rules: the firewall, the rule against floods. Its robot's address is the arm's here."""
    found = [text for text in blocks() if FOR_ROS not in text]
    if len(found) != len(PAGES) or ARM not in found[0]:
        raise RuntimeError(f"{len(found)} blocks of nft in {', '.join(page.name for page in PAGES)}, or none for the robot {ARM}")
    return "".join(found)


def rule_for_ros():
    """What a robot on ROS needs besides."""
    rule, = (text for text in blocks() if FOR_ROS in text)
    return rule


def add_robot_network(lab, node):
    """The node's second interface, with its robot and another machine on it."""
    arm = lab.make_space(lab.space("arm"))
    at = lab.space(node)
    lab_of.batch([f"link add eth1 netns {at} type veth peer name eth0 netns {arm}",
                  f"-n {at} addr add {NODE_SIDE}/24 dev eth1", f"-n {at} link set eth1 up",
                  f"-n {arm} addr add {ARM}/24 dev eth0", f"-n {arm} addr add {OTHER}/24 dev eth0", f"-n {arm} link set eth0 up"])


def listen(lab, host, *doors):
    """A program on that host which accepts at these addresses, until the lab ends."""
    program = subprocess.Popen(lab.inside(host, sys.executable, "-c", LISTEN, *doors), stdin=subprocess.PIPE,
                               stdout=subprocess.PIPE, text=True)
    lab.helpers.append(program)
    if program.stdout.readline() != "ready\n":
        raise RuntimeError(f"nothing listens on {doors}")


def reaches(lab, host, address, port, source=""):
    code = (f"import socket; socket.create_connection(('{address}', {port}), 1.5, "
            f"{(source, 0) if source else None}).close()")
    return subprocess.run(lab.inside(host, sys.executable, "-c", code), capture_output=True).returncode == 0


def flood(lab, host, address, count):
    """How many of so many connections at once were accepted within a second."""
    code = f"""
import select, socket
each = [socket.socket() for _ in range({count})]
for one in each:
    one.setblocking(False)
    one.connect_ex(('{address}', {FLEET}))
poll = select.poll()
for one in each:
    poll.register(one, select.POLLOUT)
open_ones = set()
while ready := [fd for fd, _ in poll.poll(700) if fd not in open_ones]:
    for fd in ready:
        poll.unregister(fd)
        open_ones.add(fd)
print(len(open_ones))"""
    return int(subprocess.run(lab.inside(host, sys.executable, "-c", code), capture_output=True, text=True, check=True).stdout)


def doors(lab, node, ports=(SSH, FLEET, LANES, ROBOT)):
    """What can be reached on the node: (from, port)."""
    near = [("fleet", "bee", lab.address(node), ""), ("robot", "arm", NODE_SIDE, ARM), ("another", "arm", NODE_SIDE, OTHER)]
    return {(name, port) for name, host, address, source in near for port in ports
            if reaches(lab, host, address, port, source)}


def pull_cables(report, rounds, lab, node):
    """Round after round the node has no cable for 3 s: nothing is waited for, it lasts so long."""
    for number in range(1, rounds + 1):
        lab.pull_cable(node)
        time.sleep(3)
        lab.plug_cable(node)
        report.healed(number, rounds, time.monotonic())


@case("firewall-ipv6", 3, 1)
def firewall_six(report, rounds):
    """The same rules without IPv4: who may not ask for a neighbour's hardware address reaches nobody."""
    with Lab(report.tag) as lab:
        lab.add_hosts(NODES, family=6)
        for node in NODES:
            subprocess.run(lab.inside(node, "bash", "-ec", rules()), check=True)
        with report.standing(NetFleet(lab, {node: "eth0" for node in NODES})):
            pull_cables(report, rounds, lab, NODES[0])


@case("firewall", 3, 1)
def firewall(report, rounds):
    """The fleet forms and heals behind the handbook's rules; besides its doors, and the robot's, all are closed."""
    ant = NODES[0]
    with Lab(report.tag) as lab:
        lab.add_hosts([*NODES, WALL])
        add_robot_network(lab, ant)
        # For what listens on a computer besides the router, which takes the host's address alone.
        listen(lab, ant, f"0.0.0.0:{SSH}", f"0.0.0.0:{ROBOT}", f"{NODE_SIDE}:{FLEET}", f"{NODE_SIDE}:{LANES}", f"0.0.0.0:{TOPICS}")
        listen(lab, WALL, f"0.0.0.0:{FLEET}")
        fleet = NetFleet(lab, addresses_of(NODES))
        for node in (*NODES, WALL):
            subprocess.run(lab.inside(node, "bash", "-ec", rules()), check=True)
        with report.standing(fleet):
            expected = {("fleet", FLEET), ("fleet", LANES), ("robot", ROBOT)}
            found = doors(lab, ant)
            if found != expected:
                report.fail(f"open on {ant}: {sorted(found)}; the rules are for {sorted(expected)}")
            without = doors(lab, ant, [TOPICS])
            subprocess.run(lab.inside(ant, "bash", "-ec", rule_for_ros()), check=True)
            found = doors(lab, ant, [TOPICS])
            if (without, found) != (set(), {("robot", TOPICS)}):
                report.fail(f"open on {ant} for a robot on ROS: {sorted(found)}, without its rule {sorted(without)}")
            pull_cables(report, rounds, lab, ant)
            admitted = flood(lab, "bee", lab.address(WALL), FLOOD)
            report.notes["flood_admitted"] = admitted
            if not 150 < admitted < FLOOD * 2 / 3:
                report.fail(f"{admitted} of {FLOOD} connections at once were let in; the rule is for 200 and 50 a second")
            subprocess.run(lab.inside(ant, "nft", "delete", "table", "inet", "trb"), check=True)
            if wait_until(lambda: ("another", SSH) in doors(lab, ant), 5) is None:
                report.fail("without the rules nothing else is open: the listeners were not there")
