"""A node's life by the command line: up in the background, down, a service that is added, a folder far down.

Addresses 127.0.240.x.
"""
import json
import os
import pwd
import socket
import subprocess
import unittest

import support
import trb_fleet
from trb_process import wait_until

BLOCK = 240


class OneNode(trb_fleet.Fleet):
    """A cloud node alone."""

    def __init__(self, root, services):
        super().__init__(root, support.PROGRAMS, block=BLOCK, udp_port=50240, robots={})
        self.services_of = services

    def node_json(self, node):
        return {"id": node, "role": "cloud", "services": self.services_of}


class NodeLife(unittest.TestCase):
    def make(self, below="", services=("router", "scheduler")):
        support.hold_blocks(BLOCK, BLOCK + 1)
        folder = support.temporary_folder(self)
        fleet = OneNode(folder / below / "fleet", list(services))
        fleet.make()
        self.addCleanup(fleet.trb, "down", fleet.dir("cloud"), check=False)
        return fleet

    def up(self, fleet, *more):
        return fleet.trb("up", fleet.dir("cloud"), "--detach", *more, check=False)

    def test_up_in_the_background_returns_when_the_node_is_ready(self):
        fleet = self.make()
        done = self.up(fleet)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertIn("cloud: ready (pid ", done.stdout)
        fleet.wait("all are up", lambda: {one["state"] for one in fleet.services("cloud").values()} == {"up"}, 60)
        again = self.up(fleet)
        self.assertNotEqual(again.returncode, 0)
        self.assertIn("is up already", again.stderr)
        self.assertEqual(fleet.trb("down", fleet.dir("cloud")).returncode, 0)
        self.assertEqual(fleet.trb("down", fleet.dir("cloud"), check=False).returncode, 1)
        self.assertEqual(self.up(fleet).returncode, 0)

    def test_what_is_done_is_json_for_a_program(self):
        fleet = self.make()
        done = self.up(fleet, "--json")
        self.assertEqual(json.loads(done.stdout)["node"], "cloud", done.stdout)
        self.assertEqual(json.loads(fleet.trb("reload", fleet.dir("cloud"), "--json").stdout), {"node": "cloud"})
        done = fleet.trb("down", fleet.dir("cloud"), "--json")
        self.assertEqual(json.loads(done.stdout), {"dir": str(fleet.dir("cloud")), "state": "down"})

    def test_an_order_to_all_that_reaches_nobody_is_no_success(self):
        fleet = self.make()
        self.up(fleet)
        for order in ("stop", "release"):
            done = fleet.trb(order, "--all", node="cloud", check=False)
            self.assertEqual((done.returncode, done.stdout), (1, ""))
            self.assertIn("nothing is ordered: cloud knows no robot", done.stderr)

    def test_what_is_not_up_is_named(self):
        fleet = self.make()
        path = fleet.dir("cloud") / "node.json"
        node = json.loads(path.read_text())
        node["own_services"] = {"never-there": "/bin/false"}
        path.write_text(json.dumps(node))
        for seconds in (10, 30, 60):  # the others have to be up by then
            done = self.up(fleet, "--timeout", seconds)
            if "not up: never-there" in done.stderr:
                break
            fleet.trb("down", fleet.dir("cloud"), check=False)
        self.assertEqual(done.returncode, 1)
        self.assertIn("is not ready: not up: never-there", done.stderr)
        self.assertIn("trb down", done.stderr)

    def test_ready_says_which_service_waits(self):
        fleet = self.make()
        (fleet.dir("cloud") / "state/journal.db").mkdir(parents=True)  # nobody can open it, root neither
        done = self.up(fleet)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("cloud: ready, but scheduler waits: ", done.stdout)
        self.assertIn("journal.db", done.stdout)
        fleet.trb("down", fleet.dir("cloud"))
        self.assertIn("scheduler waits: ", json.loads(self.up(fleet, "--json").stdout)["notes"][0])

    def test_its_words_do_not_fill_the_disk(self):
        fleet = self.make()
        self.up(fleet)
        log = fleet.dir("cloud") / "log/up.log"
        with open(log, "a") as words:
            words.write("x" * 2_000_000)
        fleet.wait("it is emptied while the node runs", lambda: log.stat().st_size < 1_000_000, 60)
        self.assertGreaterEqual(log.with_name("up.log.1").stat().st_size, 2_000_000)

    def test_a_folder_that_others_may_write_has_a_fault(self):
        fleet = self.make()
        folder = fleet.dir("cloud")
        self.assertEqual(fleet.trb("check", folder, check=False).stderr, "")
        for path, mode in ((folder / "keys", 0o777), (folder / "state", 0o777), (folder / "node.json", 0o666)):
            with self.subTest(path.name):
                path.mkdir(exist_ok=True) if path.name == "state" else None
                before = path.stat().st_mode & 0o777
                path.chmod(mode)
                done = fleet.trb("check", folder, check=False)
                self.assertEqual(done.returncode, 1)
                self.assertIn("other users may write there", done.stderr)
                self.assertIn(f"chmod go-w {folder.resolve()}/{path.name}", done.stderr)
                path.chmod(before & ~0o022)

    @unittest.skipIf(os.geteuid(), "only root can leave files of root")
    def test_root_leaves_no_files_in_the_folder_of_another_user(self):
        fleet = self.make()
        folder = fleet.dir("cloud")
        (folder / "state").mkdir(exist_ok=True)
        nobody = pwd.getpwnam("nobody")
        for path in (folder, *folder.rglob("*")):
            os.chown(path, nobody.pw_uid, nobody.pw_gid)
        done = self.up(fleet)
        self.assertEqual(done.returncode, 1, done.stdout)
        self.assertIn("not_permitted", done.stderr)
        self.assertIn(f"runuser -u nobody -- trb up {folder.resolve()}", done.stderr)
        self.assertEqual([path for path in folder.rglob("*") if path.stat().st_uid == 0], [])
        (folder / "state/news").write_bytes(b"")
        said = fleet.trb("check", folder, check=False).stderr
        self.assertIn("state/news: of root, and the services run as nobody", said)
        self.assertIn("chown -R --reference=", said)

    def test_reload_starts_what_was_added_and_ends_what_was_taken_out(self):
        fleet = self.make()
        self.up(fleet)
        path = fleet.dir("cloud") / "node.json"
        node = json.loads(path.read_text())

        def reload_with(services):
            path.write_text(json.dumps(dict(node, services=services)))
            fleet.trb("reload", fleet.dir("cloud"))

            def as_wanted():
                try:
                    table = fleet.services("cloud")
                except RuntimeError:
                    return False  # its router restarts
                states = {name: one["state"] for name, one in table.items() if name != "router"}
                return states == {name: "up" for name in services if name != "router"}
            fleet.wait(f"{services} are up", as_wanted, 60)
        reload_with(["router", "scheduler", "resilience"])
        reload_with(["router", "scheduler"])
        # It is in no table any more as soon as the router reads the new files; its process may take longer.
        fleet.wait("its process has ended", lambda: subprocess.run(
            ["pgrep", "-f", f"trb-resilience {fleet.dir('cloud')}"], capture_output=True).returncode == 1, 60)

    def test_reload_names_the_service_that_it_does_not_reach(self):
        fleet = self.make()
        for option in (["--without", "scheduler"], ["--without=scheduler"], []):
            with self.subTest(option=option):
                up = trb_fleet.Process([support.PROGRAMS / "trb", "up", fleet.dir("cloud"), *option, "--die-with-parent"], fleet.root / "up.log")
                self.addCleanup(up.stop)
                said = []

                def is_taken():
                    done = fleet.trb("reload", fleet.dir("cloud"), check=False)
                    said[:] = [done.stdout]
                    return done.returncode == 0
                fleet.wait("it is up", is_taken, 60)
                self.assertIn("each service takes the new files", said[0])
                self.assertEqual("scheduler is for whoever starts it to ask" in said[0], bool(option), said[0])
                up.stop()

    def test_a_folder_far_down_and_with_a_space_in_its_path(self):
        fleet = self.make(below="a folder of " + "x" * 100 + "/" + "y" * 60)
        done = self.up(fleet)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertEqual(fleet.json("run", "list", node="cloud")["runs"], [])


