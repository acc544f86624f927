"""`trb model` and `trb simulate`: the paper's equations, and the same fleets counted message by message."""
import csv
import io
import json
import os
import pathlib
import resource
import signal
import subprocess
import tempfile
import unittest

import support

REPO = pathlib.Path(__file__).resolve().parent.parent.parent
SCENARIO = REPO / "config/scenarios/paper-nine-tasks.json"
WORST = ("--robots", 5, "--sensors", 1, "--seconds", 180, "--remote-requests", 1, "--faulty", 1)


def trb(*words):
    return subprocess.run([support.PROGRAMS / "trb", *map(str, words)], capture_output=True, text=True, timeout=60)


def answer_of(*words):
    done = trb(*words, "--json")
    assert done.returncode == 0, done.stdout + done.stderr
    return json.loads(done.stdout)


class Model(unittest.TestCase):
    def test_the_best_case_prints_each_term_and_251(self):
        done = trb("model", "--robots", 5, "--direct", 9, "--blocks", 1, "--block-tasks", 9, "--local-requests", 1, "--sensors", 1,
                   "--seconds", 180)
        self.assertEqual(done.returncode, 0, done.stderr)
        rows = {line.split()[0]: line.split()[-1] for line in done.stdout.splitlines()[1:]}
        self.assertEqual(rows, {"boot": "16", "identification": "15", "devices": "182", "start": "213", "task": "36", "forward": "0",
                                "scenario": "36", "sensor": "2", "fail": "0", "total": "251"})

    def test_the_worst_case_gives_299_and_says_why_the_paper_has_297(self):
        found = answer_of("model", "--interpreted", 9, *WORST)
        self.assertEqual(found["terms"]["total"], 299)
        self.assertIn("297", found["notes"][0])

    def test_a_scenario_gives_the_parameters(self):
        found = answer_of("model", "--scenario", SCENARIO, "--interpreted", "ridgeback,ur3")
        parameters = found["parameters"]
        self.assertEqual([parameters[key] for key in ("n", "N_d", "N_i", "k", "R_l", "R_e")], [4, 3, 6, 0, 0, 0])
        self.assertEqual(found["terms"]["forward"], 8)

    def test_what_cannot_be_is_refused_by_name(self):
        for words, wanted in ((("--robots", 0), "n (--robots)"), (("--robots", "five"), "--robots: 'five'"),
                              (("--robots", 2, "--direct", 3, "--faulty", 2), "N_f (--faulty)"),
                              (("--robots", 2, "--direct", 3, "--seconds", "-1"), "--seconds"),
                              (("--scenario", "/nowhere.json"), "/nowhere.json"),
                              (("--scenario", SCENARIO, "--robots", 2), "n (--robots)"),
                              (("--scenario", SCENARIO, "--interpreted", "ridgeback,urr3"), "'urr3'")):
            with self.subTest(words):
                done = trb("model", *words)
                self.assertEqual(done.returncode, 1)
                self.assertIn(wanted, done.stderr)


