"""Robots of five makers join a fleet as a new user would have them do it: `trb node new`, `trb fleet invite`, `trb node join`, `trb up`,
`trb robot try`, with the clock running.

Addresses 127.0.210.x, 127.0.211.x.
"""
import fcntl
import json
import os
import pty
import select
import shutil
import subprocess
import time
import unittest

import support
import trb_fleet

BLOCK = 210
UDP_PORT = 50210
NOBODY = 65534
# name: framework, description, arguments of the virtual robot; and what `trb node new` calls such a robot.
ROBOTS = {
    "arm": ("ur", "ur3", []),
    "rover": ("pioneer", "pioneer", ["--pose", "0,0,0"]),
    "flyer": ("ardrone", "drone", []),
    "belt": ("plc", "conveyor", []),
    "welder": ("kuka", "kuka", []),
}
LIKE = {"ardrone": "drone"}


# What each is let try, and with what: `trb robot try --yes --skill ... --set ...`.
TRIED = {
    "arm": ("move_joints", "move_joints.joints=[0,-1.2,1.0,-1.4,-1.57,0]"),
    "rover": ("go_to", "go_to.place=loading_area"),
    "flyer": ("take_off,land", ""),
    "belt": ("", ""),
    "welder": ("pick", "pick.side=left"),
}


class NewFleet(trb_fleet.Fleet):
    """The cloud's folder is there; a robot's is made on its empty PC by `trb node new`, but for the fleet's UDP port and the belt's."""

    def make_node(self, node):
        if node not in self.robots:
            return super().make_node(node)

    def make(self):
        self.make_authority()
        self.make_node("cloud")
        self.trb("fleet", "sign", self.authority_dir(), self.dir("cloud") / "keys" / "request.json")

    def new_node(self, node):
        framework = self.robots[node][0]
        self.dir(node).parent.mkdir(parents=True, exist_ok=True)
        self.trb("node", "new", self.dir(node), "--robot", node, "--like", LIKE.get(framework, framework), "--address",
                 self.robot_address(node), "--network", self.address(node), "--interface", self.address(node))
        self.change(node, "network.json", '"UDP_PORT": 50000', f'"UDP_PORT": {self.udp_port}')
        if framework == "plc":
            # Its network has no beacons: it finds the fleet by the seeds that came with its certificate.
            self.change(node, "node.json", '"seeds": []', '"beacon": false, "seeds": []')
            self.change(node, "commands.json", '"port": 502', f'"port": {trb_fleet.plc_port()}')

    def change(self, node, name, old, new):
        path = self.dir(node) / name
        text = path.read_text()
        assert old in text, (name, old)
        path.write_text(text.replace(old, new, 1))

    def invite_and_join(self, node):
        """The inviter waits in its own process, as at the other computer."""
        invite = trb_fleet.Process(
            [self.programs / "trb", "fleet", "invite", self.authority_dir(), node, "--via", self.dir("cloud"), "--json"],
            self.root / f"invite-{node}.log", env=dict(os.environ, TRB_PASSPHRASE=self.passphrase()))
        try:
            code = json.loads(invite.wait_line('"event":"code"', 60)[0])["code"]
            self.trb("node", "join", self.dir(node), code, "--timeout", "100", timeout=250)
            invite.wait_line('"event":"joined"', 60)
        finally:
            invite.stop()


