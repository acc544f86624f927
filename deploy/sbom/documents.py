"""The two formats of a list of parts: SPDX 2.3 and CycloneDX 1.5, as JSON. The same parts give the same bytes."""
import datetime
import hashlib
import json
import re
import typing
import urllib.parse
import uuid

SITE = "https://packages.talkrobots.org"
TOOL = "deploy/sbom"


class Supplier(typing.NamedTuple):
    """Who a part is from."""
    name: str
    address: typing.Optional[str]
    is_organization: bool


class Words(typing.NamedTuple):
    """A licence that SPDX has no name for."""
    name: str
    text: str


class Part:
    """A part: its key, name, version, licence (`said`: where SPDX has no name for it), purl, supplier; how it is there (`dynamic`,
    `compiled in`), the keys of what it needs; an `application` or a `library`."""

    def __init__(self, key, name, version, licence, purl, how, supplier, needs=(), said=None, libraries=(), kind="library"):
        self.key, self.name, self.version, self.licence, self.purl, self.how = key, name, version, licence, purl, how
        self.needs, self.said, self.supplier, self.libraries, self.kind = sorted(needs), said, supplier, sorted(libraries), kind


def purl(kind, namespace, name, version, **qualifiers):
    """A package URL in its canonical form: all is percent-encoded but letters, digits, `.-_~` and the colon."""
    place = "/".join(urllib.parse.quote(each, safe=":") for each in (namespace, name) if each)
    told = "&".join(f"{key}={urllib.parse.quote(value, safe=':')}" for key, value in sorted(qualifiers.items()))
    return f"pkg:{kind}/{place}@{urllib.parse.quote(version, safe=':')}" + (f"?{told}" if told else "")


def time_of(epoch):
    return datetime.datetime.fromtimestamp(int(epoch), datetime.timezone.utc).strftime("%Y-%m-%dT%H:%M:%SZ")


def text(document):
    return json.dumps(document, indent=1, ensure_ascii=False) + "\n"


def digest(document):
    """Of all that it says, its time too: no two documents have one name."""
    return hashlib.sha256(text(document).encode()).hexdigest()


# ---- SPDX

def spdx_id(key):
    return "SPDXRef-" + re.sub(r"[^A-Za-z0-9.-]", "-", key.replace("+", "-plus"))


def spdx_actor(supplier):
    """Round brackets are the address's alone."""
    name = supplier.name.replace("(", "[").replace(")", "]")
    return f"{'Organization' if supplier.is_organization else 'Person'}: {name}" + (f" ({supplier.address})" if supplier.address else "")


def spdx_package(part):
    package = {
        "SPDXID": spdx_id(part.key), "name": part.name, "versionInfo": part.version, "downloadLocation": "NOASSERTION",
        "filesAnalyzed": False, "licenseConcluded": part.licence, "licenseDeclared": part.licence, "copyrightText": "NOASSERTION",
        "supplier": spdx_actor(part.supplier),
        "externalRefs": [{"referenceCategory": "PACKAGE-MANAGER", "referenceType": "purl", "referenceLocator": part.purl}],
        "primaryPackagePurpose": part.kind.upper(),
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
        "documentNamespace": None,
        "creationInfo": {"created": time_of(epoch), "creators": [spdx_actor(main.supplier), f"Tool: {TOOL}-{main.version}"]},
        "packages": [spdx_package(part) for part in [main, *parts]],
        "relationships": spdx_relations(main, parts),
    }
    if extracted:
        document["hasExtractedLicensingInfos"] = [{"licenseId": key, "name": said.name, "extractedText": said.text} for key, said in sorted(extracted.items())]
    document["documentNamespace"] = f"{SITE}/spdx/{main.key}-{digest(document)[:32]}"
    return text(document)


# ---- CycloneDX

def cyclonedx_supplier(supplier):
    return {"name": supplier.name, **({"contact": [{"email": supplier.address}]} if supplier.address else {})}


def cyclonedx_component(part):
    if part.said:
        licences = [{"license": {"name": part.said.name, "text": {"content": part.said.text}}}]
    elif re.fullmatch(r"[A-Za-z0-9.+-]+", part.licence):
        licences = [{"license": {"id": part.licence}}]
    else:
        licences = [{"expression": part.licence}]
    component = {"type": part.kind, "bom-ref": part.purl, "supplier": cyclonedx_supplier(part.supplier), "name": part.name, "version": part.version,
                 "licenses": licences, "purl": part.purl}
    told = [{"name": "talkrobots:linked", "value": part.how}] + [{"name": "talkrobots:library", "value": each} for each in part.libraries]
    return {**component, "properties": told} if part.how else component


def cyclonedx(main, parts, epoch):
    refs = {part.key: part.purl for part in [main, *parts]}
    document = {
        "bomFormat": "CycloneDX", "specVersion": "1.5", "version": 1,
        "serialNumber": None,
        "metadata": {"timestamp": time_of(epoch), "tools": {"components": [{"type": "application", "name": TOOL, "version": main.version}]},
                     "authors": [{"name": main.supplier.name, **({"email": main.supplier.address} if main.supplier.address else {})}],
                     "component": cyclonedx_component(main), "supplier": cyclonedx_supplier(main.supplier)},
        "components": [cyclonedx_component(part) for part in parts],
        "dependencies": [{"ref": refs[part.key], "dependsOn": [refs[key] for key in part.needs]} for part in [main, *parts]],
    }
    document["serialNumber"] = f"urn:uuid:{uuid.uuid5(uuid.NAMESPACE_URL, f'{SITE}/cyclonedx/{digest(document)}')}"
    return text(document)