class Logs(unittest.TestCase):
    """A node's folder with logs, without a node."""

    def setUp(self):
        self.dir = support.temporary_folder(self)
        self.logs = self.dir / "log"
        self.logs.mkdir()
        self.write("router", "2026-03-01T12:00:00.001Z info router b", "2026-03-01T12:00:00.003Z info router a")
        self.write("scheduler", "2026-03-01T12:00:00.002Z info scheduler c")
        self.write("up", "cloud: ready", "cloud: router ended (signal 11), starting it again")

    def write(self, name, *lines):
        with open(self.logs / f"{name}.log", "a") as log:
            log.writelines(line + "\n" for line in lines)

    def shown(self, *words):
        done = subprocess.run([support.PROGRAMS / "trb", "logs", self.dir, *words], capture_output=True, text=True, timeout=30)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout.splitlines()

    def test_lines_are_in_the_order_of_their_times_and_those_without_one_are_shown_if_asked_for(self):
        self.assertEqual([line[-1] for line in self.shown()], ["b", "c", "a"])
        self.assertEqual([line[-1] for line in self.shown("--lines", "2")], ["c", "a"])
        self.assertEqual(self.shown("up"), ["cloud: ready", "cloud: router ended (signal 11), starting it again"])
        self.assertEqual([json.loads(line)["line"][-1] for line in self.shown("--json")], ["b", "c", "a"])

    def test_a_log_is_followed_into_its_next_file(self):
        out = self.dir / "out"
        with open(out, "w") as to:
            child = subprocess.Popen([support.PROGRAMS / "trb", "logs", self.dir, "router", "--follow"], stdout=to,
                                     preexec_fn=trb_fleet.end_with_parent)
        self.addCleanup(child.wait)
        self.addCleanup(child.kill)

        def wait_last(letter):
            self.assertIsNotNone(wait_until(lambda: out.read_text().rstrip().endswith(letter), 30), out.read_text())
        wait_last("a")
        self.write("router", "2026-03-01T12:00:00.004Z info router d")
        wait_last("d")
        (self.logs / "router.log").rename(self.logs / "router.1.log")
        self.write("scheduler", "2026-03-01T12:00:00.005Z info scheduler e")
        self.write("router", "2026-03-01T12:00:00.006Z info router f")
        wait_last("f")
        self.write("router", "2026-03-01T12:00:00.007Z info router g")
        wait_last("g")
        self.assertEqual([line[-1] for line in out.read_text().splitlines()], ["b", "a", "d", "f", "g"])


    def test_a_log_that_logrotate_has_moved_is_named(self):
        (self.logs / "router.log").rename(self.logs / "router.log.1")
        done = subprocess.run([support.PROGRAMS / "trb", "logs", self.dir, "router"], capture_output=True, text=True, timeout=30)
        self.assertEqual(done.returncode, 1)
        self.assertIn("router.log.1: something has moved it away", done.stderr)
        self.assertIn("logrotate", done.stderr)

    def test_a_log_that_was_emptied_is_followed_from_its_beginning(self):
        out = self.dir / "out"
        with open(out, "w") as to:
            child = subprocess.Popen([support.PROGRAMS / "trb", "logs", self.dir, "up", "--follow"], stdout=to,
                                     preexec_fn=trb_fleet.end_with_parent)
        self.addCleanup(child.wait)
        self.addCleanup(child.kill)
        self.assertIsNotNone(wait_until(lambda: "starting it again" in out.read_text(), 30), out.read_text())
        os.truncate(self.logs / "up.log", 0)
        self.write("up", "cloud: h")
        self.assertIsNotNone(wait_until(lambda: out.read_text().endswith("cloud: h\n"), 30), out.read_text())


