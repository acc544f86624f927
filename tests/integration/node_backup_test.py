"""A node put on a new PC from a backup, also from one that is too old: peers take it, and nothing is done twice.

Addresses 127.0.252.x, 127.0.253.x.
"""
import json
import pathlib
import shutil
import signal
import socket
import stat
import unittest

import gateway_case
import support
import trb_fleet
from gateway_case import ADMIN
from trb_fleet import CLOUD

ROBOT, OTHER = "ridgeback", "pioneer1"
TASKS = [{"id": "first", "robot": ROBOT, "skill": "load_out"},
         {"id": "away", "robot": OTHER, "skill": "go_to", "data": {"place": "dock"}, "after": ["first"]},
         {"id": "last", "robot": ROBOT, "skill": "go_to", "data": {"place": "dock"}, "after": ["away"]}]


def has_processes(folder):
    for path in pathlib.Path("/proc").glob("[0-9]*/cmdline"):
        try:
            if str(folder).encode() in path.read_bytes():
                return True
        except OSError:
            pass  # it has just ended
    return False


def lose(fleet, node):
    """The node's folder goes, once the last of its processes has ended."""
    fleet.wait("its processes end", lambda: not has_processes(fleet.dir(node)), 60)
    shutil.rmtree(fleet.dir(node))


