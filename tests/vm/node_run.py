"""The story of scripts/test-vm: a node as Debian's package and systemd's service, killed, cut from its power, and with a disk and a clock
that fail it."""
import argparse
import json
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time

HERE = pathlib.Path(__file__).resolve().parent
for folder in (HERE, HERE.parent / "integration", HERE.parent / "support"):
    sys.path.insert(0, str(folder))

import debian_image  # noqa: E402
import hall  # noqa: E402
import image  # noqa: E402
from hall import NODE  # noqa: E402
from machine import Machine  # noqa: E402
from run import Cleanups, check  # noqa: E402
from steps import Steps  # noqa: E402

MOST_EXPOSED = 3.0
LONG = 900  # s, for what a machine without acceleration does on a busy computer
TURNS = 16  # some seconds each: a run that a slow machine does not finish between two looks at it
POSES = ([2, -1, 1, -1, -1, 0], [-2, -1, 1, -1, -1, 0])


def scenario(turns):
    """What is cut off may simply be done again: otherwise a person would be asked."""
    tasks = [{"id": f"turn{i}", "robot": "arm1", "skill": "move_joints", "data": {"joints": POSES[i % 2]}, "retries": 3} for i in range(turns)]
    for earlier, later in zip(tasks, tasks[1:]):
        later["after"] = [earlier["id"]]
    return json.dumps({"name": "turns", "tasks": tasks})


step = Steps()


class Story:
    def __init__(self, folder, vmlinuz, starter, disks, joined=None):
        self.folder, self.vmlinuz, self.starter, self.disks = folder, vmlinuz, starter, disks
        self.machine, self.joined = None, joined
        self.figures = []
        self.kept = None  # a run that has FINISHED

    # ---- the machine

    def boot(self, clock="utc"):
        began = time.monotonic()
        self.machine = Machine(self.folder, self.vmlinuz, self.starter, self.disks, 1024, "rw systemd.show_status=0 systemd.default_timeout_start_sec=900", clock)
        self.machine.wait_ready(LONG)
        return time.monotonic() - began

    def keep_disks(self, folder):
        """As they are now, for later runs that begin here."""
        self.sh("sync")
        self.machine.monitor("stop")
        folder.mkdir(parents=True)
        for disk in self.disks:
            subprocess.run(["cp", "--sparse=always", disk, folder], check=True)
        (folder / "kept").write_text(self.kept)
        self.machine.monitor("cont")

    def cut(self):
        """The power: what the machine had not given to its disk is lost."""
        self.machine.stop()
        self.machine = None

    def sh(self, order, timeout=LONG):
        said, code = self.machine.sh(order, timeout)
        check(code == 0, f"{order}: {code}: {said[-1500:]}")
        return said

    def wait(self, what, holds, timeout=LONG):
        end = time.monotonic() + timeout
        while True:
            found = holds()
            if found:
                return found
            check(time.monotonic() < end, f"{what}: not within {timeout} s")

    def line_of(self, path, event):
        """The line of a program's JSON that tells this event."""
        lines = [json.loads(line) for line in self.sh(f"cat {path}").splitlines() if line.startswith("{")]
        return next((line for line in lines if line.get("event") == event), None)

    # ---- the node

    def trb(self, words):
        return self.machine.sh(f"runuser -u trbots -- trb {words} --node {NODE}", LONG)

    def findings(self):
        said, _ = self.trb("doctor --json 2>/dev/null")
        report = json.loads(said or "{}")
        return {row["cause"]: row for row in report.get("findings", [])}, report.get("well")

    def wait_well(self):
        self.wait("the doctor finds no problem", lambda: self.findings()[1])

    def submit(self, name="short"):
        """(accepted, the run's id or what was said)"""
        said, code = self.trb(f"scenario run /root/{name}.json --json")
        run = re.search(r"[0-9a-f]{32}", said)
        return code == 0 and run is not None, run[0] if run else said

    def asked(self, words):
        """What trb says once it is answered: a busy machine may let a question wait for too long."""
        found = []

        def ask():
            said, code = self.trb(f"{words} --json 2>/dev/null")
            found[:] = [json.loads(said)] if code == 0 else []
            return bool(found)
        self.wait(f"trb {words} is answered", ask)
        return found[0]

    def runs(self):
        """id: state; of all that this node knows, the archive too."""
        return {row["run"]: row["state"] for row in self.asked("run list --all")["runs"]}

    def wait_finished(self, *runs):
        self.wait(f"{runs} are FINISHED", lambda: (now := self.runs()) and all(now.get(run) == "FINISHED" for run in runs))

    def goes_on(self):
        """It is well again, and takes a run to its end."""
        self.wait_well()
        run = self.wait("it takes a run", lambda: (taken := self.submit())[0] and taken[1])
        self.wait_finished(run)
        return run

    def pid(self, program):
        """Of the robot's node; the cloud's runs the same programs."""
        said, code = self.machine.sh(f"pgrep -f '{program} {NODE}$'")
        return said.split()[0] if code == 0 else None


