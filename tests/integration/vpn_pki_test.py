"""The keys of a tenant's OpenVPN (deploy/vpn/openvpn/pki): a command that is killed half way can be repeated, and who was
revoked is in the list then. openssl is real; of openvpn only the common key is made, which stands in here."""
import os
import shutil
import signal
import subprocess
import unittest

import support
import skips

PKI = support.REPO / "deploy" / "vpn" / "openvpn" / "pki"
OPENVPN = """#!/bin/sh
echo "a common key" >"$3"
"""
# Dies with the script that called it: after the command that has this word in it, or within, its file begun and empty.
OPENSSL = """#!/bin/sh
case "$*" in *"$KILL"*) killed=yes ;; *) killed=no ;; esac
if [ $killed$KILL_WHEN = yeswithin ]; then
  while [ "$1" != -out ]; do shift; done
  : >"$2"
  kill -KILL 0
fi
@OPENSSL@ "$@"
done=$?
[ $killed$KILL_WHEN != yesafter ] || kill -KILL 0
exit $done
"""


class Pki(unittest.TestCase):
    def setUp(self):
        openssl = shutil.which("openssl")
        if openssl is None:
            skips.leave("there is no openssl")
        folder = support.temporary_folder(self)
        self.dir = folder / "hall-vpn"
        self.programs = folder / "programs"
        self.programs.mkdir()
        for name, text in ("openvpn", OPENVPN), ("openssl", OPENSSL.replace("@OPENSSL@", openssl)):
            (self.programs / name).write_text(text)
            (self.programs / name).chmod(0o755)
        self.pki("init", "north")
        self.pki("client", "ant")

    def run_pki(self, *words, kill="-none-", when="after"):
        env = dict(os.environ, PATH=f"{self.programs}:{os.environ['PATH']}", KILL=kill, KILL_WHEN=when)
        # A group of its own: it is what is killed.
        return subprocess.run([PKI, self.dir, *words], env=env, capture_output=True, text=True, start_new_session=True, timeout=60)

    def pki(self, *words):
        done = self.run_pki(*words)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout

    def killed(self, *words, kill, when="after"):
        self.assertEqual(self.run_pki(*words, kill=kill, when=when).returncode, -signal.SIGKILL)

    def refused(self, *words):
        done = self.run_pki(*words)
        self.assertEqual(done.returncode, 1, done.stdout)
        return done.stderr

    def serial(self, name):
        said = subprocess.run(["openssl", "x509", "-in", self.dir / f"{name}.crt", "-noout", "-serial"], capture_output=True, text=True, check=True)
        return said.stdout.strip().partition("=")[2]

    def listed(self):
        said = subprocess.run(["openssl", "crl", "-in", self.dir / "crl.pem", "-noout", "-text"], capture_output=True, text=True, check=True)
        return [line.split()[-1] for line in said.stdout.splitlines() if "Serial Number" in line]

    def files(self, name):
        return sorted(path.name for path in self.dir.glob(f"{name}.*"))

    def test_a_revocation_that_was_killed_is_repeated(self):
        serial = self.serial("ant")
        for kill, when in ("-revoke", "after"), ("-gencrl", "within"), ("-gencrl", "after"):
            with self.subTest(kill, when=when):
                self.killed("revoke", "ant", kill=kill, when=when)
                self.assertEqual(self.listed(), [], "the list is the old one, and whole")
        self.pki("revoke", "ant")
        self.assertEqual((self.listed(), self.files("ant")), ([serial], []))
        self.pki("client", "ant")
        self.assertNotEqual(self.serial("ant"), serial)

    def test_what_an_earlier_version_revoked_and_did_not_list_is_listed(self):
        serial = self.serial("ant")
        self.killed("revoke", "ant", kill="-revoke")
        for name in "ant.crt", "ant.key":
            (self.dir / name).unlink()
        self.pki("revoke", "ant")
        self.assertEqual(self.listed(), [serial])
        self.assertIn("bee has no certificate here", self.refused("revoke", "bee"))

    def test_an_empty_certificate_is_none_and_its_name_can_be_revoked(self):
        serial = self.serial("ant")
        (self.dir / "ant.crt").write_text("")
        self.assertIn("has no certificate here", self.refused("profile", "ant", "vpn.example.org"))
        self.pki("revoke", "ant")
        self.assertEqual(self.listed(), [serial])
        (self.dir / "bee.crt").write_text("")
        self.pki("client", "bee")
        self.assertIn("bee has a certificate already", self.refused("client", "bee"))

    def test_one_that_the_book_does_not_have_is_revoked_too(self):
        """An earlier version wrote the certificate first, and was killed."""
        book = (self.dir / "index.txt").read_text()
        self.pki("client", "bee")
        (self.dir / "index.txt").write_text(book)
        serial = self.serial("bee")
        self.pki("revoke", "bee")
        self.assertEqual(self.listed(), [serial])

    def test_what_is_no_certificate_is_put_away_by_a_revocation(self):
        (self.dir / "bee.crt").write_text("-----BEGIN CERT")
        self.assertIn("revoke bee first", self.refused("client", "bee"))
        self.pki("revoke", "bee")
        self.pki("client", "bee")

    def test_one_that_was_killed_while_it_signed_is_repeated_and_both_are_revoked(self):
        for when in "within", "after":
            self.killed("client", "bee", kill="-extensions client", when=when)
            self.assertNotIn("bee.crt", self.files("bee"))
        self.assertIn("has no certificate here", self.refused("profile", "bee", "vpn.example.org"))
        self.pki("client", "bee")
        serial = self.serial("bee")
        self.pki("revoke", "bee")
        self.assertEqual(len(self.listed()), 2)
        self.assertIn(serial, self.listed())
        self.assertEqual(self.files("bee"), [])

    def test_a_server_that_was_signed_and_not_noted_is_noted_by_a_repeat(self):
        self.pki("server", "cloud")
        (self.dir / "server").unlink()
        self.assertIn("ant has a certificate already", self.refused("server", "ant"))
        self.pki("server", "cloud")
        self.assertIn("verify-x509-name cloud", self.pki("profile", "ant", "vpn.example.org"))
        self.assertIn("cloud has a certificate already", self.refused("server", "cloud"))

    def test_the_list_may_be_read_by_the_server_which_has_no_rights(self):
        self.pki("revoke", "ant")
        self.assertEqual((self.dir / "crl.pem").stat().st_mode & 0o777, 0o644)
        self.assertEqual((self.dir / "ca.key").stat().st_mode & 0o777, 0o600)


if __name__ == "__main__":
    support.main()
