"""Judges an installed package's lists of parts (deploy/sbom) by what its programs really are, as readelf and ldd tell it."""
import json
import pathlib
import re
import subprocess
import urllib.parse

# What is nowhere but in headers, and in every package that has a program of ours.
IN_EVERY_PROGRAM = {"libstdc++-12-dev", "libc6-dev"}
# Who made or supplies something, in SPDX: what is in round brackets is an address.
ACTOR = r"(?:Person|Organization): [^\s()][^()]*(?: \([^\s()@]+@[^\s()@]+\))?"
LICENCE = r"\(?[A-Za-z0-9][A-Za-z0-9.+-]*\)?"


def needed(program):
    said = subprocess.run(["readelf", "-d", str(program)], capture_output=True, text=True, check=True).stdout
    return set(re.findall(r"\(NEEDED\)\s+Shared library: \[(.+?)\]", said))


def programs(tree):
    found = []
    for path in pathlib.Path(tree).rglob("*"):
        if path.is_file() and not path.is_symlink():
            with open(path, "rb") as file:
                if file.read(4) == b"\x7fELF":
                    found.append(path)
    return found


def is_expression(licence):
    """Names with an operator between any two, in capitals."""
    return re.fullmatch(rf"{LICENCE}(?: (?:AND|OR|WITH) {LICENCE})*", licence) and licence.count("(") == licence.count(")")


def is_purl(text):
    """A package URL whose parts have a percent sign where one is needed, and nowhere else."""
    parts = re.split("[/@?&=]", text.removeprefix("pkg:"))
    return (re.fullmatch(r"pkg:(?:deb/[a-z]+|npm)(?:/[^/@?]+){1,2}@[^/@?]+(?:\?[a-z]+=[^?&=]+(?:&[a-z]+=[^?&=]+)*)?", text)
            and all(urllib.parse.quote(urllib.parse.unquote(part), safe=":") == part for part in parts))


def spdx_faults(document, linked):
    for key, value in (("spdxVersion", "SPDX-2.3"), ("dataLicense", "CC0-1.0"), ("SPDXID", "SPDXRef-DOCUMENT")):
        if document.get(key) != value:
            yield f"SPDX: {key} is {document.get(key)!r}"
    if not re.fullmatch(r"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\dZ", document["creationInfo"]["created"]) or not document["documentNamespace"].startswith("https://"):
        yield "SPDX: creationInfo or namespace"
    creators = document["creationInfo"]["creators"]
    if not all(any(re.fullmatch(form, who) for who in creators) for form in (ACTOR, r"Tool: \S+-\d\S*")):
        yield f"SPDX: {creators} are not who made it, and with which version of what"
    ids = [package["SPDXID"] for package in document["packages"]]
    if len(set(ids)) != len(ids):
        yield "SPDX: an id is there twice"
    extracted = {row["licenseId"] for row in document.get("hasExtractedLicensingInfos", []) if len(row["extractedText"]) > 60 and row["name"]}
    for package in document["packages"]:
        where = f"SPDX: {package['name']}"
        if not re.fullmatch(r"SPDXRef-[A-Za-z0-9.-]+", package["SPDXID"]):
            yield f"{where}: its id {package['SPDXID']}"
        if not package["versionInfo"] or package["licenseDeclared"] in ("", "NOASSERTION", "NONE"):
            yield f"{where}: version or licence is missing"
        if not is_expression(package["licenseDeclared"]):
            yield f"{where}: its licence {package['licenseDeclared']}"
        for reference in re.findall(r"LicenseRef-\S+", package["licenseDeclared"]):
            if reference not in extracted:
                yield f"{where}: {reference} is explained nowhere"
        if not re.fullmatch(ACTOR, package["supplier"]):
            yield f"{where}: its supplier {package['supplier']}"
        if not all(is_purl(row["referenceLocator"]) for row in package["externalRefs"]):
            yield f"{where}: its purl {package['externalRefs']}"
    for lost in sorted(set(ids) - {row["relatedSpdxElement"] for row in document["relationships"]}):
        yield f"SPDX: {lost} is related to nothing"
    for row in document["relationships"]:
        if {row["spdxElementId"], row["relatedSpdxElement"]} - set(ids) - {"SPDXRef-DOCUMENT"}:
            yield f"SPDX: a relationship with a stranger: {row}"
    named = {name for package in document["packages"] for name in package.get("comment", "").removeprefix("linked to: ").split(", ")}
    for name in sorted(linked - named):
        yield f"SPDX: {name} is linked and not listed"


def cyclonedx_faults(document, linked):
    if (document.get("bomFormat"), document.get("specVersion"), document.get("version")) != ("CycloneDX", "1.5", 1):
        yield "CycloneDX: head"
    if not re.fullmatch(r"urn:uuid:[0-9a-f]{8}(-[0-9a-f]{4}){3}-[0-9a-f]{12}", document["serialNumber"]):
        yield f"CycloneDX: serialNumber {document['serialNumber']}"
    if not document["metadata"]["authors"] or not all(tool["version"] for tool in document["metadata"]["tools"]["components"]):
        yield "CycloneDX: who made it, and with which version of what"
    parts = document["components"]
    refs = [part["bom-ref"] for part in [document["metadata"]["component"], *parts]]
    if len(set(refs)) != len(refs):
        yield "CycloneDX: a bom-ref is there twice"
    for part in parts:
        if part["type"] != "library" or not part["version"] or not part["licenses"] or not is_purl(part["purl"]) or not part["supplier"]["name"]:
            yield f"CycloneDX: {part['name']}: type, version, licence, purl or supplier"
        for licence in part["licenses"]:
            name = licence.get("expression") or licence["license"].get("id") or licence["license"].get("name")
            if not name or len(name) > 200:
                yield f"CycloneDX: {part['name']}: a licence without name, or with a text for one"
    if sorted(row["ref"] for row in document["dependencies"]) != sorted(refs):
        yield "CycloneDX: a part has not its one row of dependencies"
    for row in document["dependencies"]:
        if {row["ref"], *row["dependsOn"]} - set(refs):
            yield f"CycloneDX: a dependency with a stranger: {row['ref']}"
    named = {told["value"] for part in parts for told in part["properties"] if told["name"] == "talkrobots:library"}
    for name in sorted(linked - named):
        yield f"CycloneDX: {name} is linked and not listed"


def faults(tree, folder, compiled_in=()):
    """What is wrong with the lists in the folder, for the files below tree; compiled_in: packages that must be there, too."""
    linked = set().union(*(needed(program) for program in programs(tree)))
    spdx, cyclonedx = (json.loads((pathlib.Path(folder) / f"sbom.{name}.json").read_text()) for name in ("spdx", "cyclonedx"))
    yield from spdx_faults(spdx, linked)
    yield from cyclonedx_faults(cyclonedx, linked)
    names = {package["name"] for package in spdx["packages"]}
    if names != {part["name"] for part in [cyclonedx["metadata"]["component"], *cyclonedx["components"]]}:
        yield "the two lists have different parts"
    plain = {re.sub(r"-(amd64|arm64)-cross$", "", name) for name in names}  # the compiler's own libraries, where another machine compiles
    for name in sorted((set(compiled_in) | (IN_EVERY_PROGRAM if linked else set())) - plain):
        yield f"{name} is compiled in and not listed"
    for name in compiled_in:
        if not (pathlib.Path(folder) / "compiled-in" / f"{name}.copyright.gz").is_file() and not name.startswith("@"):
            yield f"{name} has no copyright file in compiled-in"