@step
def booted(story):
    """Linux and systemd are up, without a node"""
    story.figures.append(f"boot: {story.boot():.1f} s")


@step
def installed(story):
    """`apt install ./talkrobots*.deb`: nothing is started and nothing has failed, for there is no node yet"""
    began = time.monotonic()
    story.sh("cd /root && DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends ./talkrobots_*.deb ./talkrobots-cloud*.deb ./talkrobots-virtual*.deb")
    story.sh("trb help | grep -q '^trb: '")
    story.figures.append(f"install: {time.monotonic() - began:.1f} s")
    check(story.sh("systemctl is-enabled talkrobots talkrobots-sensor-bus").split() == ["enabled", "enabled"], "the units are enabled")
    check("talkrobots" not in story.sh("systemctl --failed --no-legend --plain || true"), "no unit has failed")
    check(story.machine.sh("systemctl is-active talkrobots")[0] == "inactive", "the node's unit waits")


@step
def locked_up(story):
    """`systemd-analyze security` gives both units at most 3.0"""
    for unit in ("talkrobots", "talkrobots-sensor-bus"):
        said = story.sh(f"systemd-analyze security --no-pager {unit}.service | tail -n 1")
        exposed = float(re.search(r"Overall exposure level for \S+: ([\d.]+)", said)[1])
        story.figures.append(f"exposure of {unit}: {exposed}")
        check(exposed <= MOST_EXPOSED, said)


@step
def joined(story):
    """a node joins by a code, and is started: `systemctl start` returns once it is ready"""
    for order in hall.MAKE_CLOUD:
        story.sh(order)
    began = time.monotonic()
    hall.join(story)
    story.figures.append(f"trb node new, fleet invite, node join: {time.monotonic() - began:.1f} s")
    for name, turns in (("short", 1), ("long", TURNS)):
        story.sh(f"echo '{scenario(turns)}' > /root/{name}.json")
    story.sh("chmod 755 /root; chmod 644 /root/*.json")
    began = time.monotonic()
    story.sh("systemctl start talkrobots")
    story.figures.append(f"systemctl start talkrobots: {time.monotonic() - began:.1f} s")
    check(story.sh("systemctl show -P SubState talkrobots") == "running", "it runs")
    story.wait_well()
    hall.first_sign_in(story)
    check(hall.noted_on_page(story) == "", "the page has nothing to say of it")
    story.kept = story.goes_on()
    if story.joined:
        story.keep_disks(story.joined)


@step
def killed(story):
    """kill -9 of each service, and of trb up itself: each is up again, and the node is well"""
    for program in ("trb-router", "trb-scheduler", "trb-mode-adapter"):
        first = story.pid(program)
        story.sh(f"kill -9 {first}")
        story.wait(f"{program} is up again", lambda: story.pid(program) not in (None, first))
    main = story.sh("systemctl show -P MainPID talkrobots")
    story.sh(f"kill -9 {main}")
    story.wait("systemd starts the node again", lambda: story.sh("systemctl show -P MainPID -P SubState talkrobots").split() not in (
        [main, "running"], ["0", "auto-restart"]) and "running" in story.sh("systemctl show -P SubState talkrobots"))
    story.wait_well()


