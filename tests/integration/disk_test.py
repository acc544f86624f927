"""A full disk: nothing is acknowledged that is not on it, and a node that starts on it can still be queried, and
stopped. Also: of a node's folder nothing but its configuration can be read by others.
"""
import json
import os
import pathlib
import shutil
import signal
import stat
import unittest

from zmq.utils import z85

import own_world
import support
import trb_fleet
from router_client import Member

CONFIGURATION = {"node.json", "network.json", "profile.json", "commands.json", "places.json", "robots", "keys"}
FOR_ALL = {"keys/certificate.json", "keys/news.json"}  # no secret, and often carried here by another user


class Revocation(unittest.TestCase):
    def setUp(self):
        self.fleet = support.make_fleet(self, support.RouterFleet, block=171,
                                        services={"ant": ["router"], "bee": ["router"], "cat": ["router"]})
        self.disk = own_world.SmallDisk(self.fleet.dir("ant"))
        self.addCleanup(self.disk.gone)
        self.addCleanup(self.fleet.stop)
        self.fleet.bring_up("ant", "bee", "cat")
        self.fleet.wait_formed()

    def states(self, node):
        return {row["id"]: row["state"] for row in self.fleet.json("route", "list", node=node)["routes"]}

    def note(self):
        return self.fleet.services("ant")["router"]["note"]

    def restart(self, node):
        self.fleet.nodes.pop(node).stop()
        self.fleet.start_node(node)
        self.fleet.nodes[node].wait_line("ready", 60)

    def test_a_list_that_is_not_on_disk_is_not_acknowledged(self):
        authority = self.fleet.authority_dir()
        self.disk.fill()
        done = self.fleet.trb("fleet", "revoke", authority, "cat", "--via", self.fleet.dir("ant"), check=False)
        self.assertNotEqual(done.returncode, 0, done.stdout)
        self.assertIn("io_error: in force until this router ends, but not on disk", done.stderr)
        self.assertIn("No space left on device", done.stderr)
        self.assertIn(f"df -h {self.fleet.dir('ant')}/state", done.stderr)
        # It is in force, and sent to the others.
        for node in "ant", "bee":
            self.fleet.wait(f"cat is out at {node}", lambda: "cat" not in self.states(node), 60)
        self.assertIn("not on disk, and lost in a restart", self.note())
        doctor = self.fleet.trb("doctor", node="ant", check=False)
        self.assertIn("not on disk, and lost in a restart", doctor.stdout)
        told = self.fleet.trb("fleet", "tell", authority, "--via", self.fleet.dir("ant"), check=False)
        self.assertNotEqual(told.returncode, 0, told.stdout)
        # Once there is room it is stored without another request, and then acknowledged.
        self.disk.room()
        self.fleet.wait("it is stored", lambda: "not on disk" not in self.note(), 60)
        self.fleet.trb("fleet", "tell", authority, "--via", self.fleet.dir("ant"))
        # Alone, so that no node sends it again; cat has forgotten that it is revoked.
        for node in "bee", "cat":
            self.fleet.nodes.pop(node).stop()
        self.restart("ant")
        watch = support.Watch(self.fleet, "ant")
        shutil.rmtree(self.fleet.dir("cat") / "state")
        key = z85.decode(Member(self.fleet, "ant").public).hex()
        path = self.fleet.dir("cat") / "node.json"
        seeds = [{"address": f"{self.fleet.address('ant')}:45000", "key": key}]
        path.write_text(json.dumps(dict(json.loads(path.read_text()), seeds=seeds)))
        self.fleet.bring_up("cat")
        watch.wait_counted("refused.cert_revoked", timeout=60)
        self.assertNotEqual(self.states("ant").get("cat"), "ONLINE")

    def test_the_authoritys_folder_on_a_full_disk(self):
        authority = self.fleet.authority_dir()
        disk = own_world.SmallDisk(authority)
        self.addCleanup(disk.gone)
        before = {path.name: path.read_bytes() for path in authority.iterdir()}
        disk.fill()
        done = self.fleet.trb("fleet", "revoke", authority, "cat", "--via", self.fleet.dir("ant"), check=False)
        self.assertNotEqual(done.returncode, 0, done.stdout)
        self.assertIn("No space left on device", done.stderr)
        disk.room()
        self.assertEqual({path.name: path.read_bytes() for path in authority.iterdir()}, before)
        self.assertEqual(self.states("ant")["cat"], "ONLINE")
        self.fleet.trb("fleet", "revoke", authority, "cat", "--via", self.fleet.dir("ant"))
        self.fleet.wait("cat is out", lambda: "cat" not in self.states("bee"), 60)

    def test_news_that_could_not_be_written_is_told_later(self):
        """The list was stored, news.json was not: trb fleet tell does not pass on an older one."""
        authority = self.fleet.authority_dir()
        way = authority / "news.json"
        (way / "in-the-way").mkdir(parents=True)
        done = self.fleet.trb("fleet", "revoke", authority, "cat", "--via", self.fleet.dir("ant"), check=False)
        self.assertNotEqual(done.returncode, 0, done.stdout)
        self.assertIn(f"then trb fleet tell {authority}", done.stderr)
        (way / "in-the-way").rmdir()
        way.rmdir()
        self.fleet.trb("fleet", "tell", authority, "--via", self.fleet.dir("ant"))
        self.fleet.wait("cat is out", lambda: "cat" not in self.states("bee"), 60)

    def test_a_renewal_that_news_cannot_hold_is_none(self):
        authority = self.fleet.authority_dir()
        serial = lambda node: {row["id"]: row["serial"] for row in json.loads(
            self.fleet.trb("fleet", "show", authority, "--json").stdout)["nodes"]}[node]
        first = serial("cat")
        way = authority / "news.json"
        (way / "in-the-way").mkdir(parents=True)
        for whom in ("cat",), ("--all",):
            done = self.fleet.trb("fleet", "renew", authority, *whom, check=False)
            self.assertNotEqual(done.returncode, 0, done.stdout)
            self.assertIn("then renew again", done.stderr)
            self.assertNotIn("valid to", done.stdout)
        self.assertEqual(serial("cat"), first)
        (way / "in-the-way").rmdir()
        way.rmdir()
        self.fleet.trb("fleet", "renew", authority, "cat")
        renewed = json.loads(way.read_text())["certificates"]
        self.assertEqual(len(renewed), 1)
        self.assertGreater(serial("cat"), first)
        # It is told also if somebody else is revoked in between.
        self.fleet.trb("fleet", "revoke", authority, "bee")
        self.assertEqual(json.loads(way.read_text())["certificates"], renewed)
        self.fleet.trb("fleet", "tell", authority, "--via", self.fleet.dir("ant"))
        own = self.fleet.dir("cat") / "keys" / "certificate.json"
        self.fleet.wait("cat has it", lambda: json.loads(own.read_text())["certificate"] == renewed[0], 60)


