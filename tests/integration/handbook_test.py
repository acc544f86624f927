"""deploy/handbook: its commands run as they stand there, in the order of its pages, in one folder and one shell, against real
processes and virtual robots; its links lead somewhere; its tables of codes have all codes of the source, and no other.

Addresses 127.0.200.x in place of the handbook's 127.0.42.x.
"""
import os
import re
import shutil
import subprocess
import time
import unittest

import shell_blocks
import support
import trb_fleet

BOOK = support.REPO / "deploy" / "handbook"
BLOCK = 200
MOST_NOT_RUN = 12
LINK = re.compile(r"\[[^\]]*\]\(([^)#\s]+)(?:#([^)\s]+))?\)|\]\(#([^)\s]+)\)")


def pages():
    """In the order of the first page's contents; a page that stands nowhere in it is an error."""
    first = BOOK / "README.md"
    contents = first.read_text().split("\n## Contents\n", 1)[1]
    named = [BOOK / path for path, *_ in LINK.findall(contents) if path.endswith(".md") and not path.startswith("../")]
    order = [first, *dict.fromkeys(named)]
    missing = set(BOOK.rglob("*.md")) - set(order)
    assert not missing, f"not in the contents of {first}: {sorted(map(str, missing))}"
    return order


def has_ros():
    return (support.PROGRAMS / "trb-virtual-ros-robot").exists() and shutil.which("rosmaster") is not None


def without_code(text):
    return shell_blocks.FENCE.sub("", text)


def anchors(path):
    """As GitHub makes them of headings."""
    heads = re.findall(r"^#+ (.*)$", without_code(path.read_text()), re.M)
    return {re.sub(r"[^\w\- ]", "", head.lower()).replace(" ", "-") for head in heads}


class Commands(unittest.TestCase):
    def setUp(self):
        support.hold_blocks(BLOCK, BLOCK + 1)
        self.root = support.temporary_folder(self)
        self.page_port = trb_fleet.free_port()
        env = dict(os.environ, PATH=f"{support.PROGRAMS}:/usr/bin:/bin:/usr/sbin:/sbin", HOME=str(self.root), TRB=str(support.REPO))
        self.env = {name: value for name, value in env.items() if name not in ("TRB_NODE", "TRB_PASSPHRASE")}
        self.addCleanup(self.end_nodes)

    def end_nodes(self):
        # A fleet of trb demo before its nodes, which it would start again.
        for lock in sorted(self.root.rglob("up.lock"), key=lambda path: len(path.parts)):
            subprocess.run([support.PROGRAMS / "trb", "down", lock.parent.parent], capture_output=True)

    def here(self, text):
        """Addresses and the page's port of this test in place of those that a reader has to himself; robots in a hurry."""
        text = text.replace("127.0.42", f"127.0.{BLOCK}").replace("8443", str(self.page_port))
        return text.replace("trb demo hall --page", f"trb demo hall --network 127.0.{BLOCK} --speed 4 --page")

    def test_every_command_does_what_the_handbook_says(self):
        blocks = [block for page in pages() for block in shell_blocks.blocks_of(page, self.here(page.read_text()))]
        if not has_ros():
            for block in blocks:
                block.not_run = block.not_run or ("there is no ROS here" if block.page == "ros.md" else "")
        left_out = [block for block in blocks if block.not_run]
        for block in left_out:
            print(f"not run: {block.place()}: {block.not_run}")
        blocks = [block for block in blocks if not block.not_run]
        begun = time.monotonic()
        status, said, begins = shell_blocks.run(blocks, self.root, self.env, timeout=430)
        print(f"{len(blocks)} blocks ran in {time.monotonic() - begun:.1f} s; {len(left_out)} did not")
        took = [(end - start, block.place()) for start, end, block in zip(begins, [*begins[1:], time.time()], blocks)]
        print("the slowest:", ", ".join(f"{place} {seconds:.1f} s" for seconds, place in sorted(took, reverse=True)[:5]))
        self.assertEqual(status, 0, self.end_of(blocks, said))
        self.assertLessEqual(len(left_out), MOST_NOT_RUN)
        for block, output in zip(blocks, said, strict=True):
            with self.subTest(block.place()):
                missing = shell_blocks.not_shown(block.shows, output)
                self.assertEqual(missing, "", f"{block.place()}: it says\n" + "\n".join(output[-40:]))

    def end_of(self, blocks, said):
        block = blocks[max(len(said) - 1, 0)]
        return f"{block.place()}:\n{block.text}\n" + "\n".join(said[-1][-40:] if said else [])


