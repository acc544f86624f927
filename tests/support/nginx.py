"""An nginx of a test's own: one process, all of whose files are in a folder."""
import pathlib
import subprocess

import trb_fleet

PROGRAM = "/usr/sbin/nginx"
CONFIG = """
daemon off;
master_process off;
pid {folder}/pid;
error_log {folder}/error.log;
events {{ worker_connections 200; }}
http {{
  access_log off;
  client_body_temp_path {folder}/body; proxy_temp_path {folder}/proxy; fastcgi_temp_path {folder}/fastcgi;
  uwsgi_temp_path {folder}/uwsgi; scgi_temp_path {folder}/scgi;
  {http}
}}
"""


def start(folder, http):
    """`http` is what it serves, in nginx's own words. Ends with its parent; what it prints is in nginx.log."""
    folder = pathlib.Path(folder)
    config = folder / "nginx.conf"
    config.write_text(CONFIG.format(folder=folder, http=http))
    command = [PROGRAM, "-e", folder / "error.log", "-p", folder, "-c", config]
    with open(folder / "nginx.log", "wb") as log:
        return subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=log, stderr=log, preexec_fn=trb_fleet.end_with_parent)
