"""What programs are really made of: the libraries that their dynamic sections name, and what was compiled into them."""
import os
import pathlib
import re
import subprocess


def run(*words, **more):
    return subprocess.run([str(word) for word in words], capture_output=True, text=True, check=True, **more).stdout


def is_elf(path):
    with open(path, "rb") as file:
        return file.read(4) == b"\x7fELF"


def needed(path):
    """The names of the libraries that it is linked to (DT_NEEDED)."""
    return re.findall(r"\(NEEDED\)\s+Shared library: \[(.+?)\]", run("readelf", "-d", path))


def library_folders(triplet):
    return [f"/lib/{triplet}", f"/usr/lib/{triplet}", f"/usr/{triplet}/lib", "/lib64", "/lib", "/usr/lib"]


def find_library(name, triplet):
    for folder in library_folders(triplet):
        path = pathlib.Path(folder, name)
        if path.exists():
            return path
    raise FileNotFoundError(f"{name}: in no folder of libraries; install the package that has it")


def closure(programs, triplet):
    """name of a library: (its file, names of the libraries that it is linked to itself); from all these programs."""
    there, waiting = {}, sorted({name for program in programs for name in needed(program)})
    while waiting:
        name = waiting.pop()
        if name in there:
            continue
        path = find_library(name, triplet)
        there[name] = (path, needed(path))
        waiting += there[name][1]
    return there


class Build:
    """A finished build folder of ninja's, which knows each object's headers."""

    def __init__(self, folder):
        self.folder = pathlib.Path(folder)
        self.headers = self.read_headers(run("ninja", "-t", "deps", cwd=self.folder))

    @staticmethod
    def read_headers(said):
        """object: the files it was compiled from, as `ninja -t deps` says it."""
        there, of = {}, None
        for line in said.splitlines():
            if line.startswith("    "):
                of.append(line.strip())
            elif line:
                of = there.setdefault(line.split(": #deps")[0], [])
        return there

    def files(self, target):
        """All files outside of the tree that were compiled into the target: headers, precompiled ones too."""
        objects, seen, found = run("ninja", "-t", "inputs", target, cwd=self.folder).splitlines(), set(), set()
        while objects:
            each = objects.pop()
            if each in seen:
                continue
            seen.add(each)
            for file in self.headers.get(each, []):
                if file.startswith("/usr/"):
                    found.add(os.path.realpath(file))
                elif file.endswith(".gch"):
                    objects.append(os.path.relpath(self.folder / file, self.folder))
        return found

    def targets(self, names):
        """The targets that make files of these names."""
        made = re.findall(r"^(.+?): (?!phony)", run("ninja", "-t", "targets", "all", cwd=self.folder), re.MULTILINE)
        return [each for each in made if os.path.basename(each) in names]
