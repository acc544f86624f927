"""The story of scripts/test-package: packages in an empty Debian 12, as their user meets them; what is left, and what they are made of."""
import argparse
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent / "support"), str(HERE.parent / "integration")]

import hardening  # noqa: E402
import sbom_check  # noqa: E402
import shell_blocks  # noqa: E402
from root import REPO, Failed, Root  # noqa: E402
from steps import Steps  # noqa: E402

ROAD_S = 60  # of a processor: from `apt install` to a `trb` that answers
STATE = "var/lib/talkrobots"
COMPILED_IN = {"talkrobots": ("libmsgpack-cxx-dev", "nlohmann-json3-dev", "cppzmq-dev"), "talkrobots-cloud": ("libboost1.74-dev",),
               "talkrobots-ros": (), "talkrobots-virtual-robots": (), "libtalkrobots-dev": ()}
# What a purge may leave, by Debian's policy: the user, whose number is not given away again.
MAY_STAY = {"etc/passwd", "etc/passwd-", "etc/group", "etc/group-", "etc/shadow", "etc/shadow-", "etc/gshadow", "etc/gshadow-", "etc/.pwd.lock"}
# The definitions of the types that the commands of robots on ROS publish: "geometry_msgs/msg/Twist.msg".
PUBLISHED = sorted({f"{package}/msg/{name}.msg" for package, name in
                    re.findall(r"\b([a-z_]+_msgs)/([A-Z]\w+)", (REPO / "config/commands.json").read_text())})
HANDBOOK = REPO / "deploy/handbook/README.md"
UPGRADE = re.search(r"\*\*Upgrade\*\*: `(apt install [^`]+)`", (REPO / "deploy/README.md").read_text())[1]
PACKAGES_PAGE = REPO / "deploy/handbook/packages.md"
# apt asks a person whether to go on; the answer here is yes, as by a person who presses Enter.
YES = "echo 'APT::Get::Assume-Yes \"true\";' >/etc/apt/apt.conf.d/90-yes; trap 'rm /etc/apt/apt.conf.d/90-yes' EXIT\n"
INSTALL = "apt-get install -y -qq {words} >/tmp/said 2>&1 || { cat /tmp/said; exit 1; }; cat /tmp/said"
NODE = """
export TRB_PASSPHRASE=a-hall-for-trying
cd /var/lib/talkrobots
as() { runuser -u trbots -- "$@"; }
as trb node new node --robot arm1 --like ur --address 127.0.9.2 --network 127.0.9.1 --interface 127.0.9.1
trb fleet init /root/authority >/dev/null
cp node/keys/request.json /root/request.json
trb fleet sign /root/authority /root/request.json >/dev/null
install -o trbots -g trbots -m 0600 /root/certificate.json node/keys/certificate.json
as trb check node
"""
UP = """
cd /var/lib/talkrobots
rm -f /tmp/up
runuser -u trbots -- trb up node >/tmp/up 2>&1 &
node=$!
for _ in $(seq 300); do grep -qs ready /tmp/up && break; kill -0 $node || break; read -r -t 0.2 <> <(:) || true; done
cat /tmp/up
grep -q ready /tmp/up
runuser -u trbots -- trb service list --node node
runuser -u trbots -- trb down node
wait $node
"""
# What a purge does to a node's folder that is no plain one; as the package's own script, so that it stays installed.
PURGE = f"""
fill() {{ mkdir -p "$1/node/keys"; touch "$1/node/keys/key" "$1/.hidden"; }}
purge() {{ /var/lib/dpkg/info/talkrobots.postrm purge; }}
emptied() {{ test -z "$(ls -A "$1")"; }}
mkdir -p /tmp/disk /{STATE}
mv /{STATE} /tmp/kept; mkdir /{STATE}
"""
ON_A_DISK = f"""{PURGE}
mount -t tmpfs disk /{STATE}; fill /{STATE}; purge; mountpoint -q /{STATE}; emptied /{STATE}; umount /{STATE}
mkdir /{STATE}/node; mount -t tmpfs disk /{STATE}/node; fill /{STATE}; purge; emptied /{STATE}/node; umount /{STATE}/node
rm -r /{STATE}; mv /tmp/kept /{STATE}
"""
BEHIND_A_LINK = f"""{PURGE}
rmdir /{STATE}; ln -s /tmp/disk /{STATE}; fill /tmp/disk; purge; emptied /tmp/disk; test ! -L /{STATE}
ln -s /tmp/nowhere /{STATE}; purge; test ! -L /{STATE}
mv /tmp/kept /{STATE}
"""
step = Steps()