class FiveMakers(unittest.TestCase):
    def test_five_robots_of_five_makers_join_within_three_minutes(self):
        fleet = NewFleet(support.temporary_folder(self) / "fleet", support.PROGRAMS, block=BLOCK, udp_port=UDP_PORT, robots=ROBOTS)
        support.hold_blocks(BLOCK, BLOCK + 1)
        self.addCleanup(fleet.stop)
        fleet.make()
        fleet.start_node("cloud")
        fleet.nodes["cloud"].wait_line("ready", 60)
        for node in ROBOTS:
            fleet.start_robot(node)
        took = {"all five": -time.monotonic()}
        for node in ROBOTS:
            begun = time.monotonic()
            fleet.new_node(node)
            fleet.invite_and_join(node)
            self.assertIn("no faults", fleet.trb("check", fleet.dir(node)).stdout)
            fleet.start_node(node)
            fleet.nodes[node].wait_line("ready", 60)
            took[node] = time.monotonic() - begun
        for node in ROBOTS:
            begun = time.monotonic()
            self.try_robot(fleet, node)
            took[node] += time.monotonic() - begun
        took["all five"] += time.monotonic()
        fleet.wait("every robot is there and connected", lambda: fleet.formed("cloud"), 60)
        print("from an empty PC to a robot that was tried: " + ", ".join(f"{name} {seconds:.1f} s" for name, seconds in took.items()))
        self.assertLess(max(seconds for name, seconds in took.items() if name != "all five"), 180)
        # Each knows what its description says that it can do.
        skills = {row["id"]: row["profile"]["skills"] for row in fleet.json("route", "list", node="cloud")["routes"]
                  if row["id"] in ROBOTS}
        self.assertEqual(set(skills), set(ROBOTS))
        self.assertTrue(all(skills.values()))
        self.nothing_is_tried_without_a_yes(fleet)
        self.what_is_wrong_is_told_with_its_file(fleet)

    def try_robot(self, fleet, node):
        skills, settings = TRIED[node]
        words = ["--yes", "--skill", skills] if skills else []
        for _ in range(3):  # a task has 5 s to begin, which a stalled machine uses up
            done = fleet.json("robot", "try", node, *words, *(["--set", settings] if settings else []), "--timeout", "60",
                              node="cloud", check=False, timeout=170)
            if done["good"]:
                break
        failed = [step for step in done["steps"] if step["state"] == "failed"]
        self.assertTrue(done["good"], failed)
        states = {step["step"]: step["state"] for step in done["steps"]}
        for step in ["there", "connected", "free", "release"] + [f"skill {skill}" for skill in skills.split(",") if skill]:
            self.assertEqual(states[step], "good", done["steps"])
        # These show that they stand, as they did before; the others answer the stop itself. The arm's program may still be told to
        # run when its skill has just ended: then the stop is seen to end it.
        stops = {"arm": ["not proved", "good"], "rover": ["not proved"], "flyer": ["not proved"]}.get(node, ["good"])
        self.assertIn(states["stop"], stops, done["steps"])

    def nothing_is_tried_without_a_yes(self, fleet):
        done = fleet.json("robot", "try", "rover", node="cloud", timeout=60)
        self.assertEqual({step["state"] for step in done["steps"] if step["step"].startswith("skill")}, {"not tried"})
        refused = fleet.trb("robot", "try", "rover", "--yes", node="cloud", check=False)
        self.assertNotEqual(refused.returncode, 0)
        self.assertIn("--skill", refused.stderr)

    def what_is_wrong_is_told_with_its_file(self, fleet):
        fleet.virtual["arm"].stop()
        fleet.trb("stop", "rover", node="cloud")

        def profiles():
            return {row["id"]: row["profile"] for row in fleet.json("route", "list", node="cloud")["routes"]}
        fleet.wait("the cloud knows it of both", lambda: profiles()["arm"]["robot"] != "ONLINE" and profiles()["rover"]["fenced"], 60)
        for node, step, cure in (("arm", "connected", "node.json: robot.host"), ("rover", "free", "trb release rover"),
                                 ("nobody", "there", "trb up")):
            done = fleet.json("robot", "try", node, "--timeout", "15", node="cloud", check=False, timeout=60)
            self.assertFalse(done["good"])
            self.assertEqual(done["steps"][-1]["step"], step, done)
            self.assertIn(cure, done["steps"][-1]["cure"])


