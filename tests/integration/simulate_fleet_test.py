"""`trb simulate --fleet DIR --scenario FILE`: a fleet's own folders and a scenario, played before anything is started."""
import json
import pathlib
import re
import shutil
import subprocess
import tempfile
import unittest

import support
import trb_fleet

REPO = pathlib.Path(__file__).resolve().parent.parent.parent
SCENARIO = REPO / "config/scenarios/paper-nine-tasks.json"


class AFleetAsItIs(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory(prefix="trb-hall-")
        cls.addClassCleanup(folder.cleanup)
        cls.root = pathlib.Path(folder.name)
        trb_fleet.Fleet(cls.root / "fleet", support.PROGRAMS, block=191, udp_port=50191).make()
        cls.nodes = cls.root / "fleet" / "nodes"

    def simulate(self, *words, scenario=SCENARIO):
        command = [support.PROGRAMS / "trb", "simulate", "--fleet", self.nodes, "--scenario", scenario, *words]
        return subprocess.run(list(map(str, command)), capture_output=True, text=True, timeout=60)

    def answer(self, *words, **more):
        done = self.simulate(*words, "--json", **more)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        return json.loads(done.stdout)

    def write(self, name, content):
        path = self.root / name
        path.write_text(json.dumps(content))
        return path

    def test_the_paper_s_nine_tasks_are_done_by_their_robots_and_the_critical_path_is_told(self):
        found = self.answer()
        self.assertEqual(found["world"]["state"], "FINISHED")
        self.assertEqual(found["world"]["broken"], [])
        by_id = {task["id"]: task for task in found["tasks"]}
        self.assertEqual(len(by_id), 9)
        self.assertEqual(by_id["take_off"]["robot"], "drone")
        waits = {row["task"]: row for row in found["waits"]}
        self.assertEqual(waits["run_conveyor"]["waited_for"], "fetch_box")
        critical = [row["task"] for row in found["waits"] if row["critical"]]
        self.assertEqual(critical[:4], ["fetch_box", "run_conveyor", "put_box_down", "go_to_ur3"])
        # Seven tasks one after the other, three seconds each.
        self.assertEqual(len(critical), 7)
        self.assertGreater(found["world"]["makespan_s"], 21)
        self.assertLess(found["world"]["makespan_s"], 22)

    def test_a_skill_s_own_time_makes_the_run_longer_by_as_much(self):
        usual = self.answer()["world"]["makespan_s"]
        longer = self.answer("--times", self.write("times.json", {"run": 13}))["world"]["makespan_s"]
        self.assertAlmostEqual(longer - usual, 10, delta=0.5)

    def test_without_each_robot_it_is_told_which_runs_could_not_be(self):
        rows = {row["robot"]: row for row in self.answer("--one-less")["one_less"]}
        self.assertIn("makespan_s", rows["pioneer1"])  # it has no task
        self.assertIn("drone", rows["drone"]["why_not"])
        table = self.simulate("--one-less").stdout
        self.assertIn("WITHOUT", table)
        self.assertIn("* fetch_box", table)

    def test_a_trace_is_that_of_the_whole_fleet_whatever_is_played_without_a_robot(self):
        alone, beside = self.root / "alone.jsonl", self.root / "beside.jsonl"
        self.answer("--trace", alone)
        self.answer("--trace", beside, "--one-less")
        self.assertEqual(alone.read_bytes(), beside.read_bytes())

    def test_what_is_planned_of_a_robot_is_left_out_with_it(self):
        faults = self.write("of-pioneer1.json", [
            {"at": 1, "kind": "fail", "node": "pioneer1"}, {"at": 2, "kind": "cut", "node": "cloud", "other": "pioneer1"},
            {"at": 3, "kind": "partition", "nodes": ["pioneer1"]}, {"at": 4, "kind": "heal", "nodes": ["pioneer1"]}])
        values = self.write("at-pioneer1.json", [{"node": "pioneer1", "name": "humidity", "unit": "percent", "value": 40}])
        found = self.answer("--one-less", "--faults", faults, "--sensor-values", values, "--relays", "pioneer1,cloud")
        rows = {row["robot"]: row for row in found["one_less"]}
        self.assertIn("makespan_s", rows["pioneer1"], rows["pioneer1"])
        self.assertIn("resilience.json is not read", self.simulate("--faults", faults).stdout)

    def test_two_folders_with_one_id_are_refused_by_both_names(self):
        shutil.copytree(self.nodes / "pioneer1", self.nodes / "pioneer1-copy")
        self.addCleanup(shutil.rmtree, self.nodes / "pioneer1-copy")
        done = self.simulate()
        self.assertEqual(done.returncode, 1, done.stdout)
        for word in ("'pioneer1'", str(self.nodes / "pioneer1") + ";", "pioneer1-copy"):
            self.assertIn(word, done.stderr)

    def test_a_sensor_of_the_cloud_has_the_unit_of_its_folder_s_rule(self):
        cloud = next(path.parent for path in self.nodes.glob("*/node.json") if json.loads(path.read_text()).get("role") == "cloud")
        shutil.copytree(REPO / "config/sensors", cloud / "sensors")
        self.addCleanup(shutil.rmtree, cloud / "sensors")
        scenario = self.write("warm.json", {"name": "warm", "tasks": [
            {"id": "go", "robot": "drone", "skill": "take_off",
             "when": {"sensor": "temperature", "of": "cloud", "op": ">", "value": 20, "unit": "degC"}}]})
        values = self.write("cloud.json", [{"node": "cloud", "name": "temperature", "value": 25}])
        self.assertEqual(self.answer("--sensor-values", values, scenario=scenario)["world"]["tasks_done"], 1)

    def test_the_picking_side_is_chosen_by_the_simulated_thermometer_with_the_unit_of_its_node_s_rule(self):
        scenario = REPO / "config/scenarios/paper-temperature.json"
        shutil.copytree(REPO / "config/sensors", self.nodes / "conveyor/sensors")
        self.addCleanup(shutil.rmtree, self.nodes / "conveyor/sensors")
        for celsius, done, skipped in ((18, "pick_left", "pick_right"), (25, "pick_right", "pick_left")):
            with self.subTest(celsius):
                values = self.write("values.json", [{"node": "conveyor", "name": "temperature", "value": celsius}])
                found = self.answer("--sensor-values", values, scenario=scenario)
                self.assertEqual(found["world"]["state"], "FINISHED")
                self.assertEqual(found["world"]["broken"], [])
                attempted = {task["id"] for task in found["tasks"]}
                self.assertIn(done, attempted)
                self.assertNotIn(skipped, attempted)
        refused = self.simulate(scenario=scenario)
        self.assertEqual(refused.returncode, 1)
        self.assertIn("temperature of conveyor", refused.stderr)

    def test_the_last_end_is_the_makespan_also_if_the_first_attempt_of_all_fails(self):
        scenario = self.write("again.json", {"name": "again", "tasks": [
            {"id": "b", "requires": ["mobile"], "skill": "go_to", "data": {"place": "ur3_front"}},
            {"id": "c", "robot": "ridgeback", "skill": "go_to", "data": {"place": "ur3_front"}, "after": ["b"]}]})
        faults = self.write("of-the-first.json", [{"at": 6, "kind": "fail", "node": "pioneer1"}])
        words = ("--task-seconds", 10, "--faults", faults)
        table = self.simulate(*words, scenario=scenario).stdout
        self.assertRegex(table, r"b +pioneer1 +0\.0 +\d\.\d failed +-\n")
        self.assertRegex(table, r"b +pioneer2 .* pioneer1, which failed at it; then 2\.\d s for something else")
        last = re.search(r"c +ridgeback +\S+ +(\S+) +b", table)[1]
        self.assertIn(f"2 tasks in {last} s", table)
        found = self.answer(*words, scenario=scenario)
        self.assertEqual([(row["task"], row["waited_for"], row["tried_again"]) for row in found["waits"]],
                         [("b", "b", True), ("c", "b", False)])

    def test_what_is_behind_a_cut_link_holds_a_task_up_and_the_critical_path_begins_there(self):
        go = {"skill": "go_to", "data": {"place": "ur3_front"}}
        scenario = self.write("cut.json", {"name": "cut", "tasks": [
            {"id": "a", "robot": "ridgeback", **go}, {"id": "b", "robot": "ridgeback", **go, "after": ["a"]},
            {"id": "c", "robot": "pioneer1", **go}, {"id": "d", "robot": "ridgeback", **go, "after": ["b", "c"]}]})
        faults = self.write("cut-and-healed.json", [{"at": 2, "kind": "cut", "node": "pioneer1"}, {"at": 60, "kind": "heal", "node": "pioneer1"}])
        words = ("--faults", faults)
        waits = {row["task"]: row for row in self.answer(*words, scenario=scenario)["waits"]}
        self.assertGreater(waits["d"]["more_s"], 50)
        self.assertEqual([task for task, row in waits.items() if row["critical"]], ["d"])
        table = self.simulate(*words, scenario=scenario).stdout
        self.assertRegex(table, r"\* d +ridgeback .* b; then 5\d\.\d s for something else")
        self.assertIn(", or waits less for something else", table)
        self.assertRegex(table, r"AT +HAPPENED +WHERE\n2 s +cut +pioneer1\n60 s +heal +pioneer1\n")
        self.assertNotIn("links were up", table)

    def test_scenarios_at_the_same_time_are_told_each_and_what_they_cost_each_other(self):
        go = {"skill": "go_to", "data": {"place": "ur3_front"}}
        first = self.write("first.json", {"name": "first", "tasks": [
            {"id": "a", "robot": "ridgeback", **go}, {"id": "b", "robot": "ridgeback", **go, "after": ["a"]}]})
        second = self.write("second.json", {"name": "second", "tasks": [{"id": "a", "robot": "ridgeback", **go}]})
        free = self.write("free.json", {"name": "free", "tasks": [{"id": "a", "robot": "pioneer1", **go}]})
        words = ("--beside", second, "--beside", f"{free}@20")
        found = self.answer(*words, scenario=first)
        self.assertEqual([run["scenario"] for run in (found["world"], *found["beside"])], ["first", "second", "free"])
        self.assertEqual([run["state"] for run in (found["world"], *found["beside"])], ["FINISHED"] * 3)
        self.assertEqual([run["broken"] for run in found["beside"]], [[], []])
        # Ridgeback does the second scenario's task between the first one's two, or behind them.
        kept = [row for run in (found, found["beside"][0]) for row in run["waits"] if "kept_s" in row]
        self.assertTrue(kept)
        self.assertAlmostEqual(found["alone_s"], 6, delta=0.5)
        self.assertAlmostEqual(found["beside"][0]["alone_s"], 3, delta=0.5)
        self.assertAlmostEqual(found["beside"][1]["submitted_s"] - found["world"]["submitted_s"], 20, delta=0.2)
        self.assertFalse([row for row in found["beside"][1]["waits"] if "kept_s" in row])
        table = self.simulate(*words, scenario=first).stdout
        self.assertIn("Run 2, 'second':", table)
        self.assertRegex(table, r"RUN +SCENARIO +SUBMITTED +STATE +TASKS +MAKESPAN +ALONE +WAITED FOR ROBOTS OF OTHER RUNS\n")
        self.assertRegex(table, r"3 +free +20\.0 s +FINISHED +1 +3\.0 s +3\.0 s +-")
        self.assertRegex(table, r"ridgeback, which did \w of run [12]")
        for more, wanted in ((("--beside", self.root / "no.json"), "no.json"), (("--beside", f"{free}@-1"), "@-1"),
                             (("--beside", free) * 10, "--beside")):
            with self.subTest(wanted):
                refused = self.simulate(*words, *more, scenario=first)
                self.assertEqual(refused.returncode, 1, refused.stdout)
                self.assertIn(wanted, refused.stderr)

    def test_what_one_robot_less_would_change_is_told_of_each_run_at_the_same_time(self):
        go = {"skill": "go_to", "data": {"place": "ur3_front"}}
        first = self.write("with-one.json", {"name": "with one", "tasks": [{"id": "a", "robot": "ridgeback", **go}]})
        second = self.write("with-other.json", {"name": "with other", "tasks": [{"id": "a", "robot": "pioneer1", **go}]})
        words = ("--beside", second, "--one-less")
        rows = {row["robot"]: row["runs"] for row in self.answer(*words, scenario=first)["one_less"]}
        self.assertEqual([round(run["makespan_s"]) for run in rows["drone"]], [3, 3])
        self.assertEqual([("pioneer1" in run["why_not"], "makespan_s" in run) for run in rows["pioneer1"]], [(True, False)] * 2)
        table = self.simulate(*words, scenario=first).stdout
        self.assertRegex(table, r"WITHOUT +RUN 1 +RUN 2 *\n")
        self.assertRegex(table, r"drone +3\.0 s +3\.0 s")
        self.assertRegex(table, r"pioneer1 +- +- +beside\[0\]\.scenario\.tasks\[0\]\.robot")

    def test_one_seed_is_one_run(self):
        self.assertEqual(self.answer("--seed", 7), self.answer("--seed", 7))

    def test_what_is_wrong_is_named_before_anything_is_played(self):
        bad = self.write("bad.json", {"name": "x", "tasks": [{"id": "t", "robot": "drone", "skill": "swim"}]})
        for words, scenario, wanted in (((), bad, "swim"), ((), self.root / "nowhere.json", "nowhere.json"),
                                        (("--times", self.write("wrong.json", {"run": 0})), SCENARIO, "times.run"),
                                        (("--times", self.root / "no.json"), SCENARIO, "no.json"),
                                        (("--seed", "x"), SCENARIO, "--seed"), (("--robots", "5"), SCENARIO, "--robots"),
                                        (("--protocol", "paper"), SCENARIO, "--protocol")):
            with self.subTest(wanted):
                done = self.simulate(*words, scenario=scenario)
                self.assertEqual(done.returncode, 1, done.stdout)
                self.assertIn(wanted, done.stderr)
        nothing = subprocess.run([support.PROGRAMS / "trb", "simulate", "--fleet", self.root, "--scenario", SCENARIO],
                                 capture_output=True, text=True, timeout=60)
        self.assertEqual(nothing.returncode, 1)
        self.assertIn("no folder of a robot's node", nothing.stderr)
        alone = subprocess.run([support.PROGRAMS / "trb", "simulate", "--one-less"], capture_output=True, text=True, timeout=60)
        self.assertEqual(alone.returncode, 1)
        self.assertIn("--fleet", alone.stderr)


if __name__ == "__main__":
    support.main()