class Robot(unittest.TestCase):
    def setUp(self):
        self.fleet = support.make_fleet(self, trb_fleet.Fleet, block=173, robots={"drone": trb_fleet.ROBOTS["drone"]})
        self.disk = own_world.SmallDisk(self.fleet.dir("drone"))
        self.addCleanup(self.disk.gone)
        self.addCleanup(self.fleet.stop)

    def is_up(self, service):
        done = self.fleet.trb("service", "list", "--json", node="drone", check=False)
        return done.returncode == 0 and f'"service":"{service}","state":"up"' in done.stdout.replace(" ", "")

    def is_fenced(self):
        rows = self.fleet.json("route", "list", node="cloud")["routes"]
        return any(row["id"] == "drone" and row["profile"]["fenced"] for row in rows)

    def start_full(self, first):
        """A start with a full disk: the node's first, or one after a life with room."""
        if not first:
            self.fleet.start()
            self.fleet.wait_formed()
            self.fleet.nodes.pop("drone").stop()
        else:
            self.fleet.start_robot("drone")
            self.fleet.start_node("cloud")
        self.disk.fill()
        self.fleet.start_node("drone")
        for service in "router", "mode-adapter":
            self.fleet.wait(f"{service} is up", lambda: self.is_up(service), 60)
        self.fleet.wait("the cloud sees the robot", lambda: self.fleet.formed("cloud"), 60)

    def check_stop(self):
        done = self.fleet.trb("stop", "drone", node="cloud", check=False)
        self.fleet.wait("the robot is fenced", self.is_fenced, 60)
        fence = self.fleet.dir("drone") / "state" / "fence"
        if done.returncode == 0:
            self.assertTrue(fence.exists())  # acknowledged, so it outlives a restart
        else:
            self.assertIn("the fence is not on disk", done.stderr)
        return done

    def test_a_node_that_starts_again_on_a_full_disk_can_be_stopped(self):
        self.start_full(first=False)
        before = int((self.fleet.dir("drone") / "state" / "boot").read_text())
        self.assertEqual(self.check_stop().returncode, 0)
        self.fleet.nodes.pop("drone").stop()
        self.fleet.start_node("drone")
        self.fleet.wait("the router is up", lambda: self.is_up("router"), 60)
        # Its number has risen, for there was room for that where the last one stood.
        self.assertGreater(int((self.fleet.dir("drone") / "state" / "boot").read_text()), before)
        self.fleet.wait("the fence is there again", self.is_fenced, 60)

    def test_a_node_whose_first_start_is_on_a_full_disk_can_be_stopped(self):
        self.start_full(first=True)
        self.assertIn("not on disk, and lost in a restart", self.fleet.services("drone")["router"]["note"])
        self.check_stop()
        self.disk.room()
        self.fleet.wait("the boot number is stored", lambda: "not on disk" not in self.fleet.services("drone")["router"]["note"], 60)
        self.fleet.wait("the scheduler comes by itself", lambda: self.is_up("scheduler"), 60)

    def test_a_node_whose_lock_could_not_be_written_is_ended_by_its_folder(self):
        folder = self.fleet.dir("drone")
        self.fleet.start_robot("drone")
        self.disk.fill()
        self.fleet.start_node("drone")
        self.fleet.wait("the router is up", lambda: self.is_up("router"), 60)
        self.assertEqual((folder / "state" / "up.lock").read_text(), "")
        again = self.fleet.trb("up", folder, check=False)
        self.assertIn(f"is up already (pid {self.fleet.nodes['drone'].child.pid})", again.stderr)
        self.assertIn("down", self.fleet.trb("down", folder).stdout)