class Folder(unittest.TestCase):
    def setUp(self):
        self.folder = support.temporary_folder(self)

    def new(self, *words, **more):
        return subprocess.run([support.PROGRAMS / "trb", "node", "new", *map(str, words)], capture_output=True, text=True, timeout=30,
                              stdin=subprocess.DEVNULL, **more)

    def good(self, name="arm", *more):
        return [self.folder / name, "--robot", name, "--like", "ur", "--address", "127.0.211.9", "--network", "127.0.210.9", *more]

    def test_keys_are_private_and_a_folder_with_files_is_left_alone(self):
        self.assertEqual(self.new(f"{self.folder}/arm/", *self.good()[1:]).returncode, 0)
        self.assertEqual((self.folder / "arm").stat().st_mode & 0o777, 0o700)
        keys = list((self.folder / "arm" / "keys").glob("*.key"))
        self.assertEqual({path.stat().st_mode & 0o777 for path in keys}, {0o600})
        self.assertEqual(json.loads(self.new(*self.good("arm2"), "--json").stdout)["faults"], [])
        before = {path.name: path.read_bytes() for path in keys}
        again = self.new(*self.good())
        self.assertNotEqual(again.returncode, 0)
        self.assertIn("is there already", again.stderr)
        self.assertEqual({path.name: path.read_bytes() for path in keys}, before)

    def test_a_folder_of_another_s_beside_it_is_left_alone(self):
        for name in ("arm.making", "arm.making-AAAAAA"):
            (self.folder / name).mkdir()
            (self.folder / name / "thesis.txt").write_text("mine")
        self.assertEqual(self.new(*self.good()).returncode, 0)
        self.assertEqual(sorted(path.name for path in self.folder.iterdir()), ["arm", "arm.making", "arm.making-AAAAAA"])
        self.assertEqual((self.folder / "arm.making" / "thesis.txt").read_text(), "mine")

    def test_what_an_interrupted_call_has_left_with_its_keys_is_named_by_the_next_one_and_by_the_check(self):
        fleet = trb_fleet.Fleet(self.folder / "fleet", support.PROGRAMS, block=BLOCK, udp_port=UDP_PORT, robots={})
        fleet.make_authority()
        left, busy, other = (self.folder / f"cloud.making-{name}" for name in ("Ab12Cd", "Ef34Gh", "thesis1"))
        for path in (left, busy, other):
            (path / "keys").mkdir(parents=True)
            (path / "keys" / "identity.key").write_text("secret")
        making = os.open(busy, os.O_RDONLY)
        self.addCleanup(os.close, making)
        fcntl.flock(making, fcntl.LOCK_EX)  # as who is making it now
        note = f"note: {left} was left by a call that was interrupted, and may hold private keys; remove it: rm -r {left}"
        done = self.new(self.folder / "cloud", "--cloud", "cloud", "--network", "127.0.210.9")
        self.assertEqual((done.returncode, done.stderr), (0, note + "\n"))
        fleet.trb("fleet", "sign", fleet.authority_dir(), self.folder / "cloud" / "keys" / "request.json")
        said = fleet.trb("check", self.folder / "cloud").stdout
        self.assertIn("no faults", said)
        self.assertIn(note, said)
        self.assertEqual(json.loads(fleet.trb("check", self.folder / "cloud", "--json").stdout)["notes"], [note[len("note: "):]])
        shutil.rmtree(left)
        self.assertNotIn("note", fleet.trb("check", self.folder / "cloud").stdout)

    def test_of_two_who_make_one_folder_one_makes_it_whole_and_the_other_is_told(self):
        for i in range(6):
            words = [["--robot", "va", "--like", "ur"], ["--robot", "vb", "--like", "pioneer"]]
            both = [subprocess.Popen([support.PROGRAMS / "trb", "node", "new", self.folder / f"v{i}", *one, *map(str, self.good()[5:])],
                                     stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, stdin=subprocess.DEVNULL) for one in words]
            said = [one.communicate(timeout=30)[1] for one in both]
            with self.subTest(i):
                self.assertEqual(sorted(one.returncode != 0 for one in both), [False, True], said)
                self.assertIn("is there already", said[0] + said[1])
                made = "va" if both[0].returncode == 0 else "vb"
                node = json.loads((self.folder / f"v{i}" / "node.json").read_text())
                request = json.loads((self.folder / f"v{i}" / "keys" / "request.json").read_text())
                self.assertEqual(node["id"], made)
                self.assertIn(made, json.dumps(request))
        self.assertEqual(list(self.folder.glob("*.making*")), [])

    def test_what_is_wrong_is_named_with_its_option_and_nothing_is_made(self):
        for words, said in ((["--robot", "a b"], "--robot"), (["--like", "fnuc"], "--like"), (["--address", "rob.local"], "--address"),
                            (["--network", "no such"], "--network")):
            with self.subTest(words):
                done = self.new(*self.good(), *words)
                self.assertNotEqual(done.returncode, 0)
                self.assertIn(said, done.stderr)
                self.assertEqual(list(self.folder.iterdir()), [])
        done = self.new(self.folder / "arm", "--like", "ur")
        self.assertIn("--robot", done.stderr)
        done = self.new(*self.good(), env={**os.environ, "TRB_CONFIG": "/nowhere"})
        self.assertIn("TRB_CONFIG", done.stderr)
        self.assertEqual(list(self.folder.iterdir()), [])

    def test_a_cloud_node_s_folder_needs_no_more_than_its_certificate(self):
        fleet = trb_fleet.Fleet(self.folder / "fleet", support.PROGRAMS, block=BLOCK, udp_port=UDP_PORT, robots={})
        fleet.make_authority()
        cloud = [self.folder / "cloud", "--cloud", "cloud", "--network", "127.0.210.9", "--page", "127.0.210.9:8443"]
        done = self.new(*cloud)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("trb cloud password", done.stdout)
        self.assertIn("cloud-gateway", json.loads((self.folder / "cloud" / "node.json").read_text())["services"])
        self.assertTrue((self.folder / "cloud" / "places.json").exists())
        fleet.trb("fleet", "sign", fleet.authority_dir(), self.folder / "cloud" / "keys" / "request.json")
        self.assertIn("no faults", fleet.trb("check", self.folder / "cloud").stdout)
        for words, said in ((["--page", "hall:8443"], "--page"), (["--like", "ur"], "--like"), (["--cloud", "a b"], "--cloud")):
            with self.subTest(words):
                refused = self.new(self.folder / "other", *cloud[1:], *words)
                self.assertNotEqual(refused.returncode, 0)
                self.assertIn(said, refused.stderr)
                self.assertFalse((self.folder / "other").exists())
        self.assertIn("--cloud", self.new(*self.good(), "--page", "127.0.0.1:8443").stderr)

    def test_what_root_writes_belongs_to_the_folder_s_owner_and_nothing_outside_does(self):
        if os.geteuid() != 0:
            self.skipTest("only root can give files away")
        cloud, outside = self.folder / "cloud", self.folder / "outside"
        self.assertEqual(self.new(cloud, "--cloud", "cloud", "--network", "127.0.210.9", "--page", "127.0.0.1:8443").returncode, 0)
        outside.write_text("not of the node")
        for path in (cloud, *cloud.rglob("*")):
            os.chown(path, NOBODY, NOBODY)
        for key in (cloud / "keys").glob("*.key"):
            key.unlink()
        (cloud / "keys" / "symbolic").symlink_to(outside)
        os.link(outside, cloud / "keys" / "second_name")
        for words in (["fleet", "request"], ["cloud", "password"]):
            subprocess.run([support.PROGRAMS / "trb", *words, cloud], check=True, capture_output=True, timeout=60)
        owners = {path.name: path.lstat().st_uid for path in (cloud / "keys").iterdir()}
        self.assertEqual({owners.pop("symbolic"), owners.pop("second_name"), outside.stat().st_uid}, {0})
        self.assertEqual(set(owners.values()), {NOBODY})
        self.assertLessEqual({"link.key", "request.json", "gateway.password"}, set(owners))

    def test_a_link_in_place_of_the_keys_leads_root_to_no_other_folder(self):
        if os.geteuid() != 0:
            self.skipTest("only root can give files away")
        cloud, outside = self.folder / "cloud", self.folder / "outside"
        self.assertEqual(self.new(cloud, "--cloud", "cloud", "--network", "127.0.210.9", "--page", "127.0.0.1:8443").returncode, 0)
        (cloud / "keys").rename(outside)
        (outside / "of_root").write_text("not of the node")
        (cloud / "keys").symlink_to(outside)
        os.chown(cloud, NOBODY, NOBODY)
        subprocess.run([support.PROGRAMS / "trb", "cloud", "password", cloud], capture_output=True, timeout=60)
        self.assertEqual({path.lstat().st_uid for path in (outside, *outside.rglob("*"))}, {0})

    def test_what_this_user_may_not_read_is_not_told_as_missing(self):
        node = self.folder / "cloud"
        self.assertEqual(self.new(node, "--cloud", "cloud", "--network", "127.0.210.9").returncode, 0)
        other = []
        if os.geteuid() == 0:
            other = ["setpriv", "--reuid", str(NOBODY), "--regid", str(NOBODY), "--clear-groups"]
            if subprocess.run([*other, support.PROGRAMS / "trb", "version"], capture_output=True, timeout=60).returncode != 0:
                self.skipTest(f"another user cannot start {support.PROGRAMS / 'trb'}")

        def told(closed, *words):
            closed.chmod(0)
            try:
                done = subprocess.run([*other, support.PROGRAMS / "trb", *words], capture_output=True, text=True, timeout=60)
            finally:
                closed.chmod(0o755)
            self.assertNotEqual(done.returncode, 0, words)
            said = done.stdout + done.stderr
            self.assertIn("Permission denied", said, words)
            self.assertIn("run it as the user of the services", said, words)
            self.assertNotIn("no such", said.lower(), words)
            self.assertNotIn("fleet request", said, words)

        self.folder.chmod(0o755)
        for path in (node, *node.rglob("*")):
            path.chmod(0o755 if path.is_dir() else 0o644)
        told(node / "keys", "check", node)
        for words in (["check", node], ["up", node], ["reload", node], ["down", node], ["robot", "list", "--node", node],
                      ["cloud", "password", node], ["fleet", "request", node], ["node", "backup", node, self.folder / "backup"],
                      ["node", "new", node / "inner", *self.good()[1:]]):
            with self.subTest(words):
                told(node, *words)

    def test_a_folder_that_cannot_be_written_leaves_nothing(self):
        (self.folder / "file").touch()
        done = self.new(self.folder / "file" / "arm", *self.good()[1:])
        self.assertNotEqual(done.returncode, 0)
        self.assertEqual([path.name for path in self.folder.iterdir()], ["file"])

    def test_a_person_at_a_terminal_is_asked(self):
        """For the address with the place where that maker's controller shows it."""
        master, slave = pty.openpty()
        command = [support.PROGRAMS / "trb", "node", "new", self.folder / "arm", "--network", "127.0.210.9"]
        child = subprocess.Popen(command, stdin=slave, stdout=slave, stderr=slave, preexec_fn=trb_fleet.end_with_parent)
        os.close(slave)
        self.addCleanup(os.close, master)
        self.addCleanup(child.wait)
        self.addCleanup(child.kill)
        self.shown = ""
        for question, answer in (("name in the fleet", "arm"), ("what robot it is like", "kuka"), ("smartHMI", "127.0.211.9")):
            self.read_until(master, question)
            os.write(master, (answer + "\n").encode())
        self.read_until(master, "trb fleet invite")
        self.assertEqual(child.wait(60), 0)
        self.assertEqual(json.loads((self.folder / "arm" / "node.json").read_text())["framework"], "kuka")

    def read_until(self, terminal, wanted):
        end = time.monotonic() + 60
        while wanted not in self.shown:
            ready, _, _ = select.select([terminal], [], [], max(0, end - time.monotonic()))
            self.assertTrue(ready, f"no {wanted!r} in {self.shown!r}")
            self.shown += os.read(terminal, 4096).decode()
        self.shown = self.shown.split(wanted, 1)[1]


