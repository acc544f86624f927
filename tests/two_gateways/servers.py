"""A PostgreSQL server and an nginx of a test's own: in temporary folders, ended with the test."""
import os
import pathlib
import pwd
import secrets
import select
import signal
import subprocess
import time

import nginx
import trb_fleet

DATABASE, USER = "hall", "trb"


def newest_postgres():
    """The folder of its programs; None: it is not installed."""
    found = sorted(pathlib.Path("/usr/lib/postgresql").glob("*/bin"), key=lambda folder: int(folder.parent.name))
    return found[-1] if found else None


class Postgres:
    """It refuses to be root's: then it is of Debian's user for it."""

    def __init__(self, folder):
        self.folder, self.programs, self.child = pathlib.Path(folder), newest_postgres(), None
        self.password = secrets.token_urlsafe(24)
        self.as_user = {}
        if os.geteuid() == 0:
            user = pwd.getpwnam("postgres")
            os.chown(self.folder, user.pw_uid, user.pw_gid)
            self.as_user = {"user": user.pw_uid, "group": user.pw_gid, "extra_groups": []}
        self.log = open(self.folder / "log", "ab")
        self.run("initdb", "-D", self.folder / "data", "-U", "keeper", "-A", "trust", "-E", "UTF8", "--locale=C", "--no-sync")
        (self.folder / "data/pg_hba.conf").write_text("local all keeper trust\nlocal all all scram-sha-256\n")
        self.start()
        self.sql(f"CREATE ROLE {USER} LOGIN PASSWORD '{self.password}'", "postgres")
        self.sql(f"CREATE DATABASE {DATABASE} OWNER {USER}", "postgres")

    @property
    def url(self):
        return f"postgresql://{USER}@/{DATABASE}?host={self.folder}"

    def run(self, program, *arguments):
        return subprocess.run([self.programs / program, *map(str, arguments)], check=True, stdout=subprocess.PIPE,
                              stderr=self.log, cwd=self.folder, text=True, timeout=60, **self.as_user).stdout

    def sql(self, text, database=DATABASE):
        return self.run("psql", "-h", self.folder, "-U", "keeper", "-d", database, "-XAtq", "-v", "ON_ERROR_STOP=1", "-c", text)

    def start(self):
        command = [self.programs / "postgres", "-D", self.folder / "data", "-k", self.folder, "-c", "listen_addresses="]
        self.child = subprocess.Popen(command, stdout=self.log, stderr=self.log, cwd=self.folder,
                                      preexec_fn=trb_fleet.end_with_parent, **self.as_user)
        deadline = time.monotonic() + 30
        while subprocess.run([self.programs / "pg_isready", "-q", "-h", self.folder], timeout=20).returncode != 0:
            if self.ends_within(0.05):  # a process of the one that was killed was still there
                return self.start()
            if time.monotonic() > deadline:
                raise TimeoutError("the server does not answer")

    def children(self):
        return [int(pid) for pid in pathlib.Path(f"/proc/{self.child.pid}/task/{self.child.pid}/children").read_text().split()]

    def ends_within(self, seconds):
        try:
            self.child.wait(seconds)
        except subprocess.TimeoutExpired:
            return False
        return True

    def kill(self):
        """With all its processes, by name: one that has not seen yet that the first is gone would answer, and commit."""
        self.child.send_signal(signal.SIGSTOP)  # it makes no more of them
        ends = {pid: os.pidfd_open(pid) for pid in self.children()}
        self.child.kill()
        for pid in ends:
            os.kill(pid, signal.SIGKILL)
        self.child.wait()
        for pid, end in ends.items():
            if not select.select([end], [], [], 60)[0]:
                raise TimeoutError(f"process {pid} of the server does not end")
            os.close(end)
        (self.folder / "data/postmaster.pid").unlink(missing_ok=True)

    def stop(self):
        if self.child and self.child.poll() is None:
            self.child.send_signal(signal.SIGQUIT)
            self.child.wait()
        self.log.close()


def openssl(*arguments):
    subprocess.run(["openssl", *map(str, arguments)], check=True, capture_output=True, timeout=30)


NEW_KEY = ("-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:P-256", "-nodes")


class Authority:
    """Who signs the certificates of the gateways and of nginx, all for "localhost"."""

    def __init__(self, folder):
        self.folder = pathlib.Path(folder)
        self.certificate = self.folder / "authority.crt"
        openssl("req", "-x509", *NEW_KEY, "-days", "2", "-subj", "/CN=The hall's authority", "-keyout",
                self.folder / "authority.key", "-out", self.certificate)

    def issue(self, certificate, key):
        request, names = self.folder / "request.pem", self.folder / "names"
        names.write_text("subjectAltName=DNS:localhost\n")
        openssl("req", "-new", *NEW_KEY, "-subj", "/CN=localhost", "-keyout", key, "-out", request)
        openssl("x509", "-req", "-in", request, "-CA", self.certificate, "-CAkey", self.folder / "authority.key",
                "-CAcreateserial", "-days", "2", "-extfile", names, "-out", certificate)
        os.chmod(key, 0o600)


SERVED = """
upstream gateways {{ {servers} }}
  map $http_upgrade $connection_upgrade {{ default upgrade; '' close; }}
  server {{
    listen 127.0.0.1:{port} ssl;
    ssl_certificate {folder}/own.crt;
    ssl_certificate_key {folder}/own.key;
    location / {{
      proxy_pass https://gateways;
      proxy_ssl_verify on;
      proxy_ssl_name localhost;
      proxy_ssl_trusted_certificate {authority};
      proxy_http_version 1.1;
      proxy_connect_timeout 1s;
      proxy_set_header Host $http_host;
      proxy_set_header Upgrade $http_upgrade;
      proxy_set_header Connection $connection_upgrade;
    }}
  }}
"""


class Nginx:
    """Each request goes to the next gateway, or to the other one if nobody answers there."""

    def __init__(self, folder, port, gateways, authority):
        self.folder = pathlib.Path(folder)
        authority.issue(self.folder / "own.crt", self.folder / "own.key")
        servers = " ".join(f"server 127.0.0.1:{gateway} max_fails=1 fail_timeout=1s;" for gateway in gateways)
        self.child = nginx.start(self.folder, SERVED.format(folder=self.folder, port=port, servers=servers,
                                                            authority=authority.certificate))

    def stop(self):
        self.child.terminate()
        self.child.wait()