HOVER = {"robot": "drone", "skill": "hover", "data": {"duration": 1}, "retries": 3}


def hovers(count):
    """A run of tasks one after the other, each of which may simply be done again."""
    tasks = [dict(HOVER, id=f"hover{i}", **({"after": [f"hover{i - 1}"]} if i else {})) for i in range(count)]
    return json.dumps({"name": "hovers", "tasks": tasks})


class Work(unittest.TestCase):
    """A node with a robot: what it takes while its disk is full, and what becomes of what it has taken."""
    files = 0

    def setUp(self):
        self.fleet = support.make_fleet(self, trb_fleet.Fleet, block=173, robots={"drone": trb_fleet.ROBOTS["drone"]})
        self.disk = own_world.SmallDisk(self.fleet.dir("drone"), "24m", self.files)
        self.addCleanup(self.disk.gone)
        self.addCleanup(self.fleet.stop)
        folder = support.temporary_folder(self)
        self.paths = {count: folder / f"{count}.json" for count in (1, 6)}
        for count, path in self.paths.items():
            path.write_text(hovers(count))
        self.fleet.start()
        self.fleet.wait_formed()

    def submit(self, count=1):
        return self.fleet.trb("scenario", "run", self.paths[count], "--json", node="drone", check=False)

    def taken(self, count=1):
        done = self.submit(count)
        self.assertEqual(done.returncode, 0, done.stderr)
        return json.loads(done.stdout)["run"]

    def tasks(self, run):
        done = self.fleet.trb("run", "show", run, "--json", node="drone", check=False)
        return [task["state"] for task in json.loads(done.stdout)["tasks"]] if done.returncode == 0 else []

    def wait_finished(self, run):
        self.fleet.wait(f"{run} has FINISHED", lambda: (now := self.tasks(run)) and set(now) == {"FINISHED"}, 60)

    def findings(self):
        report = self.fleet.trb("doctor", "--json", node="drone", check=False)
        return {row["cause"]: row for row in json.loads(report.stdout)["findings"]}

    def check_refused(self, code, command):
        done = self.submit()
        self.assertNotEqual(done.returncode, 0, done.stdout)
        for word in code, str(self.fleet.dir("drone")), command:
            self.assertIn(word, done.stdout)

    def wait_waiting(self):
        """The scheduler is there, and refuses."""
        self.fleet.wait("the doctor says that it waits", lambda: "service_waits" in self.findings(), 60)
        self.assertEqual(self.fleet.services("drone")["scheduler"]["state"], "up")

    def restart_scheduler(self):
        before = self.fleet.services("drone")["scheduler"]["instance"]
        os.kill(self.fleet.pid("drone", "scheduler"), signal.SIGTERM)
        self.fleet.wait("the scheduler is up again", lambda: (now := self.fleet.services("drone")["scheduler"])["state"] == "up"
                        and now["instance"] != before, 60)

    def noted(self):
        """What everybody in the fleet is told of the node: the page shows it, too."""
        return self.fleet.services("drone")["router"]["note"]


