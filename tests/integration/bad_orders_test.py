"""What a living fleet refuses: a robot of lines, and a cloud."""
import json
import os
import shutil
import signal
import subprocess

import support
from bad_input_case import NO_JSON, Case, changed, run

BLOCK = 52
UDP_PORT = 50052


def task(**more):
    return dict({"id": "a", "robot": "ridgeback", "skill": "go_to", "data": {"place": "dock"}}, **more)


# A scenario's tasks: key, part of the text and of the cure.
SCENARIOS = {
    "a cycle": ([task(after=["b"]), task(id="b", after=["a"])], None, "a -> b -> a", ""),
    "an id twice": ([task(), task()], "tasks[1].id", "'a'", ""),
    "an unknown predecessor": ([task(after=["c"])], None, "'c'", ""),
    "no tasks": ([], "tasks", "", ""),
    "a task without a skill": ([{"id": "a", "robot": "ridgeback"}], "tasks[0].skill", "is missing", ""),
    "a number as robot": ([task(robot=3)], "tasks[0].robot", "whole number", "text"),
    "an unknown key": ([task(skil="x")], "tasks[0].skil", "no key", "skill"),
    "an unknown robot": ([task(robot="ridgebak")], "tasks[0].robot", "'ridgebak' is no robot of the fleet", "did you mean 'ridgeback'"),
    "an unknown skill": ([task(skill="goto")], "tasks[0].skill", "has no skill 'goto'", "did you mean 'go_to'"),
    "an unknown place": ([task(data={"place": "dok"})], "tasks[0].data.place", "'dok' is no place", "did you mean 'dock'"),
    "a number as place": ([task(data={"place": 3})], "tasks[0].data.place", "whole number", "name of a place"),
    "a missing parameter": ([task(data={})], "tasks[0].data.place", "is missing", "place"),
    "an unknown parameter": ([task(data={"place": "dock", "spead": 1})], "tasks[0].data.spead", "no such parameter", ""),
}
NEEDS_THE_FLEET = {what for what, row in SCENARIOS.items() if row[1] and ("data" in row[1] or row[3].startswith("did you mean"))}


