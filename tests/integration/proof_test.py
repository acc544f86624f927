"""A node's log of proof, read by a third party that has only the fleet's public key."""
import json
import secrets
import shutil
import time
import unittest
import support
from sealer import TARGET, WAIT, Case


class Log(Case):
    """The target's record of cat's messages, shown to a third party: a folder with the log, and fleet.json."""

    def kept(self):
        """cat sends 10 messages and seals them, sends 3 more, and is gone without a Goodbye."""
        client = self.joined()
        for number in range(9):
            client.say("greeting", f"promise {number}".encode())
        client.seal()
        for number in range(2):
            client.say("greeting", f"last word {number}".encode())
        client.answer_to(self.ask_router(client))
        link = client.link
        client.close()
        self.watch.wait_logged("open_end 3 messages of cat from sequence 12 on are authenticated, not provable", 60)
        folder = self.fleet.root / f"third-{secrets.token_hex(4)}"
        folder.mkdir()
        source = self.fleet.dir(TARGET) / "log" / "proof"
        end = time.monotonic() + WAIT
        while True:  # it is on the disk a tenth of a second later
            shutil.copytree(source, folder / "proof", dirs_exist_ok=True)
            self.fleet_json = folder / "fleet.json"
            shutil.copy(self.fleet.authority_dir() / "fleet.json", self.fleet_json)
            rows = [row for row in self.proof(folder / "proof")[1]["messages"] if row["link"] == str(link)]
            if len(rows) == 13:
                return folder / "proof", rows
            self.assertLess(time.monotonic(), end, f"{len(rows)} rows of link {link}")

    def proof(self, *words, fleet=None):
        done = self.fleet.trb("proof", *words, "--fleet", fleet or self.fleet_json, "--json", check=False)
        return done.returncode, json.loads(done.stdout)

    def test_what_is_proven_by_whom_and_which_tail_is_not(self):
        folder, rows = self.kept()
        status, report = self.proof(folder)
        self.assertEqual((status, report["faults"]), (0, []))
        self.assertEqual([row["state"] for row in rows], ["proven"] * 10 + ["authenticated"] * 3)
        self.assertEqual({row["by"] for row in rows}, {"cat"})
        self.assertEqual(bytes.fromhex(rows[1]["data_hex"]), b"promise 0")
        tails = [row for row in report["tails"] if row["link"] == rows[0]["link"]]
        self.assertEqual([(row["by"], row["first"], row["messages"]) for row in tails], [("cat", 12, 3)])
        nodes = {row["by"]: row for row in report["nodes"]}
        self.assertGreater(nodes["bee"]["proven"], 0)
        self.assertEqual(nodes["cat"]["broken"], 0)
        text = self.fleet.trb("proof", folder, "--fleet", self.fleet_json).stdout
        self.assertIn(f"Authenticated only: 3 messages of cat, link {rows[0]['link']} from sequence 12 on", text)

    def test_it_is_for_its_owner_alone(self):
        folder = self.fleet.dir(TARGET) / "log" / "proof"
        self.assertEqual(folder.stat().st_mode & 0o777, 0o700)
        self.fleet.wait("there is a log", lambda: list(folder.iterdir()), WAIT)
        self.assertEqual({path.stat().st_mode & 0o777 for path in folder.iterdir()}, {0o600})

    def test_one_byte_changed(self):
        """It names file, record and byte; the messages of that range are broken, those of the others are not."""
        folder, rows = self.kept()
        path = next(path for path in sorted(folder.iterdir()) if b"promise 4" in path.read_bytes())
        good = path.read_bytes()
        at = good.rindex(b"promise 4")
        path.write_bytes(good[:at] + b"P" + good[at + 1:])
        status, report = self.proof(folder)
        self.assertEqual(status, 1)
        changed = [row for row in report["messages"] if row["link"] == rows[0]["link"]]
        self.assertEqual([row["state"] for row in changed], ["broken"] * 10 + ["authenticated"] * 3)
        damaged, seal = report["faults"]
        self.assertEqual((damaged["file"], damaged["record"]), (str(path), rows[5]["record"]))
        self.assertTrue(damaged["offset"] < at < damaged["offset"] + 200)
        self.assertIn("its bytes are not those that were written", damaged["what"])
        self.assertIn("the seal of cat over records", seal["what"])
        self.assertIn("wrong_hash", seal["what"])
        text = self.fleet.trb("proof", folder, "--fleet", self.fleet_json, check=False).stdout
        self.assertIn(f"FAULT {path}, record {damaged['record']} at byte {damaged['offset']}: damaged", text)

    def test_a_file_that_was_cut_off_a_wrong_file_and_another_fleet_s_key(self):
        folder, _ = self.kept()
        path = sorted(folder.iterdir())[-1]
        with self.subTest("cut off"):
            cut = folder.parent / "cut.log"
            cut.write_bytes(path.read_bytes()[:-5])
            status, report = self.proof(cut)
            self.assertEqual((status, len(report["faults"])), (1, 1))
            self.assertIn("cut off: ", report["faults"][0]["what"])
            self.assertGreater(report["faults"][0]["offset"], 0)
        with self.subTest("no log"):
            wrong = folder.parent / "wrong.log"
            wrong.write_text("{}")
            status, report = self.proof(wrong)
            self.assertEqual(status, 1)
            self.assertIn("no proof log", report["faults"][0]["what"])
        with self.subTest("not there"):
            done = self.fleet.trb("proof", folder / "absent.log", "--fleet", self.fleet_json, check=False)
            self.assertEqual(done.returncode, 1)
            self.assertIn("absent.log", done.stderr)
        with self.subTest("no key"):
            done = self.fleet.trb("proof", folder, check=False)
            self.assertEqual(done.returncode, 1)
            self.assertIn("--fleet", done.stderr)
        with self.subTest("another fleet"):
            key = json.loads(self.fleet_json.read_text())
            key["authority_key"] = secrets.token_hex(32)
            other = folder.parent / "other" / "fleet.json"
            other.parent.mkdir()
            other.write_text(json.dumps(key))
            status, report = self.proof(folder, fleet=other)
            self.assertEqual((status, {row["state"] for row in report["messages"]}), (1, set()))
            self.assertTrue(report["faults"])


if __name__ == "__main__":
    support.main()
