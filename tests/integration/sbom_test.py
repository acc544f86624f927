"""The lists of what a package is made of (deploy/sbom), made from this build's own programs and judged by what they are."""
import json
import os
import shutil
import subprocess
import unittest

import support
import sbom_check
import skips

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
        self.assertEqual(parts["@xyflow/svelte"]["licenses"], [{"license": {"id": "MIT"}}])

    def test_the_same_build_gives_the_same_bytes(self):
        self.list_parts(self.tree / "again")
        for name in ("sbom.spdx.json", "sbom.cyclonedx.json"):
            self.assertEqual((self.tree / "lists" / name).read_bytes(), (self.tree / "again" / name).read_bytes())


if __name__ == "__main__":
    support.main()