@step
def reloaded(story):
    """`systemctl reload talkrobots` starts a sensor-bus that node.json names anew, lets it take new files, and leaves it as it is if they
    have faults; five quick ends do not end it"""
    file, unit = f"{NODE}/node.json", "talkrobots-sensor-bus"

    def bus():
        return int(story.sh(f"systemctl show -P MainPID {unit}"))

    def another_than(*pids):
        return story.wait(f"{unit} runs, not as {pids}", lambda: (now := bus()) not in (0, *pids) and now)
    check(bus() == 0, "node.json does not name it")
    story.sh(f"cp -p {file} /root/node.json; sed -i 's/\"scheduler\"]/\"scheduler\", \"sensor-bus\"]/' {file}; systemctl reload talkrobots")
    first = another_than()
    story.wait("it is up", lambda: {row["service"]: row["state"] for row in story.asked("service list")["services"]}.get("sensor-bus") == "up")
    story.sh("systemctl reload talkrobots")
    pid = another_than(first)
    story.sh(f"cp -p {file} /root/good.json; echo '{{' >> {file}")
    check(story.machine.sh("systemctl reload talkrobots")[1] != 0, "files with faults are refused")
    check(bus() == pid, "it goes on with the files that it has")
    story.sh(f"cp -p /root/good.json {file}")
    for _ in range(6):
        story.sh(f"kill -9 {pid}")
        pid = another_than(pid)
    story.sh(f"cp -p /root/node.json {file}; systemctl reload talkrobots")
    story.wait("it has ended", lambda: story.sh(f"systemctl show -P ActiveState {unit}") == "inactive")
    story.wait_well()


@step
def cut_from_power(story):
    """the power goes in the middle of a run; after the next boot the run goes on, to its end"""
    accepted, run = story.submit("long")
    check(accepted, run)
    story.wait("a task has ended", lambda: '"FINISHED"' in json.dumps(story.asked(f"run show {run}")))
    check(story.runs()[run] != "FINISHED", "it is in the middle")
    story.cut()
    story.boot()
    story.wait("the node is up", lambda: story.machine.sh("systemctl is-active talkrobots")[0] == "active")
    story.wait_finished(run)
    story.kept = run


@step
def one_line_an_event(story):
    """`journalctl -u talkrobots`: each event is a line, with what began and what ended"""
    said = story.sh("journalctl -u talkrobots -o cat --no-pager | tail -n 400")
    lines = said.splitlines()
    check(len(lines) > 5 and all(line.strip() for line in lines), f"{len(lines)} lines, an empty one among them: {lines[:20]}")
    broken = [line for line in lines if line[0] in " \t}])" or line.startswith(("#", "at "))]
    check(not broken, f"events of more than one line: {broken[:5]}")
    check(any("ready" in line for line in lines) and any("trb-router" in line or "router" in line for line in lines), f"{lines[:20]}")
    story.figures.append(f"journal: {len(lines)} lines")


def refused(story, *words):
    """No run is taken, and who submits one reads why, and what to do; but for the moment in which the scheduler starts again."""
    def is_told():
        accepted, said = story.submit()
        check(not accepted, f"a run was taken: {said}")
        return said if all(word in said for word in words) else None
    print(f"       {story.wait(f'it is refused with {words}', is_told, 120)[:240]}")


def diagnosed(story, code):
    found = story.wait("the doctor says it", lambda: story.findings()[0].get(code))
    check(found["severity"] == "problem", "a problem")


def told(story, code, cure):
    """The doctor says that the disk takes nothing more, no run is taken, and the page says it, too."""
    diagnosed(story, code)
    refused(story, cure, NODE)
    check(cure in hall.noted_on_page(story), "the page says it")


def begun(story):
    """A run that has been acknowledged, and a task of which has ended."""
    run = story.wait("it takes a run", lambda: (taken := story.submit("long"))[0] and taken[1])
    story.wait("a task has ended", lambda: '"FINISHED"' in json.dumps(story.asked(f"run show {run}")))
    return run


@step
def no_room(story):
    """the disk is full: the doctor and the page say so, no run is taken, also after kill -9; with room again the run goes on"""
    run = begun(story)
    story.sh("runuser -u trbots -- dd if=/dev/zero of=/var/lib/talkrobots/filler bs=64k 2>/dev/null; sync; true")
    told(story, "disk_full", "df -h")
    story.sh(f"kill -9 {story.pid('trb-scheduler')}")
    story.wait("its scheduler waits", lambda: story.findings()[0].get("service_waits"))
    refused(story, "no_service", "df -h", NODE)
    story.sh("rm /var/lib/talkrobots/filler; sync")
    story.wait_finished(run)
    story.goes_on()
    check(story.runs().get(story.kept) == "FINISHED", "the run that was acknowledged is there")


