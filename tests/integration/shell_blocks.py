"""Blocks of shell in Markdown, run as somebody would copy them: a reader's commands are tested commands.

    ```sh                  runs
    ```sh not run: REASON  does not run in a test; the reason is printed
    ```text                behind a block that runs: its lines are in that block's output, in this order; … stands for anything
"""
import dataclasses
import os
import pathlib
import re
import signal
import subprocess

FENCE = re.compile(r"^(```+) *([^\n]*)\n(.*?)^\1 *$", re.S | re.M)
NOT_RUN = "not run: "


@dataclasses.dataclass
class Block:
    page: str
    line: int
    text: str
    not_run: str = ""  # the reason
    shows: list = dataclasses.field(default_factory=list)

    def place(self):
        return f"{self.page}:{self.line}"


def fences(text):
    """Each block of code: its language, the rest of its first line, its text, the number of its first line."""
    for found in FENCE.finditer(text):
        language, _, more = found[2].strip().partition(" ")
        yield language, more.strip(), found[3], text.count("\n", 0, found.start()) + 1


def blocks_of(path, text=None):
    """The blocks of shell of a page, with what they show. An error names a block whose first line is not understood."""
    out = []
    before = ""
    for language, more, body, line in fences(path.read_text() if text is None else text):
        if language == "sh":
            if more and not more.startswith(NOT_RUN):
                raise ValueError(f"{path.name}:{line}: sh {more}: write '{NOT_RUN}REASON', or nothing")
            if more == NOT_RUN.strip():
                raise ValueError(f"{path.name}:{line}: a reason is missing")
            out.append(Block(path.name, line, body, more.removeprefix(NOT_RUN)))
        elif language == "text" and before == "sh" and not out[-1].not_run:
            out[-1].shows = body.splitlines()
        before = language
    return out


def is_shown(line, output):
    """The index behind a line of the output that fits, or -1."""
    parts = [re.escape(part) for part in " ".join(line.split()).split("…")]
    wanted = re.compile("^" + ".*".join(parts) + "$")
    for i, one in enumerate(output):
        if wanted.search(" ".join(one.split())):
            return i + 1
    return -1


def not_shown(lines, output):
    """The first line that the output does not have behind the one before; "": all are there."""
    for line in lines:
        at = is_shown(line, output)
        if at < 0:
            return line
        output = output[at:]
    return ""


MARK = "@@ block "


def run(blocks, folder, env, timeout):
    """All blocks in one shell, as a reader has one terminal. Returns its status, and each block's output, as lines, and begin;
    a command that fails ends it, so that the last output is the failed block's. What was started in the background ends with it."""
    script = "".join(f"echo {MARK}{i} $EPOCHREALTIME\n{block.text}\n" for i, block in enumerate(blocks))
    with open(folder / "said", "w") as said:
        child = subprocess.Popen(["/bin/bash", "-euo", "pipefail", "-c", script], cwd=folder, env=env, stdin=subprocess.DEVNULL,
                                 stdout=said, stderr=subprocess.STDOUT, start_new_session=True)
    try:
        status = child.wait(timeout)
    except subprocess.TimeoutExpired:
        status = f"still running after {timeout} s"
    finally:
        end_group(child)
    said = re.split(rf"^{MARK}\d+ ([\d.]+)\n", (folder / "said").read_text(errors="replace"), flags=re.M)
    return status, [text.splitlines() for text in said[2::2]], [float(begun) for begun in said[1::2]]


def end_group(child):
    try:
        os.killpg(child.pid, signal.SIGTERM)
    except ProcessLookupError:
        pass
    child.wait()
