"""What dpkg knows of the packages that a file comes from, and their licences as their copyright files have them."""
import pathlib
import re
import subprocess

from documents import Supplier, Words, purl
from linked import run

# Names of licences in Debian's copyright files, and SPDX' names of them.
SPDX = {
    "expat": "MIT", "mit": "MIT", "isc": "ISC", "zlib": "Zlib", "boost-1": "BSL-1.0", "bsl-1.0": "BSL-1.0", "apache-2.0": "Apache-2.0", "apache-2": "Apache-2.0",
    "bsd-2-clause": "BSD-2-Clause", "bsd-3-clause": "BSD-3-Clause", "gpl-2": "GPL-2.0-only", "gpl-2+": "GPL-2.0-or-later",
    "gpl-3": "GPL-3.0-only", "gpl-3+": "GPL-3.0-or-later", "lgpl-2+": "LGPL-2.0-or-later", "lgpl-2.1": "LGPL-2.1-only",
    "lgpl-2.1+": "LGPL-2.1-or-later", "lgpl-3": "LGPL-3.0-only", "lgpl-3+": "LGPL-3.0-or-later", "lgpl-3.0+": "LGPL-3.0-or-later",
    "mpl-2.0": "MPL-2.0", "cc0-1.0": "CC0-1.0", "openldap-2.8": "OLDAP-2.8", "postgresql": "PostgreSQL",
}
# Of these sources the copyright file is prose, or says of all files together what SPDX has no name for, or another text than upstream has.
OF_SOURCE = {
    "gcc-12": "GPL-3.0-or-later WITH GCC-exception-3.1", "gcc-12-cross": "GPL-3.0-or-later WITH GCC-exception-3.1",
    "glibc": "LGPL-2.1-or-later", "cross-toolchain-base": "LGPL-2.1-or-later", "linux": "GPL-2.0-only WITH Linux-syscall-note",
    "libjpeg-turbo": "IJG AND BSD-3-Clause AND Zlib", "fmtlib": "MIT", "icu": "Unicode-DFS-2016",
}
TEAM = re.compile(r"\b(team|maintainers|packagers)\b", re.IGNORECASE)


class Package:
    """An installed package: name, version, architecture, source, supplier, licence (an SPDX expression, or a LicenseRef), copyright file."""

    def __init__(self, name):
        self.id = name
        fields = run("dpkg-query", "-W", "-f", "${Package}\t${Version}\t${Architecture}\t${source:Package}\t${Homepage}\t${Maintainer}", name)
        self.name, self.version, self.arch, self.source, self.homepage, maintainer = fields.split("\t")
        self.supplier = supplier(maintainer)
        self.copyright = pathlib.Path("/usr/share/doc", self.name, "copyright")
        self.licence, self.said = licence(self.copyright.read_text(errors="replace"), self.source)

    @property
    def purl(self):
        return purl("deb", "debian", self.name, self.version, arch=self.arch, distro="debian-12")


def supplier(maintainer):
    """Of a field such as `Debian GCC Maintainers <debian-gcc@lists.debian.org>`."""
    name, _, address = maintainer.strip().removesuffix(">").partition(" <")
    return Supplier(name, address or None, bool(TEAM.search(name)))


def stanza_licence(text):
    """The licence of `Files: *`, or all of the file's, as they are named there."""
    stanzas = re.split(r"\n\s*\n", text)
    for stanza in stanzas:
        if re.search(r"^Files:\s*\*\s*$", stanza, re.MULTILINE):
            found = re.search(r"^License:[ \t]*(\S.*)$", stanza, re.MULTILINE)
            if found:
                return [found[1].strip()]
    named = {match.strip() for stanza in stanzas if stanza.lstrip().startswith("Files:")
             for match in re.findall(r"^License:[ \t]*(\S.*)$", stanza, re.MULTILINE)}
    return sorted(named)


def stanza_texts(text):
    """name of a licence, in small letters: its text, where a stanza has it."""
    found = {}
    for name, lines in re.findall(r"^License:[ \t]*(\S.*)\n((?:[ \t].*\n?)+)", text, re.MULTILINE):
        lines = [line[1:].rstrip() for line in lines.splitlines()]
        found.setdefault(name.strip().lower(), "\n".join("" if line == "." else line for line in lines))
    return found


def words(reference, named, text):
    """What the copyright file says of a licence that SPDX has no name for; all of the file, where it is prose or has no such stanza."""
    texts = stanza_texts(text)
    found = [texts.get(name.lower()) for name in named]
    return Words("; ".join(named) or reference, "\n\n".join(found) if named and all(found) else text.strip())


def expression(named):
    """SPDX' expression of one of Debian's, such as `GPL-2+ or MIT`; None where it has no name for a part, or a comma sets another order."""
    found = []
    for word in re.split(r"\s+(and|or)\s+", named):
        if word in ("and", "or"):
            found.append(word.upper())
        elif word.lower() in SPDX:
            found.append(SPDX[word.lower()])
        else:
            return None
    return " ".join(found)


def licence(text, source):
    """The expression, and what the copyright file says where it is a LicenseRef of this source's."""
    if source in OF_SOURCE:
        return OF_SOURCE[source], None
    named = stanza_licence(text)
    found = [expression(each) for each in named]
    if named and all(found):
        return found[0] if len(found) == 1 else " AND ".join(f"({each})" if " " in each else each for each in found), None
    reference = "LicenseRef-Debian-" + re.sub(r"[^A-Za-z0-9.-]", "-", source)
    return reference, words(reference, named, text)


def owners(paths):
    """path: the package that it is from, architecture included where dpkg tells it."""
    asked = {}
    for path in map(str, paths):
        asked[path] = path
        # A system whose /lib is /usr/lib: dpkg knows the file by one of both.
        asked[path.removeprefix("/usr") if path.startswith("/usr/lib") else "/usr" + path] = path
    said = subprocess.run(["dpkg-query", "-S", *sorted(asked)], capture_output=True, text=True, check=False).stdout
    found = {}
    for line in said.splitlines():
        if not line.startswith("diversion "):
            package, _, file = line.partition(": ")
            found[asked[file]] = package.split(", ")[0]
    missing = sorted(set(map(str, paths)) - set(found))
    if missing:
        raise LookupError(f"{missing[0]}: of no package; an SBOM names what comes from Debian alone")
    return found
