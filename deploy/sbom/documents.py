"""The two formats of a list of parts: SPDX 2.3 and CycloneDX 1.5, as JSON. The same parts give the same bytes."""
import datetime
import hashlib
import json
import re
import uuid

SITE = "https://packages.talkrobots.org"


class Part:
    """A part: its key, name, version, licence, purl; how it is there (`dynamic`, `compiled in`), and the keys of what it needs."""

    def __init__(self, key, name, version, licence, purl, how, needs=(), said=None, supplier=None, libraries=()):
        self.key, self.name, self.version, self.licence, self.purl, self.how = key, name, version, licence, purl, how
        self.needs, self.said, self.supplier, self.libraries = sorted(needs), said, supplier, sorted(libraries)


def time_of(epoch):
    return datetime.datetime.fromtimestamp(int(epoch), datetime.timezone.utc).strftime("%Y-%m-%dT%H:%M:%SZ")


def digest(main, parts):
    told = [[part.key, part.version, part.licence, part.how, part.needs, part.libraries] for part in [main, *parts]]
    return hashlib.sha256(json.dumps(told).encode()).hexdigest()


def text(document):
    return json.dumps(document, indent=1, ensure_ascii=False) + "\n"


# ---- SPDX

def spdx_id(key):
    return "SPDXRef-" + re.sub(r"[^A-Za-z0-9.-]", "-", key.replace("+", "-plus"))


def spdx_package(part, main):
    package = {
        "SPDXID": spdx_id(part.key), "name": part.name, "versionInfo": part.version, "downloadLocation": "NOASSERTION",
        "filesAnalyzed": False, "licenseConcluded": part.licence, "licenseDeclared": part.licence, "copyrightText": "NOASSERTION",
        "supplier": f"Organization: {part.supplier or 'NOASSERTION'}" if part.supplier else "NOASSERTION",
        "externalRefs": [{"referenceCategory": "PACKAGE-MANAGER", "referenceType": "purl", "referenceLocator": part.purl}],
        "primaryPackagePurpose": "APPLICATION" if part is main else "LIBRARY",
    }
    if part.libraries:
        package["comment"] = "linked to: " + ", ".join(part.libraries)
    return package


def spdx_relations(main, parts):
    def row(one, kind, other):
        return {"spdxElementId": one, "relationshipType": kind, "relatedSpdxElement": other}
    rows = [row("SPDXRef-DOCUMENT", "DESCRIBES", spdx_id(main.key))]
    compiled_in = {part.key for part in parts if part.how == "compiled in"}
    for part in [main, *parts]:
        for key in part.needs:
            rows.append(row(spdx_id(part.key), "STATIC_LINK" if key in compiled_in else "DYNAMIC_LINK", spdx_id(key)))
    return rows


def spdx(main, parts, epoch):
    extracted = {part.licence: part.said for part in parts if part.said}
    document = {
        "spdxVersion": "SPDX-2.3", "dataLicense": "CC0-1.0", "SPDXID": "SPDXRef-DOCUMENT", "name": f"{main.name} {main.version}",
        "documentNamespace": f"{SITE}/spdx/{main.key}-{digest(main, parts)[:32]}",
        "creationInfo": {"created": time_of(epoch), "creators": ["Tool: deploy/sbom"]},
        "packages": [spdx_package(part, main) for part in [main, *parts]],
        "relationships": spdx_relations(main, parts),
    }
    if extracted:
        document["hasExtractedLicensingInfos"] = [{"licenseId": key, "extractedText": said} for key, said in sorted(extracted.items())]
    return text(document)


# ---- CycloneDX

def cyclonedx_component(part, kind):
    if part.licence.startswith("LicenseRef-"):
        licences = [{"license": {"name": part.said or part.licence}}]
    elif re.fullmatch(r"[A-Za-z0-9.+-]+", part.licence):
        licences = [{"license": {"id": part.licence}}]
    else:
        licences = [{"expression": part.licence}]
    component = {"type": kind, "bom-ref": part.purl, "name": part.name, "version": part.version, "licenses": licences, "purl": part.purl}
    if part.supplier:
        component["supplier"] = {"name": part.supplier}
    told = [{"name": "talkrobots:linked", "value": part.how}] + [{"name": "talkrobots:library", "value": each} for each in part.libraries]
    return {**component, "properties": told} if part.how else component


def cyclonedx(main, parts, epoch):
    refs = {part.key: part.purl for part in [main, *parts]}
    return text({
        "bomFormat": "CycloneDX", "specVersion": "1.5", "version": 1,
        "serialNumber": f"urn:uuid:{uuid.uuid5(uuid.NAMESPACE_URL, f'{SITE}/cyclonedx/{digest(main, parts)}')}",
        "metadata": {"timestamp": time_of(epoch), "tools": {"components": [{"type": "application", "name": "deploy/sbom"}]},
                     "component": cyclonedx_component(main, "application")},
        "components": [cyclonedx_component(part, "library") for part in parts],
        "dependencies": [{"ref": refs[part.key], "dependsOn": [refs[key] for key in part.needs]} for part in [main, *parts]],
    })
