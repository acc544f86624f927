"""What dpkg knows of the packages that a file comes from, and their licences as their copyright files have them."""
import pathlib
import re
import subprocess

from linked import run

# Names of licences in Debian's copyright files, and SPDX' names of them.
SPDX = {
    "expat": "MIT", "mit": "MIT", "isc": "ISC", "zlib": "Zlib", "boost-1": "BSL-1.0", "bsl-1.0": "BSL-1.0", "apache-2.0": "Apache-2.0", "apache-2": "Apache-2.0",
    "bsd-2-clause": "BSD-2-Clause", "bsd-3-clause": "BSD-3-Clause", "gpl-2": "GPL-2.0-only", "gpl-2+": "GPL-2.0-or-later",
    "gpl-3": "GPL-3.0-only", "gpl-3+": "GPL-3.0-or-later", "lgpl-2+": "LGPL-2.0-or-later", "lgpl-2.1": "LGPL-2.1-only",
    "lgpl-2.1+": "LGPL-2.1-or-later", "lgpl-3": "LGPL-3.0-only", "lgpl-3+": "LGPL-3.0-or-later", "lgpl-3.0+": "LGPL-3.0-or-later",
    "mpl-2.0": "MPL-2.0", "cc0-1.0": "CC0-1.0", "unicode": "ICU",
}
# Of these sources the copyright file is prose, or says of all files together what SPDX has no name for.
OF_SOURCE = {
    "gcc-12": "GPL-3.0-or-later WITH GCC-exception-3.1", "gcc-12-cross": "GPL-3.0-or-later WITH GCC-exception-3.1",
    "glibc": "LGPL-2.1-or-later", "cross-toolchain-base": "LGPL-2.1-or-later", "linux": "GPL-2.0-only WITH Linux-syscall-note",
    "libjpeg-turbo": "IJG AND BSD-3-Clause AND Zlib", "fmtlib": "MIT", "icu": "ICU",
}


class Package:
    """An installed package: name, version, architecture, source, licence (an SPDX expression, or a LicenseRef), copyright file."""

    def __init__(self, name):
        self.id = name
        fields = run("dpkg-query", "-W", "-f", "${Package}\t${Version}\t${Architecture}\t${source:Package}\t${Homepage}\t${Maintainer}", name)
        self.name, self.version, self.arch, self.source, self.homepage, self.maintainer = fields.split("\t")
        self.copyright = pathlib.Path("/usr/share/doc", self.name, "copyright")
        self.licence, self.said = licence(self.copyright.read_text(errors="replace"), self.source)

    @property
    def purl(self):
        return f"pkg:deb/debian/{self.name.replace('+', '%2B')}@{self.version.replace(':', '%3A').replace('+', '%2B')}?arch={self.arch}&distro=debian-12"


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


def expression(named):
    """SPDX' expression of one of Debian's, such as `GPL-2+ or MIT`; None where it has no name for a part."""
    words = []
    for word in re.split(r"\s+(and|or)\s+|\s*,\s*", named):
        if word in ("and", "or"):
            words.append(word.upper())
        elif word:
            if word.lower() not in SPDX:
                return None
            words.append(SPDX[word.lower()])
    return " ".join(words)


def licence(text, source):
    """The expression, and the words of the copyright file where it is a LicenseRef of this source's."""
    if source in OF_SOURCE:
        return OF_SOURCE[source], None
    named = stanza_licence(text)
    found = [expression(each) for each in named]
    if named and all(found):
        return found[0] if len(found) == 1 else " AND ".join(f"({each})" if " " in each else each for each in found), None
    said = "; ".join(named) if named else re.sub(r"\s+", " ", text.strip())[:400]
    return "LicenseRef-Debian-" + re.sub(r"[^A-Za-z0-9.-]", "-", source), said


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