def check(holds, what):
    if not holds:
        raise Failed(what)


def fields(deb):
    said = subprocess.run(["dpkg-deb", "-f", deb, "Package", "Version"], capture_output=True, text=True, check=True).stdout
    return dict(re.findall(r"^(\w+): (.*)$", said, re.MULTILINE))


def older(deb, folder):
    """The same package as version 0.0.1, with a file that the newer one does not have any more."""
    tree = folder / "older"
    shutil.rmtree(tree, ignore_errors=True)
    subprocess.run(["dpkg-deb", "-R", deb, tree], check=True)
    name = fields(deb)["Package"]
    (tree / "usr/share/doc" / name / "gone").write_text("of the older version\n")
    control = (tree / "DEBIAN/control").read_text()
    control = re.sub(r"^Version: .*$", "Version: 0.0.1", control, flags=re.MULTILINE)
    (tree / "DEBIAN/control").write_text(re.sub(r"talkrobots \(= [^)]*\)", "talkrobots (= 0.0.1)", control))
    made = folder / f"{name}_0.0.1.deb"
    subprocess.run(["dpkg-deb", "--root-owner-group", "-Zgzip", "-b", tree, made], check=True, stdout=subprocess.DEVNULL)
    return made


class Story:
    """`base`: the bare Debian. `emulated`: its programs are run by qemu-user, so that nothing is said of their speed."""

    def __init__(self, folder, packages, base, emulated):
        self.folder, self.base, self.emulated = folder, base, emulated
        self.debs = sorted(path for path in packages.glob("*.deb"))
        self.debug = sorted((packages / "debug").glob("*.deb"))
        self.user = [path for path in self.debs if path.name.startswith("talkrobots")]
        self.changes = next(iter(packages.glob("*.changes")), None)
        self.sums = packages / "SHA256SUMS"
        self.names = [fields(path)["Package"] for path in self.debs]
        self.root = Root(base, folder / "root")
        self.root.run("apt-get update -qq")
        self.figures = []
        self.commands = [block.text for block in shell_blocks.blocks_of(HANDBOOK)][:3]
        check(self.commands[0].startswith("apt install "), f"the first command of {HANDBOOK.name} is: {self.commands[0]}")

    def install(self, files, options=""):
        return self.root.run(INSTALL.replace("{words}", f"{options} {' '.join(self.root.share(*files))}"))

    def state(self):
        return self.root.files(STATE)


@step
def what_the_dependencies_leave(story):
    """(beside it, the same Debian with nothing but what the packages depend on, to compare with)"""
    files = " ".join(story.root.share(*story.user))
    said = story.root.run(f"apt-get install -s {files}").said
    others = [name for name in re.findall(r"^Inst (\S+)", said, re.MULTILINE) if name not in story.names]
    beside = Root(story.base, story.folder / "beside")
    beside.run("apt-get update -qq; " + INSTALL.replace("{words}", " ".join(others)))
    story.without = beside.files()
    shutil.rmtree(beside.path)


@step
def installed_on_an_empty_computer(story):
    """the handbook's first command, as it stands there, in a folder with the packages; and `trb` answers"""
    files = story.root.share(*story.user)
    done = story.root.run(f"{YES}export TERM=dumb; cd {pathlib.Path(files[0]).parent}\n{story.commands[0]}")
    again = story.root.run("trb help | head -n 1")
    check(again.said.startswith("trb: "), again.said)
    story.figures.append(f"from `apt install` to a trb that answers: {done.seconds + again.seconds:.1f} s, {done.processor + again.processor:.1f} s of a processor")
    check(story.emulated or done.processor + again.processor < ROAD_S, story.figures[-1])


@step
def checked_against_their_list(story):
    """the handbook's command that compares the packages with SHA256SUMS and installs; with one byte more it installs nothing"""
    block = next(block.text for block in shell_blocks.blocks_of(PACKAGES_PAGE) if block.text.startswith("sha256sum "))
    folder = pathlib.Path(story.root.share(*story.user, story.sums)[0]).parent
    begin = f"{YES}rm -rf /tmp/stick; mkdir /tmp/stick; cp {folder}/*.deb {folder}/SHA256SUMS /tmp/stick; cd /tmp/stick\n"
    good = story.root.run(begin + block).said
    check(good.count(": OK") == len(story.user) and "FAILED" not in good, good)
    wrong = story.root.run(f"{begin}printf x >> talkrobots_*.deb\nif {block.strip()}; then exit 1; fi; rm -r /tmp/stick").said
    check("FAILED" in wrong and "Reading package lists" not in wrong, wrong)