class FullDisk(Work):
    def test_with_little_room_it_takes_no_run_and_ends_those_that_it_has(self):
        run = self.taken(6)
        self.disk.fill(but=4_000_000)
        self.check_refused("queue_full", "df -h")
        self.assertEqual(self.findings()["disk_full"]["severity"], "problem")
        self.assertIn("the disk of", self.noted())
        self.wait_finished(run)
        self.assertIn("8000 must be", self.noted())
        self.disk.room()
        # A small disk stays one with little room.
        self.assertRegex(self.noted(), r"^\d+ MB are left on the disk of .*: df -h ")
        self.wait_finished(self.taken())

    def test_without_any_room_its_scheduler_waits_and_goes_on_by_itself(self):
        run = self.taken(6)
        self.fleet.wait("a task has ended", lambda: "FINISHED" in self.tasks(run), 60)
        self.disk.fill()
        self.wait_waiting()
        self.check_refused("no_service", "df -h")
        self.assertEqual(self.findings()["disk_full"]["severity"], "problem")
        self.disk.room()
        self.wait_finished(run)
        self.wait_finished(self.taken())

    def test_a_node_that_starts_without_any_room_is_ready_and_goes_on_by_itself(self):
        run = self.taken(6)
        self.fleet.wait("a task has ended", lambda: "FINISHED" in self.tasks(run), 60)
        self.fleet.nodes.pop("drone").stop()
        self.disk.fill()
        self.fleet.start_node("drone")
        self.fleet.nodes["drone"].wait_line("ready", 60)
        self.wait_waiting()
        self.disk.room()
        self.wait_finished(run)


class ReadOnly(unittest.TestCase):
    def test_by_hand_it_is_named_before_anything_is_started(self):
        fleet = support.make_fleet(self, support.RouterFleet, block=171, services={"ant": ["router"]})
        folder = fleet.dir("ant")
        disk = own_world.SmallDisk(folder)
        self.addCleanup(disk.gone)
        self.addCleanup(fleet.stop)
        fleet.bring_up("ant")
        fleet.nodes.pop("ant").stop()  # its sockets stay
        disk.read_only()
        for words in ("up",), ("up", "--detach"), ("check",):
            with self.subTest(words):
                done = fleet.trb(words[0], folder, *words[1:], check=False)
                self.assertEqual(done.returncode, 1, done.stdout)
                self.assertIn("can be read only: nothing can be started there", done.stderr)
                self.assertIn("remount,rw", done.stderr)


class NoFiles(Work):
    files = 400

    def test_without_inodes_it_takes_no_run_and_ends_those_that_it_has(self):
        run = self.taken(6)
        self.disk.take_files()
        self.check_refused("queue_full", "df -i")
        self.assertEqual(self.findings()["no_inodes"]["severity"], "problem")
        self.wait_finished(run)
        self.restart_scheduler()  # the files that it leaves are those that it needs again
        self.wait_finished(run)
        self.check_refused("queue_full", "df -i")
        self.disk.room()
        self.wait_finished(run)
        self.wait_finished(self.taken())


class Rights(unittest.TestCase):
    def test_nothing_but_its_configuration_can_be_read_by_others(self):
        os.umask(0o022)
        fleet = support.make_fleet(self, trb_fleet.Fleet, block=175, robots={"drone": trb_fleet.ROBOTS["drone"]})
        old = fleet.dir("cloud") / "log"
        old.mkdir(mode=0o755)
        (old / "router.log").write_text("of an earlier release\n")
        (old / "router.log").chmod(0o644)
        fleet.start()
        fleet.wait_formed()
        fleet.trb("stop", "drone", node="cloud")
        seen = set()
        for node in "drone", "cloud":
            folder = pathlib.Path(fleet.dir(node))
            for path in sorted(folder.rglob("*")):
                seen.add(path.name)
                top = path.relative_to(folder).parts[0]
                if top in CONFIGURATION - {"keys"} or path.is_symlink() or str(path.relative_to(folder)) in FOR_ALL:
                    continue
                mode = stat.S_IMODE(path.lstat().st_mode)
                self.assertEqual(mode & 0o077, 0, f"{path} has the mode {mode:o}")
        self.assertLessEqual({"router.log", "mode-adapter.log", "journal.db", "fence", "boot", "up.lock", "probe.ipc",
                              "link.key"}, seen)


if __name__ == "__main__":
    own_world.enter()
    support.main()
