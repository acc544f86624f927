"""What shells and man make of what `trb` prints for them: bash, zsh, fish and groff themselves are asked."""
import pathlib
import shutil
import subprocess
import tempfile
import unittest

import support
import skips  # by the path of support

TRB = support.PROGRAMS / "trb"
# What each shell completes: the command line so far, and what must (not) be offered.
LINES = [
    ("trb ro", ["route", "robot"], ["run"]),
    ("trb run ", ["list", "show", "proof", "verify"], ["route"]),
    ("trb route list --", ["--node", "--json", "--help"], ["--take"]),
    ("trb send ur3 command move --t", ["--timeout", "--take"], ["--node"]),
    ("trb route list --node a_", ["a_folder"], ["a_file"]),
    ("trb scenario check a_", ["a_file"], []),
    ("trb route list --timeout ", [], ["--json", "a_file"]),
]
BASH = """
source trb.bash
COMP_WORDS=({line}); [[ "{line}" == *" " ]] && COMP_WORDS+=("")
COMP_CWORD=$((${{#COMP_WORDS[@]}} - 1))
_trb
printf '%s\\n' "${{COMPREPLY[@]}}"
"""
# zsh's own helpers offer to its line editor, which a script has none of: these print what they were to offer.
ZSH = """
_describe() {{ [[ $1 == -o ]] && shift; local -a all; all=(${{${{(P)2}}%%:*}}); print -l -- ${{(M)all:#${{words[CURRENT]}}*}} }}
_files() {{ if [[ $1 == -/ ]]; then print -l -- ${{words[CURRENT]}}*(N/); else print -l -- ${{words[CURRENT]}}*(N); fi }}
source trb.zsh
words=({line}); [[ "{line}" == *" " ]] && words+=("")
CURRENT=$#words
_trb
"""
FISH = "source trb.fish; complete -C '{line}'"


class Shells(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        missing = [name for name in ("bash", "zsh", "fish", "man") if shutil.which(name) is None]
        if missing:
            skips.leave(f"not installed: {', '.join(missing)}")
        folder = tempfile.TemporaryDirectory(prefix="trb-shells-")
        cls.addClassCleanup(folder.cleanup)
        cls.folder = pathlib.Path(folder.name)
        (cls.folder / "a_folder").mkdir()
        (cls.folder / "a_file").touch()
        for shell in ("bash", "zsh", "fish"):
            (cls.folder / f"trb.{shell}").write_text(cls.trb("completion", shell))

    @staticmethod
    def trb(*words):
        return subprocess.run([TRB, *words], check=True, capture_output=True, text=True, timeout=20).stdout

    def offered(self, *command):
        done = subprocess.run(command, cwd=self.folder, capture_output=True, text=True, timeout=20,
                              env={"PATH": "/usr/bin:/bin", "HOME": str(self.folder), "LC_ALL": "C.UTF-8"})
        self.assertEqual(done.stderr, "")
        # A folder is offered with a slash, a meaning behind a tabulator.
        return [line.split("\t")[0].rstrip("/") for line in done.stdout.splitlines()]

    def assert_all_lines(self, *command, script):
        for line, wanted, unwanted in LINES:
            with self.subTest(line):
                offered = self.offered(*command, script.format(line=line))
                self.assertLessEqual(set(wanted), set(offered))
                self.assertEqual(set(unwanted) & set(offered), set())

    def test_bash(self):
        self.assert_all_lines("bash", "--norc", "-c", script=BASH)

    def test_zsh(self):
        self.assert_all_lines("zsh", "-f", "-c", script=ZSH)

    def test_fish(self):
        self.assert_all_lines("fish", "--no-config", "-c", script=FISH)

    def test_every_command_is_known_to_each_shell(self):
        overview = [line.split()[1] for line in self.trb("help").splitlines() if line.startswith("  trb ")]
        self.assertGreater(len(overview), 30)
        for shell in ("bash", "zsh", "fish"):
            text = (self.folder / f"trb.{shell}").read_text()
            self.assertEqual([name for name in overview if name not in text], [])

    def test_the_manual_has_every_command_and_no_fault_of_groff(self):
        page = self.folder / "trb.1"
        page.write_text(self.trb("manual"))
        done = subprocess.run(["man", "--warnings", "-l", page], capture_output=True, text=True, timeout=30,
                              env={"PATH": "/usr/bin:/bin", "MANWIDTH": "200", "LC_ALL": "C.UTF-8", "MANPAGER": "cat"})
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        for line in self.trb("help").splitlines():
            if line.startswith("  trb "):
                self.assertIn("   " + line[2:42].split("  ")[0].rstrip(), done.stdout)

    def test_the_nearest_command_is_named(self):
        for words, near in ((["rout", "list"], "trb route list"), (["robot", "lst"], "trb robot list"),
                            (["send", "a", "b", "c", "--tak"], "--take"), (["help", "stp"], "trb help stop"),
                            (["completion", "bsh"], "trb completion bash")):
            done = subprocess.run([TRB, *words], capture_output=True, text=True, timeout=20)
            self.assertEqual(done.returncode, 2)
            self.assertIn(f"did you mean{':' if near.startswith('trb') else ''} {near}?", done.stderr)


if __name__ == "__main__":
    support.main()
