#!/usr/bin/python3
"""Lists what a package is made of, from its finished programs and the build that made them: sbom.spdx.json (SPDX 2.3) and
sbom.cyclonedx.json (CycloneDX 1.5), and for what is compiled in the copyright files, in one folder.
"""
import argparse
import gzip
import os
import pathlib
import re
import sys

import debian
import documents
import linked
import page
from documents import Part

LICENCE = "Apache-2.0"
CONTROL = pathlib.Path(__file__).resolve().parents[1] / "debian" / "control"


def part_of(package, how, needs=(), libraries=()):
    return Part(f"deb-{package.id}", package.name, package.version, package.licence, package.purl, how, package.supplier, needs, package.said, libraries)


def own_part(name, version, arch, needs):
    """The package itself."""
    maintainer = re.search(r"^Maintainer:\s*(.+)$", CONTROL.read_text(encoding="utf-8"), re.MULTILINE)[1]
    return Part(f"deb-{name}", name, version, LICENCE, documents.purl("deb", "talkrobots", name, version, arch=arch), None, debian.supplier(maintainer), needs,
                kind="library" if name.startswith("lib") else "application")


def dynamic_parts(programs, triplet):
    """The packages of all libraries that are loaded, each with those that it needs; and the keys of those named by a program itself."""
    libraries = linked.closure(programs, triplet)
    owner = debian.owners([path for path, _ in libraries.values()])
    package_of = {name: owner[str(path)] for name, (path, _) in libraries.items()}
    parts = []
    for package in sorted(set(package_of.values())):
        mine = [name for name in libraries if package_of[name] == package]
        needs = {f"deb-{package_of[other]}" for name in mine for other in libraries[name][1]} - {f"deb-{package}"}
        parts.append(part_of(debian.Package(package), "dynamic", needs, mine))
    return parts, {f"deb-{package_of[name]}" for program in programs for name in linked.needed(program)}


def compiled_in_parts(names, build):
    """The packages whose headers were compiled into files of these names."""
    files = set()
    for target in build.targets(names):
        files |= build.files(target)
    packages = [debian.Package(name) for name in sorted(set(debian.owners(files).values()))]
    return [part_of(package, "compiled in") for package in packages], packages


def collect(tree, build, triplet, lock_file):
    """(parts, keys of what the package itself needs, packages that are compiled in)"""
    files = [path for path in sorted(pathlib.Path(tree).rglob("*")) if path.is_file() and not path.is_symlink()]
    programs = [path for path in files if linked.is_elf(path)]
    dynamic, direct = dynamic_parts(programs, triplet)
    made = {path.name for path in programs} | {path.name for path in files if path.suffix == ".a"}
    compiled, packages = compiled_in_parts(made, build)
    if lock_file:
        compiled += page.parts(lock_file)
    there = {part.key for part in dynamic}
    compiled = [part for part in compiled if part.key not in there]
    return dynamic + compiled, direct | {part.key for part in compiled}, packages


def copy_copyrights(packages, folder):
    folder.mkdir(parents=True, exist_ok=True)
    for package in packages:
        target = folder / f"{package.name}.copyright.gz"
        target.write_bytes(gzip.compress(package.copyright.read_bytes(), mtime=0))
        target.chmod(0o644)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("package", help="its name")
    parser.add_argument("--tree", required=True, help="the package's files, as they will be installed")
    parser.add_argument("--build", required=True, help="the build folder of ninja's that made them")
    parser.add_argument("--version", required=True)
    parser.add_argument("--arch", required=True, help="Debian's name of it")
    parser.add_argument("--triplet", required=True, help="the folder's name of that architecture's libraries")
    parser.add_argument("--page", help="the lock file of a page that is compiled in")
    parser.add_argument("--output", required=True, help="the folder for the lists")
    words = parser.parse_args()
    try:
        parts, direct, packages = collect(words.tree, linked.Build(words.build), words.triplet, words.page)
    except (OSError, LookupError) as fault:
        sys.exit(f"sbom: {fault}")
    main_part = own_part(words.package, words.version, words.arch, direct)
    epoch = os.environ.get("SOURCE_DATE_EPOCH", "0")
    output = pathlib.Path(words.output)
    output.mkdir(parents=True, exist_ok=True)
    for name, form in (("spdx", documents.spdx), ("cyclonedx", documents.cyclonedx)):
        (output / f"sbom.{name}.json").write_text(form(main_part, parts, epoch), encoding="utf-8")
        (output / f"sbom.{name}.json").chmod(0o644)
    copy_copyrights(packages, output / "compiled-in")


if __name__ == "__main__":
    main()
