"""Judges an installed package's lists of parts (deploy/sbom) by what its programs really are, as readelf and ldd tell it."""
import json
import pathlib
import re
import subprocess

# What is nowhere but in headers, and in every package that has a program of ours.
IN_EVERY_PROGRAM = {"libstdc++-12-dev", "libc6-dev"}


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


def spdx_faults(document, linked):
    for key, value in (("spdxVersion", "SPDX-2.3"), ("dataLicense", "CC0-1.0"), ("SPDXID", "SPDXRef-DOCUMENT")):
        if document.get(key) != value:
            yield f"SPDX: {key} is {document.get(key)!r}"
    if not re.fullmatch(r"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\dZ", document["creationInfo"]["created"]) or not document["creationInfo"]["creators"]:
        yield "SPDX: creationInfo"
    ids = [package["SPDXID"] for package in document["packages"]]
    if len(set(ids)) != len(ids):
        yield "SPDX: an id is there twice"
    extracted = {row["licenseId"] for row in document.get("hasExtractedLicensingInfos", []) if row["extractedText"]}
    for package in document["packages"]:
        where = f"SPDX: {package['name']}"
        if not re.fullmatch(r"SPDXRef-[A-Za-z0-9.-]+", package["SPDXID"]):
            yield f"{where}: its id {package['SPDXID']}"
        if not package["versionInfo"] or package["licenseDeclared"] in ("", "NOASSERTION", "NONE"):
            yield f"{where}: version or licence is missing"
        for reference in re.findall(r"LicenseRef-\S+", package["licenseDeclared"]):
            if reference not in extracted:
                yield f"{where}: {reference} is explained nowhere"
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
    parts = document["components"]
    refs = [part["bom-ref"] for part in [document["metadata"]["component"], *parts]]
    if len(set(refs)) != len(refs):
        yield "CycloneDX: a bom-ref is there twice"
    for part in parts:
        if part["type"] != "library" or not part["version"] or not part["licenses"] or not part["purl"].startswith("pkg:"):
            yield f"CycloneDX: {part['name']}: type, version, licence or purl"
        for licence in part["licenses"]:
            if not (licence.get("expression") or licence["license"].get("id") or licence["license"].get("name")):
                yield f"CycloneDX: {part['name']}: an empty licence"
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