@step
def what_is_installed(story):
    """every program finds its libraries; user, folder, units, completion and manual are there, and nothing is started without a node"""
    said = story.root.run("for each in /usr/bin/trb*; do ldd $each; done").said
    check("not found" not in said, said)
    story.root.run("bash -n /usr/share/bash-completion/completions/trb; zcat /usr/share/man/man1/trb.1.gz | head -n 3 | grep -q TRB")
    check(story.root.run(f"stat -c '%U %G %a' /{STATE}").said.split() == ["trbots", "trbots", "700"], "the node's folder is its user's")
    said = story.root.run("systemd-analyze verify --man=no talkrobots.service talkrobots-sensor-bus.service 2>&1 | grep talkrobots || true").said
    check(said == "", said)
    for kind in PUBLISHED:
        check((story.root.path / "usr/share" / kind).is_file(), f"{kind}: a robot on ROS cannot be sent that, and its stop may be one")
    for unit in ("talkrobots", "talkrobots-sensor-bus"):
        check((story.root.path / f"etc/systemd/system/multi-user.target.wants/{unit}.service").is_symlink()
              or (story.root.path / f"etc/systemd/system/talkrobots.service.wants/{unit}.service").is_symlink(), f"{unit} is enabled")


@step
def a_node_in_it(story):
    """a node's folder made, signed and checked as its user; `trb up` says ready"""
    said = story.root.run(NODE + UP).said
    check("router" in said and "mode-adapter" in said, said)
    story.kept = story.state()
    check(any("/keys/" in path for path in story.kept), f"keys are there: {sorted(story.kept)[:9]}")


@step
def the_first_page_of_the_handbook(story):
    """after the installation two commands, as they stand there, and robots have moved"""
    done = story.root.run("cd /root\n" + "".join(story.commands[1:]) + "trb down hall\nrm -r hall")
    check(re.search(r"^run \w+ FINISHED", done.said, re.MULTILINE), done.said)
    story.figures.append(f"the handbook's two commands after that, until its robots have moved: {done.seconds:.1f} s")


def unpacked(story):
    """(name, folder) of each package; the folder is there until the next."""
    tree = story.folder / "tree"
    for deb in story.debs:
        shutil.rmtree(tree, ignore_errors=True)
        subprocess.run(["dpkg-deb", "-x", deb, tree], check=True)
        yield fields(deb)["Package"], tree


@step
def what_holds_off_an_attacker(story):
    """every program is hardened"""
    if not story.debug:
        print("       skipped: packages of scripts/package --from are not hardened")
        return
    found = [f"{program.name}: {faults}" for _, tree in unpacked(story) for program in sbom_check.programs(tree) if (faults := hardening.faults(program))]
    check(not found, "\n".join(found))


@step
def what_it_is_made_of(story):
    """every package's lists of parts have every library that readelf names, with licence"""
    for name, tree in unpacked(story):
        found = list(sbom_check.faults(tree, tree / "usr/share/doc" / name, COMPILED_IN[name]))
        check(not found, f"{name}: {found}")


@step
def an_upgrade(story):
    """a lower version, then this one, by the command of deploy/README.md: what is no more is gone, keys and journals are the same, the node is
    up again; apt says that `talkrobots` alone would remove others"""
    older_debs = [older(path, story.folder) for path in story.user]
    story.install(older_debs, "--allow-downgrades")
    check((story.root.path / "usr/share/doc/talkrobots/gone").exists(), "the older version is there")
    check(story.state() == story.kept, "going back has left the node's folder as it was")
    begin = f"{YES}export TERM=dumb; rm -rf /tmp/newer; mkdir /tmp/newer; cp {' '.join(story.root.share(*story.user))} /tmp/newer; cd /tmp/newer\n"
    alone = story.root.run(f"{begin}apt-get install -s ./talkrobots_*.deb").said
    check("Remv talkrobots-cloud" in alone, alone)
    done = story.root.run(f"{begin}{UPGRADE}\nrm -r /tmp/newer")
    check("REMOVED" not in done.said, done.said)
    story.figures.append(f"upgrade: {done.seconds:.1f} s")
    left = [path for path in story.root.files("usr/share/doc") if path.endswith("/gone")]
    check(not left, f"of the older version: {left}")
    check(story.state() == story.kept, "the node's folder is as it was")
    story.root.run(UP)
    story.kept = story.state()


@step
def installed_once_more(story):
    """the same version again changes nothing"""
    before = story.root.files("usr")
    story.install(story.user, "--reinstall")
    check(story.root.files("usr") == before and story.state() == story.kept, "files differ")