class Wire(unittest.TestCase):
    def test_a_robot_on_the_fleets_own_interface_is_worth_a_word(self):
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as way:
            try:
                way.connect(("192.0.2.1", 9))
                address = way.getsockname()[0]
            except OSError:
                address = "127.0.0.1"
        if address.startswith("127."):
            self.skipTest("this machine has no address of a network")
        fleet = support.make_fleet(self, block=BLOCK, udp_port=50240, robots={"pioneer1": trb_fleet.ROBOTS["pioneer1"]})
        folder = fleet.dir("pioneer1")
        network = json.loads((folder / "network.json").read_text())
        (folder / "network.json").write_text(json.dumps({**network, "HOST_INT": address}))
        node = json.loads((folder / "node.json").read_text())

        def notes(**robot):
            (folder / "node.json").write_text(json.dumps({**node, "robot": robot}))
            said = fleet.trb("check", folder, "--json", check=False).stdout
            return json.loads(said).get("notes", [])
        found = notes(host="192.0.2.77")
        self.assertEqual(len(found), 1)
        self.assertIn("robot.interface: the robot 192.0.2.77 hangs on the fleet's own interface", found[0])
        self.assertEqual(notes(host="127.0.241.1", interface="127.0.240.1"), [])


if __name__ == "__main__":
    support.main()
