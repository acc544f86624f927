"""The images of deploy/compose/Dockerfile: built, small enough, not for root."""
import os
import pathlib
import subprocess
import tempfile
import time

from engine import DOCKER
from play import DEPLOY

REPO = DEPLOY.parents[1]
IMAGES = ("node", "cloud", "robots", "ros")
MOST_MB = 120  # of an image without ROS


def base_image(engine):
    """A registry's, or else one from Debian's archive."""
    own = "talkrobots-debian:12"
    if engine.docker("image", "inspect", own, check=False).returncode == 0:
        return own
    if engine.docker("pull", "debian:12-slim", check=False, timeout=300).returncode == 0:
        return "debian:12-slim"
    subprocess.run([DEPLOY / "make-base", own], check=True, stdout=subprocess.DEVNULL, env=engine.env())
    return own


def programs_image(engine, tree):
    """An install tree as an image, for PROGRAMS of the Dockerfile."""
    with tempfile.TemporaryDirectory() as folder:
        os.symlink(pathlib.Path(tree).resolve(), f"{folder}/out")
        tar = subprocess.Popen(["tar", "-C", folder, "--dereference", "-c", "out"], stdout=subprocess.PIPE)
        subprocess.run([DOCKER, "import", "-", "talkrobots-programs"], stdin=tar.stdout, check=True, stdout=subprocess.DEVNULL,
                       env=engine.env())
        if tar.wait() != 0:
            raise RuntimeError(f"{tree}: tar failed")
    return "talkrobots-programs"


def build_images(engine, report):
    began = time.monotonic()
    arguments = {"BASE": base_image(engine)}
    if tree := os.environ.get("TRB_PROGRAMS"):
        arguments["PROGRAMS"] = programs_image(engine, tree)
    for image in IMAGES:
        engine.build(image, arguments, REPO)
        facts = engine.inspect(f"talkrobots-{image}")
        size = facts["Size"] / 1e6
        report.notes[f"{image}_mb"] = round(size, 1)
        report.check(size <= MOST_MB or image == "ros", f"the image {image} has {size:.0f} MB, over {MOST_MB}")
        report.check(facts["Config"]["User"].split(":")[0] not in ("", "0", "root"), f"the image {image} runs as root")
    report.say("images: " + ", ".join(f"{image} {report.notes[f'{image}_mb']} MB" for image in IMAGES)
               + f", {time.monotonic() - began:.0f} s")