class OwnModel(unittest.TestCase):
    """What our own protocol sends between computers. Its terms are held against counts in services/simulator/job."""

    OWN = ("model", "--protocol", "talkrobots")

    def test_each_term_is_printed_and_they_sum_up(self):
        found = answer_of(*self.OWN, "--robots", 5, "--tasks", 9, "--seconds", 60)
        terms = {term["term"]: term["messages"] for term in found["terms"]}
        self.assertEqual([terms[name] for name in ("hello", "node_profile", "results", "baton", "keep_alive")], [30, 90, 9, 9, 705])
        self.assertAlmostEqual(sum(terms.values()), found["messages"])
        self.assertAlmostEqual(sum(found["phases"].values()), found["messages"])
        done = trb(*self.OWN, "--robots", 5, "--tasks", 9, "--seconds", 60)
        rows = [line.split() for line in done.stdout.splitlines()]
        self.assertIn(["forward", "baton", "B", "+", "F", "+", "Q", "9"], rows)

    def test_a_scenario_gives_the_parameters_and_options_replace_them(self):
        found = answer_of(*self.OWN, "--scenario", SCENARIO, "--robots", 5, "--batons", 10)["parameters"]
        self.assertEqual([found[key] for key in ("n", "N", "M", "B", "D")], [5, 9, 4, 10, 0])

    def test_times_and_who_gets_a_task_that_names_nobody_change_the_parameters(self):
        with tempfile.TemporaryDirectory() as folder:
            scenario, times = pathlib.Path(folder) / "late.json", pathlib.Path(folder) / "times.json"
            scenario.write_text(json.dumps({"name": "late", "tasks": [
                {"id": "a", "robot": "r1", "skill": "run"},
                {"id": "b", "requires": ["mobile"], "skill": "go_to", "after": ["a"]},
                {"id": "c", "robot": "r1", "skill": "run", "after": ["b"]}]}))
            times.write_text(json.dumps({"run": 2, "task:b": {"mean": 15, "deviation": 1}}))
            words = (*self.OWN, "--scenario", scenario)
            found = answer_of(*words, "--bound-to", "b=r2", "--times", times)["parameters"]
            self.assertEqual([found[key] for key in ("n", "S", "Q", "T")], [2, 3, 1, 29])
            self.assertEqual(answer_of(*words, "--bound-to", "b=r1")["parameters"]["n"], 1)
            times.write_text('{"run": -2}')
            for more, wanted in ((("--bound-to", "a=r2"), "--bound-to: 'a=r2'"), (("--bound-to", "b"), "--bound-to: 'b'"),
                                 (("--times", times), "times.run"), (("--times", "/nowhere.json"), "/nowhere.json")):
                self.assertIn(wanted, trb(*words, *more).stderr)

    def test_what_cannot_be_is_refused_by_name(self):
        for words, wanted in ((("--robots", 0), "--robots"), (("--members", 9), "M (--members)"), (("--blocks", 2), "--blocks"),
                              (("--task-seconds", "-1"), "--task-seconds"), (("--tasks", 1001), "--tasks"),
                              (("--task-seconds", 0), "--task-seconds"), (("--tasks", 0), "N (--tasks)"),
                              (("--members", 0), "M (--members)"), (("--robots", 3, "--crossed", 99), "D (--crossed)"),
                              (("--scenario", SCENARIO, "--robots", 2), "n (--robots)"),
                              (("--scenario", "/nowhere.json"), "/nowhere.json")):
            with self.subTest(words):
                done = trb(*self.OWN, *words)
                self.assertEqual(done.returncode, 1)
                self.assertIn(wanted, done.stderr)
        for words, wanted in ((("--protocol", "own"), "--protocol: 'own'"), (("--batons", 3), "--batons")):
            self.assertIn(wanted, trb("model", *words).stderr)


