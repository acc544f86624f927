"""A fleet on one machine: node folders, keys, services and virtual robots, for the demo and the end-to-end tests.

Each node has its own address 127.0.BLOCK.i, each virtual robot 127.0.BLOCK+1.i, so that every node uses the same ports.
Everything that is started ends with this process, however it ends.
"""
import json
import os
import pathlib
import pwd
import secrets
import select
import shutil
import signal
import socket
import subprocess
import time

from trb_process import Process, end_with_parent, run_main  # noqa: F401  (for whoever has a fleet)

REPO = pathlib.Path(__file__).resolve().parent.parent
ROBOTS = {
    # name: (framework, description, arguments of its virtual robot)
    "ridgeback": ("lines", "ridgeback", ["--skill", "fetch=4", "--skill", "load_out=2", "--pose", "0,0,0"]),
    "ur3": ("ur", "ur3", []),
    "pioneer1": ("lines", "pioneer", ["--pose", "1,3,0"]),
    "pioneer2": ("lines", "pioneer", ["--pose", "2,3,0"]),
    "turtlebot": ("lines", "turtlebot", ["--pose", "3,3,0"]),
    "drone": ("lines", "drone", ["--skill", "take_off=2", "--skill", "land=2", "--skill", "hover=2"]),
    "conveyor": ("lines", "conveyor", ["--skill", "run=3"]),
}
# The demonstration's: each robot over its maker's protocol, but pioneer2, which is reached field by field, as in the
# paper's Figure 4: a program on it (config/robots/c/pioneer.c) takes the fields and drives it by ARCOS.
DEMO_ROBOTS = {
    "ridgeback": ("ridgeback", "ridgeback", ["--arm", "--pose", "0,0,0"]),
    "ur3": ("ur", "ur3", []),
    "pioneer1": ("pioneer", "pioneer", ["--name", "pioneer1", "--pose", "1,3,0"]),
    "pioneer2": ("pioneer-fields", "pioneer-fields", ["--name", "pioneer2", "--pose", "2,3,0"]),
    "turtlebot": ("ros", "turtlebot", ["--pose", "3,3,0"]),
    "drone": ("ardrone", "drone", []),
    "conveyor": ("plc", "conveyor", ["--bring-boxes"]),
    "abb1": ("abb", "abb", []),
    "kuka1": ("kuka", "kuka", []),
}
CLOUD = "cloud"
ON_BOARD = {"pioneer-fields": ("pioneer", "trb-field-pioneer", 8101)}  # its virtual robot, the program on it, its port
ROS = ("ros", "ridgeback")  # frameworks that are reached over a ROS master
CONTROL_PORT = 46000  # where a virtual robot is told to fail
LONG_S = 60  # a deadline, not a measurement: for a starved machine
QUESTIONS = {("alert", "list"), ("robot", "history"), ("robot", "list"), ("route", "list"), ("run", "list"), ("run", "show"),
             ("sensor", "list"), ("service", "counters"), ("service", "list")}  # they change nothing: asked again, they do no harm


def plc_port():
    """Modbus' own port, or 1502 for a user who may not take one below 1024."""
    first = int(pathlib.Path("/proc/sys/net/ipv4/ip_unprivileged_port_start").read_text())
    return 502 if os.geteuid() == 0 or first <= 502 else 1502


def user():
    """The name of who runs this."""
    return pwd.getpwuid(os.geteuid()).pw_name


def free_port():
    """A port that is free on every address."""
    with socket.socket() as probe:
        probe.bind(("", 0))
        return probe.getsockname()[1]


def short(path):
    """A path as one would type it in this folder, which may lie behind a link."""
    path = os.path.realpath(path)
    return min(os.path.relpath(path, os.path.realpath(os.curdir)), path, key=len)


def answers(address):
    with socket.socket() as probe:
        return probe.connect_ex(address) == 0