class Named(unittest.TestCase):
    """What a text or a hint tells a person to type exists, with the options that it has there."""

    @classmethod
    def setUpClass(cls):
        listed = re.findall(r"^  trb ((?:[a-z]+ )+)", cls.said("help"), re.M)
        cls.commands = {tuple(words.split()): None for words in listed}  # their options, once they are known
        cls.groups = {words[0] for words in cls.commands if len(words) == 2}
        cls.topics = set(cls.said("help").rpartition("Topics: ")[2].split())

    @staticmethod
    def said(*words):
        done = subprocess.run([support.PROGRAMS / "trb", *words], capture_output=True, text=True, timeout=60)
        return done.stdout + done.stderr

    def options(self, command):
        if self.commands[command] is None:
            self.commands[command] = set(re.findall(r"--[a-z-]+", self.said(*command, "--help"))) | {"--help"}
        return self.commands[command]

    def fault(self, text):
        """What is wrong with `trb TEXT`, or nothing."""
        words = text.split()
        if not words or not re.fullmatch("[a-z]+", words[0]):
            return ""
        if words[0] == "help":
            known = len(words) == 1 or words[1] in self.topics | {"TOPIC"} or any(one[0] == words[1] for one in self.commands)
            return "" if known else "no such topic"
        command = tuple(words[:2 if words[0] in self.groups else 1])
        if command not in self.commands:
            return "no such command"
        unknown = set(re.findall(r"(?<!\S)--[a-z-]+", " ".join(words).replace("[", ""))) - self.options(command)
        return f"no option {' '.join(sorted(unknown))}" if unknown else ""

    def test_each_command_in_a_document(self):
        top = ("README.md", "ARCHITECTURE.md", "CONTRIBUTING.md", "SECURITY.md")
        pages = [support.REPO / name for name in top]
        for folder in ("deploy", "services", "common", "config", "tests"):
            pages += (page for page in (support.REPO / folder).rglob("*.md") if "node_modules" not in page.parts)
        named = [(page, text) for page in pages for text in re.findall(r"`trb ([^`]+)`", without_code(page.read_text()))]
        self.assertGreater(len(named), 300)
        faults = [f"{page.relative_to(support.REPO)}: trb {text}: {fault}" for page, text in named if (fault := self.fault(text))]
        self.assertEqual(faults, [])

    def test_each_command_in_a_hint(self):
        files = [path for folder in ("services", "common") for path in (support.REPO / folder).rglob("*.[ch]pp")
                 if not path.name.endswith("_test.cpp")]
        literals = [(path, text) for path in files for text in re.findall(r'"((?:[^"\\\n]|\\.)*)"', path.read_text())]
        # A text of several pieces may end behind "trb robot".
        named = [(path, text) for path, literal in literals for text in re.findall(r"\btrb ([a-z]+ [a-z]+)", literal)
                 if text.split()[0] in self.groups | {"help"}]
        self.assertGreater(len(named), 150)
        faults = {f"{path.relative_to(support.REPO)}: trb {text}" for path, text in named if self.fault(text)}
        self.assertEqual(faults, set())


class Text(unittest.TestCase):
    def test_links_lead_somewhere(self):
        for page in pages():
            for path, anchor, own in LINK.findall(without_code(page.read_text())):
                if path.startswith(("http:", "https:")):
                    continue
                with self.subTest(page=page.name, link=path or own):
                    target = (page.parent / path).resolve() if path else page
                    self.assertTrue(target.exists())
                    if anchor or own:
                        self.assertIn(anchor or own, anchors(target))


def headings(page, level=2):
    """Those that are a code, as `robot_fault`."""
    return set(re.findall(rf"^{'#' * level} ([a-z][a-z0-9_]*)$", (BOOK / page).read_text(), re.M))


def sources(folder):
    return [path for path in (support.REPO / folder).rglob("*.[ch]pp") if "_test" not in path.name and "test" not in path.parent.name]


class Requirements(unittest.TestCase):
    """security-requirements.md names files and tests; each is there, and what is met has a test, a reason or a document."""

    def rows(self):
        text = (BOOK / "security-requirements.md").read_text()
        return [[cell.strip() for cell in line.strip("|").split("|")] for line in re.findall(r"^\| (?:\(|CR |CCSC |NDR |EDR |SAR ).*$", text, re.M)]

    def test_every_file_that_it_names_is_there(self):
        named = set(re.findall(r"`([\w./-]+/[\w./-]+|[A-Z]+\.md)`", (BOOK / "security-requirements.md").read_text()))
        self.assertGreater(len(named), 60)
        missing = [name for name in sorted(named) if not name.startswith("/") and not (support.REPO / name).exists()]
        self.assertEqual(missing, [])

    def test_every_requirement_stands_there_once(self):
        numbers = [row[0] for row in self.rows()]
        wanted = [f"(2)({letter})" for letter in "abcdefghijklm"] + ["(1)"] * 2 + [f"({i})" for i in range(2, 9)]
        wanted += [f"CCSC {i}" for i in range(1, 5)]
        for family, last in enumerate((14, 13, 14, 3, 4, 2, 8), 1):
            wanted += [f"{family}.{i}" for i in range(1, last + 1)]
        self.assertEqual(sorted(re.sub(r"^(CR|NDR|EDR|SAR) ", "", number) for number in numbers), sorted(wanted))

    def test_what_is_met_is_shown(self):
        for number, _, met, where, shown, mine in self.rows():
            with self.subTest(number):
                self.assertIn(met, ("yes", "part", "no", "yours"))
                self.assertTrue(shown)
                if met == "yes":
                    self.assertTrue("`" in shown or "`" in where, "met, and neither a test nor a document shows it")
                if met == "yours":
                    self.assertTrue(mine or where, "whose it is, and what to do")