@step
def no_inodes(story):
    """no file can be made: the doctor and the page say so, no run is taken; the run that it has comes to its end"""
    run = begun(story)
    story.sh("cd /var/lib/talkrobots && runuser -u trbots -- bash -c 'mkdir f && i=0; while touch f/$i; do i=$((i+1)); done' 2>/dev/null; true")
    told(story, "no_inodes", "df -i")
    story.wait_finished(run)
    story.sh("rm -r /var/lib/talkrobots/f; sync")
    story.goes_on()
    check(story.runs().get(story.kept) == "FINISHED", "the run that was acknowledged is there")


@step
def read_only(story):
    """the disk can only be read, at the node's start: the doctor says so, no run is taken; once it can be written all goes on"""
    story.sh("systemctl stop talkrobots; mount -o remount,ro /var/lib/talkrobots; systemctl start --no-block talkrobots")
    diagnosed(story, "disk_read_only")
    accepted, said = story.submit()
    check(not accepted, f"a run was taken: {said}")
    print(f"       {said[:200]}")
    story.sh("mount -o remount,rw /var/lib/talkrobots")  # systemd tries again and again
    story.goes_on()
    check(story.kept in story.runs(), "the run that was acknowledged is there")


@step
def a_clock_of_1999(story):
    """the clock is wrong at boot: the doctor says so; once it is set the node is well again, and has lost nothing"""
    story.sh("sync; systemctl stop talkrobots")
    story.cut()
    story.boot("1999-12-31T23:00:00")
    found = story.wait("the doctor says it", lambda: {"clock_off", "clock_wrong", "cert_not_yet", "clock_not_set"} & set(story.findings()[0]))
    print(f"       {sorted(found)}")
    story.sh(f"date -u -s @{int(time.time())}")
    story.goes_on()
    check(story.kept in story.runs(), "the run that was acknowledged is there")


def tell(story):
    """What helps to find the fault."""
    try:
        print(story.machine.sh(f"systemctl status --no-pager talkrobots | tail -n 30; tail -n 15 {NODE}/log/*.log; runuser -u trbots -- trb doctor --node {NODE}", 60)[0][-6000:])
    except (AttributeError, OSError, TimeoutError):
        log = story.folder / "console.log"
        print(log.read_text(errors="replace")[-3000:] if log.exists() else "the machine said nothing")


FIRST = (booted, installed, joined)  # of every part


def booted_again(story):
    """it boots with a node that has joined before"""
    story.boot()
    story.kept = (story.joined / "kept").read_text()
    story.wait_well()


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("packages", type=pathlib.Path)
    parser.add_argument("--keep", action="store_true")
    parser.add_argument("--joined", type=pathlib.Path)
    parser.add_argument("--only", action="append", metavar="PART", choices=[each.__name__ for each in step.all if each not in FIRST])
    words = parser.parse_args()
    if words.only:
        step.all = [each for each in step.all if each in FIRST or each.__name__ in words.only]
    for each in (signal.SIGTERM, signal.SIGHUP):
        signal.signal(each, lambda *_: sys.exit(1))  # so that all is cleaned up
    store = image.REPO / "build/package"
    folder = pathlib.Path(tempfile.mkdtemp(prefix="vm-", dir=store))
    cleanups = Cleanups()
    cleanups.addCleanup(*(print, f"left behind: {folder}") if words.keep else (shutil.rmtree, folder))
    try:
        vmlinuz, version = image.kernel()
        if words.joined and words.joined.exists():
            disks = [shutil.copy(words.joined / name, folder) for name in ("disk", "state")]
            step.all = [booted_again, *(each for each in step.all if each not in FIRST)]
        else:
            disks = [debian_image.disk(folder, words.packages, store), debian_image.state_disk(folder)]
        story = Story(folder, vmlinuz, debian_image.starter(folder, version), disks, words.joined)
        cleanups.addCleanup(lambda: story.machine and story.machine.stop())
        return step.play(story, (AssertionError, OSError, RuntimeError, ValueError), tell)
    except (OSError, RuntimeError) as fault:
        print(f"scripts/test-vm: {fault}", file=sys.stderr)
        return 1
    finally:
        cleanups.end()


if __name__ == "__main__":
    sys.exit(main())