class Fleet:
    patience_s = 0  # how long trb() tries again, if a stall of the machine is all that was wrong

    def __init__(self, root, programs, block=1, udp_port=50000, robots=None, speed=1.0, name="demo", cloud=True,
                 gateway_port=None):
        self.root = pathlib.Path(root)
        self.programs = pathlib.Path(programs)
        self.block = block
        self.udp_port = udp_port
        self.robots = dict(ROBOTS if robots is None else robots)
        self.speed = speed
        self.name = name
        self.gateway_port = gateway_port  # of the cloud's page on 127.0.0.1; None: there is no gateway
        self.node_names = list(self.robots) + ([CLOUD] if cloud else [])
        self.nodes = {}
        self.virtual = {}
        self.on_board = {}  # node: the program on its robot that takes fields
        self.ros_port = free_port() if self.ros_robots() else None
        self.ros_master = None
        self.ros_master_inside = []  # the start of its command line, if it is to have a world of its own
        self.sensor_sides = {}  # node: its sensor_side.SensorSide
        self.listeners = []  # programs of somebody else, whose output must not stand in a full pipe

    # ---- paths and addresses

    def dir(self, node):
        return self.root / "nodes" / node

    def authority_dir(self):
        return self.root / "authority"

    def number(self, node):
        return self.node_names.index(node) + 1

    def address(self, node):
        return f"127.0.{self.block}.{self.number(node)}"

    def robot_address(self, node):
        return f"127.0.{self.block + 1}.{self.number(node)}"

    # ---- the command line

    def trb(self, *arguments, node=None, check=True, timeout=60):
        command = [str(self.programs / "trb"), *map(str, arguments)]
        if node:
            command += ["--node", str(self.dir(node))]
        if check and self.patience_s and arguments[0] in ("stop", "release") and "--timeout" not in arguments:
            command += ["--timeout", str(self.patience_s)]
        env = dict(os.environ, TRB_PASSPHRASE=self.passphrase())
        env.pop("TRB_NODE", None)
        end = time.monotonic() + self.patience_s
        while True:
            done = subprocess.run(command, capture_output=True, text=True, timeout=timeout, env=env)
            if not check or done.returncode == 0:
                return done
            said = done.stdout + done.stderr
            if time.monotonic() > end or not self.may_ask_again(arguments, node, said):
                raise RuntimeError(f"{' '.join(command)}: exit {done.returncode}\n{said}")

    def may_ask_again(self, arguments, node, said):
        """Nothing was sent, for the router did not welcome it in time or still gathers the fleet; or a question has got no
        answer in time."""
        unsent = node and (f"the router of {self.dir(node)} does not answer" in said or "has just started, and may not" in said)
        return unsent or (tuple(arguments[:2]) in QUESTIONS and "no answer from" in said)

    def json(self, *arguments, node=None, check=True, timeout=60):
        return json.loads(self.trb(*arguments, "--json", node=node, check=check, timeout=timeout).stdout)

    def passphrase(self):
        path = self.root / "passphrase"
        return path.read_text().strip() if path.exists() else ""

    # ---- making the fleet

    def make(self):
        """Folders, keys and certificates of every node."""
        self.make_authority()
        for node in self.node_names:
            self.make_node(node)
        requests = [self.dir(node) / "keys" / "request.json" for node in self.node_names]
        self.trb("fleet", "sign", self.authority_dir(), *requests)

    def make_authority(self):
        """An empty folder for the fleet, with its authority and the passphrase of that."""
        shutil.rmtree(self.root, ignore_errors=True)
        self.root.mkdir(parents=True)
        path = self.root / "passphrase"
        path.touch(mode=0o600)
        path.write_text(secrets.token_urlsafe(24) + "\n")
        self.trb("fleet", "init", self.authority_dir(), "--name", self.name)

    def make_node(self, node):
        folder = self.dir(node)
        folder.mkdir(parents=True)
        config = REPO / "config"
        for name in ("profile.json", "commands.json", "places.json"):
            shutil.copy(config / name, folder / name)
        network = {"UDP_PORT": self.udp_port, "TCP_PORT_EXT": 45000, "TCP_PORT": 40000,
                   "HOST_INT": self.address(node), "VPN_INT": "tun0"}
        if node in self.robots and self.robots[node][0] == "plc":
            path = folder / "commands.json"
            path.write_text(path.read_text().replace('"port": 502', f'"port": {plc_port()}'))
        if node in self.ros_robots():
            self.name_ros_master(folder / "commands.json", self.robots[node][0])
        (folder / "network.json").write_text(json.dumps(network, indent=2) + "\n")
        (folder / "node.json").write_text(json.dumps(self.with_sensors(node, self.node_json(node)), indent=2) + "\n")
        if node in self.sensor_sides:
            shutil.copytree(config / "sensors", folder / "sensors", ignore=shutil.ignore_patterns("*.md"))
        if node == CLOUD and self.gateway_port:
            (folder / "cloud.json").write_text(json.dumps({"listen": f"127.0.0.1:{self.gateway_port}"}) + "\n")
        if node in self.robots:
            (folder / "robots").mkdir()
            shutil.copy(self.description(node), folder / "robots")
        self.trb("fleet", "request", folder)

    def description(self, node):
        """The file, by its name in config/robots or, for the framework "lines", in tests/support/robots."""
        framework, name, _ = self.robots[node]
        return (REPO / "tests/support/robots" if framework == "lines" else REPO / "config/robots") / f"{name}.json"

    def node_json(self, node):
        if node not in self.robots:
            gateway = ["cloud-gateway"] if self.gateway_port else []
            return {"id": node, "role": "cloud", "services": ["router", "scheduler", "resilience", *gateway]}
        framework, description, _ = self.robots[node]
        robot = {"host": self.robot_address(node), "interface": self.address(node),
                 "fault_injection": f"{self.robot_address(node)}:{CONTROL_PORT}"}
        services = ["router", "mode-adapter", "scheduler"]
        if framework in ROS:
            robot.update(host=self.ros_address(), namespace=node)
            services.insert(2, "ros-bridge")
        if self.player(node) == "pioneer":
            robot["origin"] = self.origin(node)
        return {"id": node, "framework": "lines" if framework in ON_BOARD else framework,
                "description": f"robots/{description}.json", "robot": robot, "services": services}

    def with_sensors(self, node, node_json):
        if node in self.sensor_sides:
            node_json["services"].append("sensor-bus")
            node_json["dbus"] = self.sensor_sides[node].bus.address
        return node_json

    def origin(self, node):
        """Where in the hall a robot's own coordinates begin: a Pioneer's where it is switched on."""
        arguments = self.robots[node][2]
        pose = arguments[arguments.index("--pose") + 1] if "--pose" in arguments else "0,0,0"
        return dict(zip(("x", "y", "yaw"), map(float, pose.split(","))))

    # ---- the ROS master, one for all robots that need it

    def ros_robots(self):
        return [node for node, (framework, *_) in self.robots.items() if framework in ROS]

    def ros_address(self):
        return self.robot_address(self.ros_robots()[0])

    def ros_uri(self):
        return f"http://{self.ros_address()}:{self.ros_port}/"

    def name_ros_master(self, path, framework):
        path.write_text(path.read_text().replace(f'"{framework}": {{', f'"{framework}": {{ "port": {self.ros_port},', 1))

    def start_ros_master(self):
        env = dict(os.environ, ROS_HOME=str(self.root / "ros"), ROS_IP=self.ros_address())  # binds that address alone
        self.ros_master = Process([*self.ros_master_inside, "/usr/bin/rosmaster", "--core", "-p", self.ros_port],
                                  self.root / "rosmaster.log", env=env)
        self.wait("the ROS master listens", lambda: answers((self.ros_address(), self.ros_port)), LONG_S)

    # ---- starting and stopping

    def start_robot(self, node, *more):
        arguments = self.robots[node][2]
        command = [*self.virtual_robot(node), *arguments, "--control", f"{self.robot_address(node)}:{CONTROL_PORT}",
                   "--speed", self.speed, "--die-with-parent", *more]
        self.virtual[node] = Process(command, self.root / f"robot-{node}.log", stdin=subprocess.PIPE)
        self.virtual[node].wait_line("ready", LONG_S)
        if self.robots[node][0] in ON_BOARD and node not in self.on_board:
            self.start_on_board(node)

    def start_on_board(self, node):
        """What runs on the robot's own computer: it dials the robot and the node until both are there."""
        _, program, port = ON_BOARD[self.robots[node][0]]
        robot = self.robot_address(node)
        command = [self.programs / program, self.address(node), 40000, robot, port, robot]
        self.on_board[node] = Process(command, self.root / f"on-board-{node}.log")

    def player(self, node):
        """Which virtual robot plays it: trb-virtual-NAME."""
        framework = self.robots[node][0]
        return {"ardrone": "drone"}.get(framework, ON_BOARD.get(framework, (framework,))[0])

    def virtual_robot(self, node):
        """The program that plays the robot, and how it is told its addresses."""
        framework, address = self.robots[node][0], self.robot_address(node)
        if framework == "lines":
            return [self.programs / "trb-virtual-lines-robot", "--node", f"{self.address(node)}:40000", "--from", address,
                    "--name", node]
        if framework in ROS:
            return [self.programs / "trb-virtual-ros-robot", "--master", self.ros_uri(), "--ip", address,
                    "--namespace", node]
        port = ["--port", plc_port()] if framework == "plc" else []
        return [self.programs / f"trb-virtual-{self.player(node)}", "--address", address, *port]

    def start_node(self, node):
        self.start_supervisor(node)
        if node in self.sensor_sides:
            self.sensor_sides[node].start()

    def start_supervisor(self, node):
        log = self.root / f"up-{node}.log"
        without = ["--without", "sensor-bus"] if node in self.sensor_sides else []
        self.nodes[node] = Process([self.programs / "trb", "up", self.dir(node), *without, "--die-with-parent"], log)

    def start(self):
        if self.ros_robots():
            self.start_ros_master()
        for node in self.robots:
            self.start_robot(node)
        for node in self.node_names:
            self.start_node(node)
        for node in self.node_names:
            self.nodes[node].wait_line("ready", LONG_S)

    def processes(self):
        sides = [process for side in self.sensor_sides.values() for process in side.processes()]
        return [*self.nodes.values(), *self.virtual.values(), *self.on_board.values(), *sides,
                *([self.ros_master] if self.ros_master else [])]

    def pump(self):
        """Keeps the children's output flowing."""
        for process in self.processes():
            process.pump(0)
        for listener in self.listeners:
            listener.drain()

    def wait(self, what, condition, timeout):
        """Waits for a condition on the fleet, with a deadline; returns how long it took."""
        start = time.monotonic()
        while True:
            value = condition()
            if value:
                return time.monotonic() - start
            if time.monotonic() - start > timeout:
                raise TimeoutError(f"{what}: not within {timeout} s")
            self.pump()
            select.select([], [], [], 0.05)

    def formed(self, node=CLOUD):
        """True if the node's table has every node ONLINE and every robot connected."""
        done = self.trb("route", "list", "--json", node=node, check=False)
        if done.returncode != 0:
            return False
        routes = json.loads(done.stdout)["routes"]
        online = [r for r in routes if r["state"] in ("self", "ONLINE")]
        robots = [r for r in routes if r["role"] == "robot" and r["profile"]["robot"] == "ONLINE"]
        return len(online) == len(self.node_names) and len(robots) == len(self.robots)

    def wait_formed(self, timeout=LONG_S):
        return self.wait("the fleet forms", lambda: all(self.formed(n) for n in self.node_names), timeout)

    def services(self, node):
        return {s["service"]: s for s in self.json("service", "list", node=node)["services"]}

    def pid(self, node, service):
        """The pid of a service, found among the children of the node's supervisor."""
        return self.pid_of_child(self.nodes[node].child.pid, service)

    def pid_of_child(self, parent, service):
        for path in pathlib.Path("/proc").glob("[0-9]*/stat"):
            try:
                name, rest = path.read_text().split(") ", 1)
            except OSError:
                continue
            if int(rest.split()[1]) == parent and f"trb-{service}"[:15] == name.split("(", 1)[1]:
                return int(path.parent.name)
        return None

    def stop(self):
        for process in self.processes():
            if process.child.poll() is None:
                process.child.send_signal(signal.SIGTERM)
        for process in self.processes():
            process.stop()
        for side in self.sensor_sides.values():
            side.stop()
        self.nodes.clear()
        self.virtual.clear()
        self.on_board.clear()
        self.ros_master = None

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.stop()