class Demo(unittest.TestCase):
    """trb demo, where it refuses; what it does, the handbook's test shows."""

    def setUp(self):
        self.folder = support.temporary_folder(self)

    def demo(self, *words, program=support.PROGRAMS / "trb"):
        return subprocess.run([program, "demo", *map(str, words)], capture_output=True, text=True, timeout=30, stdin=subprocess.DEVNULL)

    def test_what_is_wrong_is_named_with_its_option_and_nothing_is_made(self):
        for words, said in ((["--network", "10.0.1"], "--network"), (["--page", "80"], "--page"), (["--speed", "1000"], "--speed"),
                            (["--timeout", "soon"], "--timeout")):
            with self.subTest(words):
                done = self.demo(self.folder / "hall", *words)
                self.assertNotEqual(done.returncode, 0)
                self.assertIn(said, done.stderr)
                self.assertEqual(list(self.folder.iterdir()), [])

    def test_a_folder_with_files_is_left_alone(self):
        (self.folder / "mine").touch()
        done = self.demo(self.folder)
        self.assertIn("is there already", done.stderr)
        self.assertEqual([path.name for path in self.folder.iterdir()], ["mine"])

    def test_without_virtual_robots_the_package_is_named(self):
        shutil.copy(support.PROGRAMS / "trb", self.folder)
        done = self.demo(self.folder / "hall", program=self.folder / "trb")
        self.assertIn("trb-virtual-pioneer is not there", done.stderr)
        self.assertIn("talkrobots-virtual-robots", done.stderr)
        self.assertFalse((self.folder / "hall").exists())


if __name__ == "__main__":
    support.main()