class Backup(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        robots = {name: trb_fleet.ROBOTS[name] for name in (ROBOT, OTHER)}
        cls.fleet = support.make_fleet(cls, block=252, udp_port=50252, robots=robots, speed=5)
        cls.folder = support.temporary_folder(cls)
        cls.fleet.start()
        cls.fleet.wait_formed()

    def backup(self, node, file, folder=None, **more):
        return self.fleet.trb("node", "backup", folder or self.fleet.dir(node), file, **more)

    def restore(self, file, folder, **more):
        return self.fleet.trb("node", "restore", file, folder, **more)

    def stop_node(self, node, how=signal.SIGTERM):
        self.fleet.nodes.pop(node).stop(how)

    def start_node(self, node):
        self.fleet.start_node(node)
        self.fleet.nodes[node].wait_line("ready", 60)
        self.fleet.wait_formed(60)

    def boot(self, folder):
        return int((folder / "state" / "boot").read_text())

    def times_begun(self, skill):
        self.fleet.pump()
        return sum(line.split()[:2] == ["start", skill] for line in self.fleet.virtual[ROBOT].lines)

    def task(self, run, name):
        shown = self.fleet.json("run", "show", run, node=CLOUD)
        return next(task for task in shown["tasks"] if task["id"] == name)

    def wait_task(self, run, name, state):
        self.fleet.wait(f"{name} {state}", lambda: self.task(run, name)["state"] == state, 60)

    def out_of_use(self):
        routes = self.fleet.json("route", "list", node=CLOUD)["routes"]
        return next(route for route in routes if route["id"] == ROBOT)["profile"]["out_of_use"]

    def release(self, robot):
        self.fleet.trb("release", robot, node=CLOUD)

    def test_a_restore_that_is_too_old(self):
        file = self.folder / "ridgeback.backup"
        refused = self.backup(ROBOT, file, check=False)
        self.assertIn("is up: its router answers", refused.stderr)
        self.assertIn("systemctl stop talkrobots", refused.stderr)  # there trb down ends it for a second
        self.stop_node(ROBOT)
        self.backup(ROBOT, file)
        self.assertEqual(stat.S_IMODE(file.stat().st_mode), 0o600)
        self.start_node(ROBOT)

        # What the backup does not know: a certificate, a list of revocations, further starts, half of a run.
        old = self.serial_of(self.fleet.dir(ROBOT))
        self.fleet.trb("fleet", "renew", self.fleet.authority_dir(), ROBOT, "--via", self.fleet.dir(CLOUD))
        self.fleet.wait("it is renewed", lambda: self.serial_of(self.fleet.dir(ROBOT)) != old, 60)
        serial = self.serial_of(self.fleet.dir(ROBOT))
        self.fleet.trb("stop", OTHER, node=CLOUD)
        path = self.folder / "s.json"
        path.write_text(json.dumps({"name": "s", "tasks": TASKS}))
        run = self.fleet.json("scenario", "run", path, node=CLOUD)["run"]
        self.wait_task(run, "first", "FINISHED")
        before = self.boot(self.fleet.dir(ROBOT))

        # Its PC is lost; what was kept goes onto a new one.
        self.stop_node(ROBOT, signal.SIGKILL)
        lose(self.fleet, ROBOT)
        said = self.restore(file, self.fleet.dir(ROBOT)).stdout
        self.assertIn("made ", said)
        self.assertIn(f"trb robot repaired {ROBOT}", said)
        self.assertNotIn("sign in", said)
        self.assertEqual(self.serial_of(self.fleet.dir(ROBOT)), old)
        self.start_node(ROBOT)
        self.assertGreater(self.boot(self.fleet.dir(ROBOT)), before)
        self.fleet.wait("its newest certificate comes back", lambda: self.serial_of(self.fleet.dir(ROBOT)) == serial, 60)

        # Nothing is begun before a person has looked: neither what was done, nor what is new to it.
        self.fleet.wait("out of use", self.out_of_use, 60)
        self.assertIn("journal was lost", self.out_of_use()[0]["text"])
        self.release(OTHER)
        self.wait_task(run, "away", "FINISHED")
        self.assertEqual((self.times_begun("load_out"), self.times_begun("go_to")), (1, 0))
        self.fleet.trb("robot", "repaired", ROBOT, node=CLOUD)
        self.release(ROBOT)
        self.wait_task(run, "last", "FINISHED")
        self.fleet.wait("the run is over", lambda: self.fleet.json("run", "show", run, node=CLOUD)["state"] == "FINISHED", 60)
        self.assertEqual((self.times_begun("load_out"), self.times_begun("go_to")), (1, 1))

    def serial_of(self, folder):
        shown = self.fleet.json("fleet", "show", folder / "keys" / "certificate.json")
        return shown["serial"]

    def test_what_is_no_backup_of_ours(self):
        self.stop_node(OTHER)
        self.addCleanup(self.start_node, OTHER)
        file, folder = self.folder / "other.backup", self.folder / "restored"
        self.backup(OTHER, file)
        self.assertIn("is there already", self.backup(OTHER, file, check=False).stderr)
        whole = file.read_bytes()
        secret = bytes.fromhex((self.fleet.dir(OTHER) / "keys" / "link.key").read_text().strip())
        self.assertNotIn(secret, whole)
        self.assertNotIn(secret.hex().encode(), whole)
        cases = {"damaged": whole[:-1] + bytes([whole[-1] ^ 1]), "wrong": whole[:200], "no backup": b"PK" + whole,
                 "a newer trb": whole.replace(b"backup 1\n", b"backup 2\n")}
        for said, content in cases.items():
            with self.subTest(said):
                bad = self.folder / "bad.backup"
                bad.write_bytes(content)
                self.assertIn(said, self.restore(bad, folder, check=False).stderr)
                self.assertFalse(folder.exists())
        self.assertIn("is there already", self.restore(file, self.fleet.dir(OTHER), check=False).stderr)
        self.restore(file, folder)
        self.assertEqual(stat.S_IMODE((folder / "keys" / "link.key").stat().st_mode), 0o600)
        self.assertEqual(self.fleet.trb("check", folder).returncode, 0)
        self.assertFalse((folder / "state" / "journal.db").exists())
        self.a_router_that_answers_over_tcp_is_noticed(folder)

    def a_router_that_answers_over_tcp_is_noticed(self, folder):
        """One that no `trb up` has started: in a container of its own."""
        config, other = json.loads((folder / "node.json").read_text()), self.folder / "tcp.backup"
        with socket.create_server(("127.0.252.77", 0)) as router:
            bus = "tcp://%s:%d" % router.getsockname()
            (folder / "node.json").write_text(json.dumps({**config, "bus": bus}))
            self.assertIn("its router answers", self.backup(OTHER, other, check=False, folder=folder).stderr)
        self.backup(OTHER, other, folder=folder)


class Cloud(gateway_case.GatewayCase):
    block, udp_port = 252, 50253

    def backup_of_the_stopped_cloud(self, how):
        self.fleet.nodes.pop(CLOUD).stop(how)
        file = support.temporary_folder(self) / "cloud.backup"
        folder = self.fleet.dir(CLOUD)
        self.fleet.wait("its router ends", lambda: self.fleet.trb("node", "backup", folder, file, check=False).returncode == 0, 60)
        return file

    def start_cloud(self):
        self.fleet.start_node(CLOUD)
        self.fleet.wait("the gateway is ready", self.is_ready, 60)
        self.assertEqual(self.admin.sign_in("admin", ADMIN).status, 201)

    def users(self):
        return {one["name"] for one in self.admin.ask("GET", "/api/v1/users").json["users"]}

    def exported(self, name):
        path = support.temporary_folder(self) / name
        path.write_bytes(self.admin.ask("GET", "/api/v1/audit/export").bytes)
        return path

    def verify(self, *files):
        return self.fleet.trb("audit", "verify", *files, "--fleet", self.fleet.authority_dir(), check=False)

    def test_a_restore_is_on_record_and_the_log_of_before_parts_from_that_of_after(self):
        user = {"name": "mallory", "role": "operator", "password": gateway_case.GOOD}
        self.assertEqual(self.admin.ask("POST", "/api/v1/users", user).status, 201)
        file = self.backup_of_the_stopped_cloud(signal.SIGTERM)
        self.start_cloud()
        self.assertEqual(self.admin.ask("DELETE", "/api/v1/users/mallory").status, 204)
        before = self.exported("before.jsonl")
        self.assertEqual(self.verify(before).returncode, 0)
        self.fleet.nodes.pop(CLOUD).stop(signal.SIGKILL)
        lose(self.fleet, CLOUD)
        said = self.fleet.trb("node", "restore", file, self.fleet.dir(CLOUD)).stdout
        self.assertIn("who was removed, locked or given less since is there again", said)
        self.assertNotIn("its robot", said)
        self.start_cloud()
        self.assertIn("mallory", self.users())
        after = self.exported("after.jsonl")
        records = [line["record"] for line in map(json.loads, after.read_text().splitlines()) if "record" in line]
        restored = next(one for one in records if one["action"] == "restored")
        self.assertEqual(restored["who"], "console")
        self.assertGreater(restored["number"], 1_700_000_000_000)  # its time in ms
        self.assertEqual(records[records.index(restored) + 1]["number"], restored["number"] + 1)
        alone = self.verify(after)
        self.assertEqual(alone.returncode, 0, alone.stdout)
        self.assertIn("restored from the backup of", alone.stdout)
        both = self.verify(before, after)
        self.assertEqual(both.returncode, 1, both.stdout)
        self.assertIn("logs 1 and 2 PART after record", both.stdout)
        self.assertIn("console: restored", both.stdout)

    def test_nobody_is_signed_in_on_the_new_pc(self):
        made = self.admin.ask("POST", "/api/v1/tokens", {"name": "shop", "role": "viewer", "days": 1})
        self.assertEqual(made.status, 201, made.bytes)
        token = made.json["secret"]
        self.assertEqual(self.client(token).ask("GET", "/api/v1/robots").status, 200)
        file = self.backup_of_the_stopped_cloud(signal.SIGKILL)
        lose(self.fleet, CLOUD)
        said = self.fleet.trb("node", "restore", file, self.fleet.dir(CLOUD)).stdout
        self.assertIn("sign in again", said)
        self.assertNotIn("trb robot", said)
        self.fleet.start_node(CLOUD)
        self.fleet.wait("the gateway is ready", self.is_ready, 60)
        self.assertEqual(self.admin.ask("GET", "/api/v1/robots").status, 401)
        self.assertEqual(self.client(token).ask("GET", "/api/v1/robots").status, 401)
        self.assertEqual(self.admin.sign_in("admin", ADMIN).status, 201)
        self.assertEqual(self.client().sign_in("olga", gateway_case.GOOD).status, 201)
        self.fleet.wait("the robot is shown online", self.is_online, 60)


if __name__ == "__main__":
    support.main()
