"""Hosts out of network namespaces: whether this machine lets a test make them."""
import os
import shutil
import subprocess


def why_not(*programs):
    """What is missing here; None: hosts can be built. `programs`: what the test runs besides iproute2's and nftables'."""
    if os.geteuid() != 0:
        return "needs root, for network namespaces; run it with sudo"
    for program in ("ip", "nft", "unshare"):
        if shutil.which(program) is None:
            return f"needs the program {program}: apt-get install iproute2 nftables"
    for program in programs:
        if shutil.which(program) is None:
            return f"needs the program {program}"
    if subprocess.run(["unshare", "--net", "--mount", "true"], capture_output=True).returncode != 0:
        return "may not make network namespaces here: a container needs CAP_SYS_ADMIN"
    return None
