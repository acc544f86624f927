#!/usr/bin/env python3
"""Checks that a file includes, by itself or by what it includes, the header of every name that it uses. The test suite compiles
joined files, in which a neighbour's includes hide a missing one; packages and the demonstration compile each by itself.

    scripts/check_includes.py        checks the repository it stands in; exit 0 if all is well

It knows types, aliases and constants of a namespace that one header of the repository defines and nobody else; it does not know
functions, nor the standard library. The compiler knows all of it.
"""
import collections
import pathlib
import re
import subprocess
import sys

REPO = pathlib.Path(__file__).resolve().parent.parent
INCLUDE = re.compile(r'^\s*#\s*include\s*"([^"]+)"', re.M)
# What is no code: includes, comments, raw and other strings, characters.
NO_CODE = re.compile(r'#\s*include[^\n]*|//[^\n]*|/\*.*?\*/|R"\w*\(.*?\)\w*"|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])\'', re.S)
# At the beginning of a line: of a namespace, not of a class.
DEFINED = (
    re.compile(r'^(?:template\s*<[^;{]*>\s*)?(?:enum\s+class|enum|struct|class)\s+(\w+)(?:\s+final)?\s*(?::[^;{(]*)?\{', re.M),
    re.compile(r'^(?:inline\s+)?constexpr\s+[\w:<>, ]+?\s(k[A-Z]\w*)\s*[={(\[]', re.M),
    re.compile(r'^using\s+(\w+)\s*=', re.M),
)
# Anywhere: declared ahead, a class's own, a template's parameter, an enumerator.
DECLARED = (
    re.compile(r'\b(?:enum\s+class|enum|struct|class|typename|using|concept)\s+(\w+)'),
    re.compile(r'\b(k[A-Z]\w*)\s*[={]'),
    re.compile(r'\bstd::size_t\s+([A-Z]\w*)'),
    re.compile(r'^\s+(\w+),?$', re.M),
)
USED = re.compile(r'(?<!_msgs::)\b\w+')  # ROS has types of its own


def names(expressions, code):
    return {name for expression in expressions for name in expression.findall(code)}


def reached(includes):
    """For each file, itself and all that it includes, by whatever way."""
    out = {}
    for file in includes:
        seen, todo = {file}, [file]
        while todo:
            more = [other for other in includes[todo.pop()] if other not in seen]
            seen.update(more)
            todo += more
        out[file] = seen
    return out


def main():
    listed = subprocess.run(["git", "-C", str(REPO), "ls-files", "-co", "--exclude-standard", "*.cpp", "*.hpp"], check=True, stdout=subprocess.PIPE,
                            text=True).stdout.split()
    text = {file: (REPO / file).read_text() for file in listed if (REPO / file).is_file()}
    code = {file: NO_CODE.sub(" ", content) for file, content in text.items()}
    defined, declared = collections.defaultdict(set), collections.defaultdict(set)
    for file, content in code.items():
        for name in names(DEFINED, content):
            defined[name].add(file)
        for name in names(DECLARED, content):
            declared[name].add(file)
    home = {name: next(iter(where)) for name, where in defined.items() if len(where) == 1 and next(iter(where)).endswith(".hpp")}
    reach = reached({file: [other for other in INCLUDE.findall(content) if other in text] for file, content in text.items()})
    faults = [f"{file}: uses {name}, which {home[name]} defines: include it"
              for file, content in sorted(code.items()) for name in sorted(set(USED.findall(content)) & home.keys())
              if home[name] not in reach[file] and not declared[name] & reach[file]]
    print("\n".join([*faults, f"check_includes: {len(text)} files, {len(faults)} faults"]))
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
