"""`trb rank`: a file, standard input, refusals, wrong files; the shipped example. Needs no node."""
import json
import os
import pathlib
import subprocess
import tempfile
import unittest

import support

EXAMPLE = support.REPO / "config" / "rank" / "paper-figure-8.json"


def rank(*arguments, given=""):
    """The finished process; it knows of no node."""
    environment = {key: value for key, value in os.environ.items() if not key.startswith("TRB_")}
    return subprocess.run([str(support.PROGRAMS / "trb"), "rank", *map(str, arguments)], input=given, text=True,
                          capture_output=True, timeout=30, env=environment, cwd="/")


class Rank(unittest.TestCase):
    def refused(self, given, code, what, cure):
        """Exit 1, the reason on standard error, and as JSON with --json."""
        text = given if isinstance(given, str) else json.dumps(given)
        done = rank("-", given=text)
        self.assertEqual((done.returncode, done.stdout), (1, ""), done.stderr)
        self.assertIn(what, done.stderr)
        done = rank("-", "--json", given=text)
        self.assertEqual(done.returncode, 1)
        error = json.loads(done.stdout)["error"]
        self.assertEqual(error["code"], code)
        self.assertIn(what, error["what"])
        self.assertIn(cure, error["cure"])

    def test_the_papers_candidates(self):
        done = rank(EXAMPLE, "--json")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        answer = json.loads(done.stdout)
        self.assertEqual(set(answer), {"criteria", "consistency", "ranking", "sensitivity"})
        self.assertEqual([row["id"] for row in answer["ranking"]], ["pioneer2", "pioneer1", "turtlebot"])
        self.assertAlmostEqual(sum(row["score"] for row in answer["ranking"]), 1)
        for row in answer["ranking"]:
            self.assertAlmostEqual(sum(row["contributions"].values()), row["score"])
        self.assertLess(answer["consistency"]["replace ridgeback"]["cr"], 0.1)
        self.assertAlmostEqual(sum(one["global"] for one in answer["criteria"].values()), 1)
        self.assertEqual([one["criterion"] for one in answer["sensitivity"]], ["battery", "distance", "availability"])

    def test_for_people(self):
        done = rank(EXAMPLE)
        self.assertEqual(done.returncode, 0, done.stderr)
        for word in ("CRITERION", "LAMBDA MAX", "ALTERNATIVE", "pioneer1", "availability", "stays first"):
            self.assertIn(word, done.stdout)

    def test_standard_input_says_the_same_as_the_file(self):
        self.assertEqual(rank("-", "--json", given=EXAMPLE.read_text()).stdout, rank(EXAMPLE, "--json").stdout)

    def test_alternatives_by_judgment(self):
        problem = {"goal": "dance", "criteria": [{"name": "charm"}], "alternatives": [{"id": "a"}, {"id": "b"}],
                   "alternative_judgments": {"charm": [["a", "b", 5]]}}
        answer = json.loads(rank("-", "--json", given=json.dumps(problem)).stdout)
        self.assertAlmostEqual(answer["ranking"][0]["score"], 5 / 6)
        self.assertEqual(answer["consistency"]["charm"], {"lambda_max": 2, "ci": 0, "cr": 0})

    def test_judgments_that_contradict_each_other_are_refused_until_accepted(self):
        problem = json.loads(EXAMPLE.read_text())
        problem["judgments"]["replace ridgeback"][1] = ["availability", "distance", 9]
        self.refused(problem, "conflict", "'availability' to 'distance' = 9 hurts most", "2.73 would fit there")
        self.refused(problem, "conflict", "'replace ridgeback'", "max_ratio")
        problem["options"] = {"max_ratio": 10}
        self.assertEqual(rank("-", given=json.dumps(problem)).returncode, 0)

    def test_wrong_input(self):
        self.refused("", "malformed", "-:", "comma")
        self.refused('{"goal": "g" "criteria": []}', "malformed", "line 1", "comma")
        self.refused({"goal": "g", "criteria": [{"name": "x"}]}, "missing", "alternatives is missing", "alternatives")
        self.refused({"goal": "g", "criteria": [{"name": "x"}], "alternatives": []}, "missing", "there are none", "add")
        done = rank("/none/such.json", "--json")
        self.assertEqual((done.returncode, json.loads(done.stdout)["error"]["code"]), (1, "missing"))
        self.assertEqual(rank().returncode, 2)
        self.assertEqual(rank(EXAMPLE, "--jsn").returncode, 2)

    def test_a_thousand_robots(self):
        problem = json.loads(EXAMPLE.read_text())
        problem["alternatives"] = [{"id": f"r{i}", "values": {"battery": i % 97, "distance": 1 + i % 89,
                                                              "availability": 100 - i % 83}} for i in range(1000)]
        with tempfile.TemporaryDirectory(prefix="trb-") as folder:
            path = pathlib.Path(folder) / "thousand.json"
            path.write_text(json.dumps(problem))
            answer = json.loads(rank(path, "--json").stdout)
            self.assertEqual(len(answer["ranking"]), 1000)
            self.assertIn("and 980 more", rank(path).stdout)


if __name__ == "__main__":
    support.main()