@step
def removed(story):
    """`apt remove`: programs and units go; keys and journals stay, and it says so"""
    said = story.root.run("apt-get remove -y -qq 'talkrobots*' 2>&1").said
    check(f"stay in /{STATE}" in said and "purge" in said, said)
    check(story.state() == story.kept, "keys and journals are as they were")
    left = [path for path in story.root.files() if re.search("talkrobots|trb", path) and not path.startswith(STATE)]
    print("       left: " + ", ".join(sorted(left)))
    check(not [path for path in left if path.startswith(("usr/bin", "usr/lib/systemd", "lib/systemd"))], f"{left}")


@step
def purged_off_a_disk_of_its_own(story):
    """the folder is a disk of its own, or a link: what is in it goes, too, and the purge comes to its end"""
    for script in (ON_A_DISK, BEHIND_A_LINK):
        said = story.root.run(script).said
        check(f"removing /{STATE} for good" in said, said)
    check(story.state() == story.kept, "the keys and journals of this story are where they were")


@step
def purged(story):
    """`apt purge`: these go too, and it says so before; what is left is what the dependencies leave, and the user"""
    said = story.root.run("apt-get purge -y -qq 'talkrobots*' 2>&1").said
    check(f"removing /{STATE} for good" in said, said)
    check(not (story.root.path / STATE).exists(), "the node's folder is gone")
    now = story.root.files()
    differs = sorted(path for path in set(now) | set(story.without) if now.get(path) != story.without.get(path))
    print("       differs from a Debian that never had them: " + ", ".join(differs))
    # Times and random numbers of other packages' installation, not of ours.
    ours = [path for path in differs if path not in MAY_STAY and (path in now) and not (path in story.without and not re.search("talkrobots|trb", path))]
    check(not ours, f"left behind: {ours}")
    check(set(story.root.run("getent passwd trbots || true").said.split(":")[:1]) == {"trbots"}, "the user stays")


@step
def installed_again_behind_a_removal(story):
    """without a node `apt remove` takes the empty folder along; installed again it is there, its user's"""
    for _ in range(2):
        story.install(story.user)
        check(story.root.run(f"stat -c '%U %G %a' /{STATE}").said.split() == ["trbots", "trbots", "700"], "the node's folder is its user's")
        story.root.run("apt-get remove -y -qq 'talkrobots*'")
        check(not (story.root.path / STATE).exists(), "an empty folder goes")
    story.root.run("apt-get purge -y -qq 'talkrobots*'")


@step
def a_library_for_services(story):
    """`libtalkrobots-dev` is installed with what it needs, and CMake finds it"""
    deb = [path for path in story.debs if path.name.startswith("libtalkrobots-dev")]
    story.install(deb, "--no-install-recommends g++ cmake make")
    story.root.run("mkdir /tmp/own && cd /tmp/own && echo 'cmake_minimum_required(VERSION 3.25)\nproject(own CXX)\nfind_package(talkrobots 0.1 REQUIRED)\n"
                   "add_executable(own own.cpp)\ntarget_link_libraries(own PRIVATE talkrobots::service)' >CMakeLists.txt && "
                   "echo '#include \"common/service/service.hpp\"\nint main() { return 0; }' >own.cpp && cmake . >/dev/null && make 2>&1 && ./own")
    story.root.run("apt-get purge -y -qq libtalkrobots-dev")


@step
def the_packages_judged_by_lintian(story):
    """lintian finds no error"""
    check(story.changes, "there is no .changes beside the packages")
    done = subprocess.run(["lintian", "--allow-root", "--tag-display-limit", "0", *story.debs, *story.debug], capture_output=True, text=True, check=False)
    told = [line for line in done.stdout.splitlines() if re.match(r"[EW]: ", line)]
    print("\n".join(f"       {line[:180]}" for line in told))
    check(done.returncode in (0, 2) and not [line for line in told if line.startswith("E: ")], "lintian has errors: see above")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("packages", type=pathlib.Path)
    parser.add_argument("base", type=pathlib.Path)
    parser.add_argument("--keep", action="store_true")
    parser.add_argument("--emulated", action="store_true")
    words = parser.parse_args()
    folder = pathlib.Path(tempfile.mkdtemp(prefix="test-", dir=REPO / "build/package"))
    try:
        return step.play(Story(folder, words.packages, words.base, words.emulated), (Failed, OSError, subprocess.SubprocessError))
    except Failed as fault:
        print(f"scripts/test-package: {fault}", file=sys.stderr)
        return 1
    finally:
        if words.keep:
            print(f"left behind: {folder}")
        else:
            shutil.rmtree(folder)


if __name__ == "__main__":
    sys.exit(main())