class Simulate(unittest.TestCase):
    def test_bytes_a_second_are_those_of_a_run_of_less_than_a_second_too(self):
        words = ("simulate", "--robots", 1, "--tasks", 1, "--task-seconds", 0.1)
        self.assertIn(f"0.100 s, {answer_of(*words)['bytes'] * 10} bytes/s", trb(*words).stdout)

    def test_a_seed_of_63_bits_is_taken_and_a_larger_one_refused_with_the_range(self):
        words = ("simulate", "--protocol", "talkrobots", "--robots", 1, "--tasks", 1, "--seed")
        self.assertEqual(answer_of(*words, 2**63 - 1)["world"]["state"], "FINISHED")
        self.assertIn(f"from 0 to {2**63 - 1}", trb(*words, 2**63).stderr)
        self.assertIn(f"from 0 to {2**63 - 1}", trb(*words, 10**25).stderr)

    def test_what_is_counted_is_what_the_equations_say(self):
        for robots, tasks, interpreted in ((1, 1, 0), (1, 7, 1), (5, 9, 2), (50, 100, 0), (200, 60, 100)):
            with self.subTest(robots=robots, tasks=tasks):
                counted = answer_of("simulate", "--robots", robots, "--tasks", tasks, "--interpreted", interpreted)
                told = sum(1 for task in range(tasks) if task % robots < interpreted)
                block = ("--blocks", 1, "--block-tasks", tasks) if robots == 1 and tasks > 1 else ()
                said = answer_of("model", "--robots", robots, "--direct", tasks - told, "--interpreted", told, *block)
                self.assertEqual(counted["messages"], said["terms"]["total"])
                for phase, count in counted["phases"].items():
                    self.assertEqual(count["messages"], said["terms"].get(phase, 0), phase)

    def test_the_worst_case_is_counted_too(self):
        self.assertEqual(answer_of("simulate", "--tasks", 9, "--interpreted", 5, *WORST)["messages"], 299)

    def test_the_distribution_over_time_sums_up(self):
        done = trb("simulate", "--robots", 10, "--tasks", 100, "--csv")
        rows = list(csv.DictReader(io.StringIO(done.stdout)))
        self.assertEqual(len(rows), 301)
        self.assertEqual(sum(int(row["messages"]) for row in rows), answer_of("simulate", "--robots", 10, "--tasks", 100)["messages"])

    def test_a_trace_has_every_message_in_order(self):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "trace.jsonl"
            counted = answer_of("simulate", "--robots", 5, "--tasks", 9, "--sensors", 1, "--seconds", 60, "--trace", path)
            lines = [json.loads(line) for line in path.read_text().splitlines()]
            self.assertEqual(len(lines), counted["messages"])
            self.assertEqual(sum(line["bytes"] for line in lines), counted["bytes"])
            self.assertEqual([line["at_s"] for line in lines], sorted(line["at_s"] for line in lines))
            self.assertEqual(os.listdir(folder), ["trace.jsonl"])

    @unittest.skipIf(support.is_sanitized(), "a sanitizer reserves more addresses than any bound")
    def test_without_memory_it_says_what_makes_a_simulation_smaller(self):
        job = json.dumps({"protocol": "talkrobots", "robots": 200, "tasks": 1000})
        bound = 32 << 20
        done = subprocess.run([support.PROGRAMS / "trb-simulator", job], capture_output=True, text=True, timeout=60,
                              preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (bound, bound)))
        self.assertEqual(done.returncode, 1, done.stderr)
        error = json.loads(done.stdout)["error"]
        self.assertEqual(error["code"], "too_large")
        self.assertIn("memory", error["what"])
        self.assertIn("fewer robots", error["cure"])

    def test_an_answer_that_does_not_fit_is_no_good_end(self):
        job = json.dumps({"robots": 100, "tasks": 1000})
        with open("/dev/full", "w", encoding="utf-8") as full:
            done = subprocess.run([support.PROGRAMS / "trb-simulator", job], stdout=full, timeout=60)
        self.assertNotEqual(done.returncode, 0)

    def test_a_trace_that_cannot_be_written_is_refused_before_anything_is_played(self):
        job = {"protocol": "talkrobots", "robots": 200, "tasks": 1000, "trace": "/nowhere/x"}
        done = subprocess.run([support.PROGRAMS / "trb-simulator", "--progress", json.dumps(job)], capture_output=True, text=True,
                              timeout=10)
        self.assertEqual(done.returncode, 1)
        self.assertEqual(done.stderr, "")
        self.assertIn("/nowhere/x", json.loads(done.stdout)["error"]["what"])

    def test_the_real_cores_do_the_tasks_and_one_seed_is_one_run(self):
        words = ("simulate", "--protocol", "talkrobots", "--robots", 3, "--tasks", 4, "--link", "wifi", "--seed", 3)
        with tempfile.TemporaryDirectory() as folder:
            faults = pathlib.Path(folder) / "faults.json"
            faults.write_text('[{"at": 1, "kind": "kill", "node": "r1"}, {"at": 5, "kind": "start", "node": "r1"}]')
            answer = answer_of(*words, "--faults", faults)
            self.assertEqual(answer["world"]["state"], "FINISHED")
            self.assertEqual(answer["world"]["tasks_done"], 4)
            self.assertEqual(answer["world"]["broken"], [])
            self.assertEqual(answer, answer_of(*words, "--faults", faults))
            self.assertLess(answer["between_computers"]["bytes"], answer["bytes"])
        done = trb(*words)
        self.assertIn("The run is FINISHED: 4 tasks", done.stdout)

    def test_a_trace_is_whole_or_not_there(self):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "trace.jsonl"
            refused = trb("simulate", "--robots", 5000, "--trace", path)
            self.assertEqual(refused.returncode, 1)
            self.assertIn("at most 1000000", refused.stderr)
            running = subprocess.Popen([support.PROGRAMS / "trb", "simulate", "--robots", "1000", "--tasks", "100000", "--trace", path],
                                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            running.send_signal(signal.SIGINT)
            running.wait(30)
            self.assertFalse(path.exists())

    def test_a_kept_trace_is_a_sequence_chart_and_is_played_again_to_any_event(self):
        with tempfile.TemporaryDirectory() as folder:
            path, faults = pathlib.Path(folder) / "trace.jsonl", pathlib.Path(folder) / "faults.json"
            faults.write_text('[{"at": 4, "kind": "fail", "node": "r1"}]')
            answer_of("simulate", "--protocol", "talkrobots", "--robots", 3, "--tasks", 4, "--faults", faults, "--trace", path)
            chart = trb("simulate", "--replay", path)
            self.assertEqual(chart.returncode, 0, chart.stderr)
            self.assertRegex(chart.stdout.splitlines()[0], r"TIME +EVENT +cloud +r0 +r1 +r2")
            self.assertRegex(chart.stdout, r"\|-+ baton -+>\|")
            self.assertNotIn("keep_alive", chart.stdout)
            self.assertIn("keep_alive", trb("simulate", "--replay", path, "--all").stdout)
            kept = json.loads(trb("simulate", "--replay", path, "--json").stdout)["messages"]
            broken = next(one["event"] for one in kept if one["subtype"] == "robot_fault")
            state = answer_of("simulate", "--replay", path, "--until", broken)
            self.assertEqual(state["event"], broken)
            robots = {node["id"]: node.get("robot") for node in state["nodes"]}
            self.assertEqual(robots["r1"], "broken")
            self.assertRegex(trb("simulate", "--replay", path, "--until", broken).stdout, r"r1 +3 +OPEN +\d+ +broken")
            lines = path.read_text().splitlines()
            self.assertNotIn("cut off", chart.stdout)
            self.assertEqual(json.loads(lines[-1]), {"complete": True, "messages": len(lines) - 2})
            # Without its last line, as those of versions before it, and cut off.
            for part in (lines[:-1], lines[:200]):
                path.write_text("\n".join(part) + "\n")
                told = trb("simulate", "--replay", path)
                self.assertEqual(told.returncode, 0, told.stderr)
                self.assertIn("may be cut off", told.stdout)
                self.assertFalse(answer_of("simulate", "--replay", path)["complete"])
            # Another job's messages are not the trace's.
            path.write_text("\n".join([lines[0].replace('"tasks":4', '"tasks":5'), *lines[1:]]) + "\n")
            other = trb("simulate", "--replay", path, "--until", broken)
            self.assertEqual(other.returncode, 1)
            self.assertIn("other messages", other.stderr)
            for words, wanted in (((path, "--until", 10**7), "--until"), ((path, "--until", 0), "--until"),
                                  ((path, "--seed", 4), "--seed"), ((faults,), "faults.json: line 1"),
                                  (("/nowhere.jsonl",), "/nowhere.jsonl")):
                with self.subTest(words):
                    refused = trb("simulate", "--replay", *words)
                    self.assertEqual(refused.returncode, 1)
                    self.assertIn(wanted, refused.stderr)
            self.assertIn("--replay", trb("simulate", "--until", 5).stderr)

    def test_a_run_that_is_not_finished_is_no_good_end_and_says_what_it_waits_for(self):
        words = ("simulate", "--protocol", "talkrobots")
        with tempfile.TemporaryDirectory() as folder:
            faults = pathlib.Path(folder) / "faults.json"
            faults.write_text('[{"at": 2, "kind": "fail", "node": "r0"}]')
            waits = trb(*words, "--robots", 1, "--tasks", 2, "--faults", faults)
            self.assertEqual(waits.returncode, 1, waits.stdout)
            self.assertRegex(waits.stdout, r"An alert waits for a person, .*: r0 \(robot_fault.*\), task t0")
            self.assertNotIn("--seconds plays more", waits.stdout)
            self.assertEqual(trb(*words, "--robots", 1, "--tasks", 2, "--faults", faults, "--json").returncode, 1)
            faults.write_text('[{"at": 1, "kind": "kill", "node": "cloud"}]')
            still = trb(*words, "--robots", 3, "--tasks", 4, "--faults", faults)
            self.assertEqual(still.returncode, 1, still.stdout)
            self.assertRegex(still.stdout, r"It stands still: nothing has moved for [\d.]+ s, .*not over at cloud, r0, r1, r2; off: cloud")
            self.assertNotIn("BROKEN", still.stdout)
            self.assertNotIn("--seconds plays more", still.stdout)
        under_way = trb(*words, "--robots", 3, "--tasks", 4, "--seconds", 10)
        self.assertEqual(under_way.returncode, 1, under_way.stdout)
        self.assertIn("cut off before its end: --seconds plays more of it", under_way.stdout)
        self.assertNotIn("it is FINISHED", under_way.stdout)

    def test_how_long_is_played_counts_from_the_submission_and_0_is_as_without_it(self):
        words = ("simulate", "--protocol", "talkrobots", "--robots", 3, "--tasks", 4, "--seconds")
        done = trb(*words, 12.1)  # the tasks take 12.05 s
        self.assertEqual(done.returncode, 0, done.stdout)
        self.assertIn("The run is FINISHED: 4 tasks in 12.0", done.stdout)
        self.assertIn("The cloud has its end, it is FINISHED; nodes keep a run for a minute more", done.stdout)
        self.assertNotIn("cut off before its end", done.stdout)
        before = trb(*words, 12)
        self.assertEqual(before.returncode, 1, before.stdout)
        self.assertIn("OPEN: 3 tasks", before.stdout)
        self.assertIn("FINISHED", trb(*words, 75).stdout)
        self.assertIn("FINISHED", trb(*words, 0).stdout)

    def test_links_that_were_not_up_are_told(self):
        words = ("simulate", "--protocol", "talkrobots", "--robots", 3, "--tasks", 4)
        with tempfile.TemporaryDirectory() as folder:
            faults = pathlib.Path(folder) / "faults.json"
            faults.write_text('[{"kind": "cut", "node": "r0"}]')
            told = trb(*words, "--seconds", 30, "--faults", faults).stdout
            self.assertIn("Not all links were up: after 60", told)
            self.assertNotIn("all links were up after", told)
        whole = trb(*words)
        self.assertIn("all links were up after", whole.stdout)
        self.assertNotIn("Not all links", whole.stdout)

    def test_what_went_wrong_is_told_and_which_faults_were_not_reached(self):
        words = ("simulate", "--protocol", "talkrobots", "--robots", 3, "--tasks", 4)
        with tempfile.TemporaryDirectory() as folder:
            faults = pathlib.Path(folder) / "faults.json"
            faults.write_text(json.dumps([
                {"at": 100000, "kind": "fail", "node": "r0"}, {"kind": "disk", "node": "cloud", "commit_s": 0.01},
                {"at": 2, "kind": "cut", "node": "r1", "other": "cloud", "way": "back"}, {"at": 3, "kind": "heal", "node": "r1"}]))
            done = trb(*words, "--faults", faults)
            self.assertEqual(done.returncode, 0, done.stdout)
            self.assertRegex(done.stdout, r"Not reached: faults\[0\] at 100000 s\nWhat was played ends [\d.]+ s after")
            self.assertRegex(done.stdout, r"from the start +disk +cloud\n2 s +cut +r1 - cloud, what r1 is sent\n3 s +heal +r1\n")
            self.assertEqual(answer_of(*words, "--faults", faults)["world"]["not_reached"], [{"fault": 0, "at": 100000}])

    def test_what_a_sensor_was_to_tell_after_the_end_is_told(self):
        words = ("simulate", "--protocol", "talkrobots", "--robots", 3, "--tasks", 4)
        with tempfile.TemporaryDirectory() as folder:
            values = pathlib.Path(folder) / "values.json"
            steps = [{"at": at, "value": at} for at in (0, 5, 50000, 60000)]
            values.write_text(json.dumps([{"node": "r0", "name": "load", "steps": steps}, {"node": "cloud", "name": "light", "value": 1}]))
            done = trb(*words, "--sensor-values", values)
            self.assertEqual(done.returncode, 0, done.stdout)
            self.assertRegex(done.stdout, r"Not reached: sensor_values\[0\], what it tells from 50000 s on, and 1 later\nWhat was played ends [\d.]+ s after")
            found = answer_of(*words, "--sensor-values", values)["world"]["steps_not_reached"]
            self.assertEqual(found, [{"sensor": 0, "at": 50000, "steps": 2}])

    def test_what_is_sent_over_time_ends_with_the_run(self):
        words = ("simulate", "--protocol", "talkrobots", "--robots", 3, "--tasks", 4)
        found = answer_of(*words)
        self.assertEqual(len(found["over_time"]["messages"]), int(found["seconds"]) + 1)
        self.assertEqual(sum(found["over_time"]["messages"]), found["messages"])
        self.assertEqual(len(trb(*words, "--csv").stdout.splitlines()), int(found["seconds"]) + 2)

    def test_tasks_that_are_divided_into_runs_at_once_are_done_in_the_time_of_one_robot_s_own(self):
        words = ("simulate", "--protocol", "talkrobots", "--robots", 4, "--tasks", 12, "--runs", 2, "--at-once")
        found = answer_of(*words)
        runs = (found["world"], *found["beside"])
        self.assertEqual([(run["state"], run["tasks_done"], run["broken"]) for run in runs], [("FINISHED", 6, [])] * 2)
        self.assertLess(max(run["makespan_s"] for run in runs), 10)
        self.assertEqual(len(found["beside"][0]["tasks"]), 6)
        self.assertNotIn("model", found)
        told = trb(*words).stdout
        self.assertRegex(told, r"1 +at once, run 1 +0\.0 s +FINISHED +6 +9\.\d s\n2 +at once, run 2 +0\.0 s +FINISHED +6")
        self.assertNotIn("beside", answer_of("simulate", "--protocol", "talkrobots", "--robots", 2, "--tasks", 2))
        for more, wanted in ((("--runs", 0), "runs"), (("--runs", 2, "--tasks", 2001), "tasks")):
            with self.subTest(wanted):
                refused = trb(*words[:5], *more)
                self.assertEqual(refused.returncode, 1)
                self.assertIn(wanted, refused.stderr)
        self.assertIn("--runs", trb("simulate", "--runs", 2).stderr)

    def test_what_cannot_be_is_refused_by_name(self):
        for words, wanted in ((("--robots", 0), "robots"), (("--tasks", "many"), "--tasks: 'many'"), (("--faulty", 5), "faulty"),
                              (("--local-requests", 1), "sensors"), (("--trace", "/nowhere/x"), "/nowhere/x"), (("--link", "lan"), "--link"),
                              (("--protocol", "mqtt"), "protocol"), (("--protocol", "talkrobots", "--link", "rope"), "link"),
                              (("--protocol", "talkrobots", "--sensors", 1), "sensors"),
                              (("--protocol", "talkrobots", "--faults", "/nowhere/y"), "/nowhere/y")):
            with self.subTest(words):
                done = trb("simulate", *words)
                self.assertEqual(done.returncode, 1)
                self.assertIn(wanted, done.stderr)
                told = trb("simulate", *words, "--json")
                self.assertIn(wanted, json.loads(told.stdout)["error"]["what"])


if __name__ == "__main__":
    support.main()