class Codes(unittest.TestCase):
    """Who is called finds every code that the programs can show, and no code that they cannot."""

    def test_every_cause_of_an_alert(self):
        registry = support.REPO / "services/resilience/core/alert_causes.hpp"
        causes = set(re.findall(r'string_view k\w+ = "(\w+)";', registry.read_text()))
        self.assertEqual(headings("on-call/alerts.md"), causes)
        # None is written beside the registry.
        for path in sources("services/resilience/core"):
            if path != registry:
                self.assertEqual(re.findall(r'(?:cause|Cause)\s*[!=]?=\s*"\w+"', path.read_text()), [], path)

    def test_every_cause_of_the_doctor(self):
        text = "".join(path.read_text() for path in sources("common/operator/doctor"))
        told = re.findall(r'(?:problem|note)\(\s*(?:[^"();]*(?:"\w+")?\s*\?\s*)?"(\w+)"(?:\s*:\s*"(\w+)")?,', text)
        found = re.findall(r'Weight::\w+(?:\s*:\s*Weight::\w+)?,\s*(?:\w+ \? )?"(\w+)"(?: : "(\w+)")?', text)
        recorded = re.findall(r'^    \{"\w+", "(\w+)", ', text, re.M)
        causes = {cause for pair in told + found for cause in pair if cause} | set(recorded)
        self.assertEqual(headings("on-call/doctor.md"), causes)
        # What its tests expect is among them, so that a new way of writing one is seen here.
        tests = "".join(path.read_text() for path in (support.REPO / "common/operator/doctor").glob("*_test.cpp"))
        expected = re.findall(r'(?:check_only|find)\([\w.]+, "(\w+)"|cause == "(\w+)"', tests)
        expected = {cause for pair in expected for cause in pair if cause}
        self.assertGreater(len(expected), 10)
        self.assertLessEqual(expected, causes)

    def test_every_code_of_an_error(self):
        enum = (support.REPO / "common/base/errc.hpp").read_text().split("enum class Errc", 1)[1].split("};", 1)[0]
        codes = set(re.findall(r"^  (\w+)(?: = \d+)?,", enum, re.M)) - {"ok"}
        self.assertEqual(headings("on-call/refusals.md", level=3), codes)


    def test_every_alert_of_the_rules_for_prometheus(self):
        rules = (support.REPO / "deploy/monitoring/talkrobots-rules.yml").read_text()
        told = re.findall(r"^## (TalkRobots\w+)$", (BOOK / "on-call/prometheus.md").read_text(), re.M)
        self.assertEqual(sorted(told), sorted(re.findall(r"^\s*- alert: (\w+)$", rules, re.M)))


class Blocks(unittest.TestCase):
    """The helper itself: it must be able to fail."""

    def test_a_block_that_does_not_run_needs_a_reason(self):
        page = BOOK / "page.md"
        self.assertEqual(shell_blocks.blocks_of(page, "```sh not run: needs a robot\ntrue\n```\n")[0].not_run, "needs a robot")
        for first_line in ("sh not run:", "sh slow", "sh skip"):
            with self.assertRaises(ValueError):
                shell_blocks.blocks_of(page, f"```{first_line}\ntrue\n```\n")

    def test_a_failed_command_ends_the_shell_and_is_named(self):
        root = support.temporary_folder(self)
        blocks = shell_blocks.blocks_of(BOOK / "page.md", "```sh\necho one; X=2\n```\n```sh\necho $X\nfalse\n```\n```sh\necho 3\n```\n")
        status, said, _ = shell_blocks.run(blocks, root, os.environ, 20)
        self.assertNotEqual(status, 0)
        self.assertEqual(said, [["one"], ["2"]])

    def test_lines_are_looked_for_in_their_order(self):
        output = ["run 5 'first'", "  1/2  go  FINISHED 2 s", "end"]
        self.assertEqual(shell_blocks.not_shown(["run … 'first'", "1/2 go FINISHED …"], output), "")
        self.assertEqual(shell_blocks.not_shown(["end", "run … 'first'"], output), "run … 'first'")
        self.assertEqual(shell_blocks.not_shown(["run (.)"], output), "run (.)")


if __name__ == "__main__":
    support.main()
