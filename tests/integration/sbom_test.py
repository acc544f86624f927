"""The lists of what a package is made of (deploy/sbom), made from this build's own programs and judged by what they are."""
import json
import os
import re
import shutil
import subprocess
import sys
import unittest

import support
import sbom_check
import skips

sys.path.insert(0, str(support.REPO / "deploy" / "sbom"))

import debian  # noqa: E402
import documents  # noqa: E402
import page  # noqa: E402

PROGRAMS = ("trb-router", "trb-sensor-bus")
COMPILED_IN = ("libmsgpack-cxx-dev", "cppzmq-dev")


class Sbom(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        for program in ("ninja", "readelf", "dpkg-query"):
            if shutil.which(program) is None:
                skips.leave(f"there is no {program}")
        cls.tree = support.temporary_folder(cls)
        for name in PROGRAMS:
            shutil.copy(support.PROGRAMS / name, cls.tree / name)
        cls.list_parts(cls.tree / "lists")

    @classmethod
    def list_parts(cls, output):
        triplet = subprocess.run(["gcc", "-print-multiarch"], capture_output=True, text=True, check=True).stdout.strip()
        done = subprocess.run(["/usr/bin/python3", support.REPO / "deploy/sbom/sbom.py", "talkrobots", "--tree", cls.tree, "--build", support.PROGRAMS.parent,
                               "--version", "1.2.3", "--arch", "amd64", "--triplet", triplet, "--output", output,
                               "--page", support.REPO / "services/cloud-gateway/web/package-lock.json"],
                              capture_output=True, text=True, timeout=120, env={**os.environ, "SOURCE_DATE_EPOCH": "1764000000", "PYTHONDONTWRITEBYTECODE": "1"})
        if done.returncode:
            raise RuntimeError(done.stderr)

    def read(self, name):
        return json.loads((self.tree / "lists" / f"sbom.{name}.json").read_text())

    def test_both_are_whole_and_name_every_library_with_its_licence(self):
        self.assertEqual(list(sbom_check.faults(self.tree, self.tree / "lists", COMPILED_IN)), [])

    def test_a_library_that_is_left_out_is_found(self):
        text = (self.tree / "lists" / "sbom.spdx.json").read_text()
        document = json.loads(text)
        document["packages"] = [package for package in document["packages"] if package["name"] != "libzmq5"]
        found = list(sbom_check.spdx_faults(document, {"libzmq.so.5"}))
        self.assertIn("SPDX: libzmq.so.5 is linked and not listed", found)
        self.assertTrue(any("stranger" in fault for fault in found), found)

    def test_what_is_loaded_is_told_apart_from_what_is_compiled_in(self):
        rows = {(row["relationshipType"], row["relatedSpdxElement"]) for row in self.read("spdx")["relationships"]
                if row["spdxElementId"] == "SPDXRef-deb-talkrobots"}
        kinds = {kind for kind, other in rows if "libzmq5" in other}
        self.assertEqual(kinds, {"DYNAMIC_LINK"})
        self.assertIn("STATIC_LINK", {kind for kind, other in rows if "libmsgpack-cxx-dev" in other})

    def test_the_page_s_parts_come_from_its_lock_file(self):
        parts = {part["name"]: part for part in self.read("cyclonedx")["components"]}
        locked = json.loads((support.REPO / "services/cloud-gateway/web/package-lock.json").read_text())["packages"]
        self.assertEqual(parts["uplot"]["version"], locked["node_modules/uplot"]["version"])
        self.assertEqual(parts["uplot"]["licenses"], [{"license": {"id": "MIT"}}])

    def test_the_page_s_parts_are_those_that_the_page_itself_names(self):
        """Its own test holds that list against what it imports."""
        web = support.REPO / "services/cloud-gateway/web"
        rows = re.findall(r"\{ name: '([^']+)', version: '([^']+)', licence: '([^']+)' \}", (web / "src/views/about/licences.ts").read_text())
        self.assertIn("svelte", [name for name, _, _ in rows])
        self.assertEqual({(part.name, part.version, part.licence) for part in page.parts(web / "package-lock.json")}, set(rows))

    def test_a_licence_is_an_expression_only_where_it_is_certain(self):
        for said, meant in (("Expat", "MIT"), ("GPL-2+ or LGPL-3+", "GPL-2.0-or-later OR LGPL-3.0-or-later"), ("PostgreSQL", "PostgreSQL")):
            self.assertEqual(debian.licence(f"Files: *\nLicense: {said}\n", "some"), (meant, None))
        for said in ("Expat, ISC", "Expat or ISC, and Zlib", "Beer"):
            self.assertEqual(debian.licence(f"Files: *\nLicense: {said}\n", "some")[0], "LicenseRef-Debian-some", said)

    def test_a_licence_without_a_name_of_spdx_comes_with_its_whole_text(self):
        long = "Nobody may. " * 100
        _, said = debian.licence(f"Files: *\nCopyright: me\nLicense: Beer\n\nFiles: b\nLicense: ISC\n\nLicense: Beer\n {long}\n .\n Cheers.\n", "some")
        self.assertEqual(said, documents.Words("Beer", f"{long.strip()}\n\nCheers."))
        part = documents.Part("deb-a", "a", "1", "LicenseRef-Debian-some", "pkg:deb/a/a@1", None, documents.Supplier("A", None, True), said=said)
        row, = json.loads(documents.cyclonedx(part, [], 0))["metadata"]["component"]["licenses"]
        self.assertEqual(row["license"], {"name": "Beer", "text": {"content": said.text}})
        self.assertEqual(debian.licence(long, "some"), ("LicenseRef-Debian-some", documents.Words("LicenseRef-Debian-some", long.strip())))

    def test_a_person_is_told_apart_from_a_team_and_brackets_are_an_address_s_alone(self):
        for field, told in (("Debian GCC Maintainers <gcc@lists.debian.org>", "Organization: Debian GCC Maintainers (gcc@lists.debian.org)"),
                            ("Jane (JD) Doe <jd@debian.org>", "Person: Jane [JD] Doe (jd@debian.org)")):
            self.assertEqual(documents.spdx_actor(debian.supplier(field)), told)

    def test_a_purl_is_canonical(self):
        self.assertEqual(documents.purl("deb", "debian", "libx++1", "1:2.0~a+b", distro="debian-12", arch="amd64"),
                         "pkg:deb/debian/libx%2B%2B1@1:2.0~a%2Bb?arch=amd64&distro=debian-12")
        self.assertEqual(documents.purl("npm", "@a", "b", "1.0"), "pkg:npm/%40a/b@1.0")

    def test_another_time_is_another_document(self):
        part = documents.Part("deb-a", "a", "1", "MIT", "pkg:deb/a/a@1", None, documents.Supplier("A", None, True))
        for form, key in ((documents.spdx, "documentNamespace"), (documents.cyclonedx, "serialNumber")):
            self.assertEqual(len({json.loads(form(part, [], epoch))[key] for epoch in (0, 0, 1)}), 2)

    def test_the_same_build_gives_the_same_bytes(self):
        self.list_parts(self.tree / "again")
        for name in ("sbom.spdx.json", "sbom.cyclonedx.json"):
            self.assertEqual((self.tree / "lists" / name).read_bytes(), (self.tree / "again" / name).read_bytes())


if __name__ == "__main__":
    support.main()