class Living(Case):
    @classmethod
    def setUpClass(cls):
        robots = {"ridgeback": support.trb_fleet.ROBOTS["ridgeback"]}
        cls.fleet = support.make_fleet(cls, block=BLOCK, udp_port=UDP_PORT, robots=robots)
        cls.fleet.start()
        cls.fleet.wait_formed()
        cls.cloud = cls.fleet.dir("cloud")
        cls.robot = cls.fleet.dir("ridgeback")

    def scenario(self, tasks):
        path = self.temporary() / "s.json"
        path.write_text(json.dumps({"name": "n", "tasks": tasks}))
        return path

    def test_scenarios(self):
        for what, (tasks, key, text, cure) in SCENARIOS.items():
            with self.subTest(what):
                path = self.scenario(tasks)
                for command in ("check", "run"):
                    faults = self.faults_of("scenario", command, path, "--node", self.cloud)
                    self.assert_fault(faults, "s.json", faults[0]["key"] if key is None else key, text, cure)
                if what not in NEEDS_THE_FLEET:
                    self.faults_of("scenario", "check", path)
        for path, text in (("/nowhere.json", "no such file"), (self.temporary(), "")):
            for command in ("check", "run"):
                self.assert_fault(self.faults_of("scenario", command, path, "--node", self.cloud), str(path), "", text, "scenario")
        # What the fleet says is told together with what is wrong in the file, and that it was not asked.
        both = self.scenario([task(after=["c"], skill="goto"), task(id="b", skill=3, robot="ridgebak")])
        faults = self.faults_of("scenario", "check", both, "--node", self.cloud)
        self.assertEqual([fault["key"] for fault in faults], ["tasks[1].skill", "tasks[0].after", "tasks[0].skill"])
        for node, why in (((), "no --node"), (("--node", self.temporary()), "no node.json")):
            done = run("scenario", "check", both, *node)
            self.assertIn("trb: 2 faults\ntrb: robots, skills, places and sensors were not checked: ", done.stderr)
            self.assertIn(why, done.stderr.splitlines()[-1])
            self.assertIs(json.loads(run("scenario", "check", both, *node, "--json").stdout)["fleet_checked"], False)
        malformed = self.temporary() / "m.json"
        malformed.write_text(NO_JSON)
        self.assert_fault(self.faults_of("scenario", "run", malformed, "--node", self.cloud), "m.json", "", "line 3, column 5", "")
        self.assertEqual(self.fleet.json("scenario", "list", node="cloud")["runs"], [])

    def test_what_the_fleet_refuses(self):
        node = ("--node", self.cloud)
        self.error_of("scenario", "run", self.scenario([task()]), "--expires-h", "9000", *node, code="bad_value",
                      what="--expires-h: '9000' is over 8784", cure="at most 8784")
        self.error_of("send", "ridgebak", "command", "greeting", *node, code="unknown_target", what="'ridgebak'",
                      cure="did you mean 'ridgeback'?")
        self.error_of("send", "cloud", "command", "greeting", *node, code="no_service", what="greeting", cure="trb service list")
        self.error_of("send", "ridgeback", "command", "execute", *node, code="not_permitted", what="execute", cure="")
        self.error_of("scenario", "watch", "ffff", *node, code="unknown_run", what="ffff", cure="trb run list")
        self.error_of("scenario", "abort", "ffff", *node, code="unknown_run", what="ffff", cure="trb run list")
        self.error_of("service", "counters", "mode-adapter", *node, code="no_service", what="mode-adapter",
                      cure="trb service list")
        done = run("stop", "ridgebak", "--json", *node)
        self.assertEqual((done.returncode, json.loads(done.stdout)["robots"][0]["state"]), (1, "unreachable"))

    def test_a_node_that_is_not_up(self):
        folder = self.temporary() / "cloud"
        shutil.copytree(self.cloud, folder, ignore=shutil.ignore_patterns("bus", "state", "log"))
        self.error_of("reload", folder, code="missing", what="is not up", cure="trb up")
        self.error_of("route", "list", "--node", folder, code="timeout", what="does not answer", cure="trb up")
        self.assert_nothing_started(folder)

    def test_a_router_that_stands_for_seconds_takes_the_stop_when_it_goes_on(self):
        router = self.fleet.pid("cloud", "router")
        self.addCleanup(run, "release", "ridgeback", "--timeout", "30", "--node", self.cloud)
        os.kill(router, signal.SIGSTOP)
        self.addCleanup(os.kill, router, signal.SIGCONT)
        stop = subprocess.Popen([support.PROGRAMS / "trb", "stop", "ridgeback", "--timeout", "30", "--json",
                                 "--node", self.cloud], stdout=subprocess.PIPE, text=True)
        with self.assertRaises(subprocess.TimeoutExpired):
            stop.wait(3)  # it would have given up after two seconds if nobody were there
        os.kill(router, signal.SIGCONT)
        said, _ = stop.communicate(timeout=60)
        self.assertEqual((stop.returncode, json.loads(said)["robots"][0]["state"]), (0, "confirmed"))

    def test_up_twice(self):
        before = self.fleet.services("ridgeback")
        self.error_of("up", self.robot, code="conflict", what="is up already (pid ", cure="reload")
        self.assertEqual({n: s["pid"] for n, s in self.fleet.services("ridgeback").items()},
                         {n: s["pid"] for n, s in before.items()})

    def test_a_broken_file_keeps_the_node_running_and_a_good_one_is_taken(self):
        path = self.robot / "robots" / "ridgeback.json"
        good = path.read_text()
        self.addCleanup(path.write_text, good)
        before = self.fleet.services("ridgeback")["mode-adapter"]
        changed("robots/ridgeback.json", "skills", "fetch", "end", None)(self.robot)
        self.assert_fault(self.faults_of("reload", self.robot), "robots/ridgeback.json", "skills.fetch.end", "has no end", "")
        self.assertEqual(self.fleet.services("ridgeback")["mode-adapter"]["instance"], before["instance"])
        path.write_text(good)
        changed("robots/ridgeback.json", "model", "Ridgeback Mark 2")(self.robot)
        self.assertEqual(run("reload", self.robot).returncode, 0)
        self.fleet.wait("the other nodes see the new description", lambda: self.model() == "Ridgeback Mark 2", 60)
        self.assertNotEqual(self.fleet.services("ridgeback")["mode-adapter"]["instance"], before["instance"])
        self.fleet.wait_formed()

    def model(self):
        rows = self.fleet.json("route", "list", node="cloud")["routes"]
        return next((row["profile"]["model"] for row in rows if row["id"] == "ridgeback"), "")


if __name__ == "__main__":
    support.main()
