"""What a program must have against whoever finds a fault in its memory, as readelf tells it of the finished file."""
import re
import subprocess

MUST_HAVE = {
    "an address of its own at each start (PIE)": r"Type: +DYN ",
    "read-only tables of calls": r"^ +GNU_RELRO ",
    "all calls bound at the start": r"Flags:.* NOW\b",
    "a stack that is not run": r"^ +GNU_STACK .* RW +0x",
    "a guard on its stack": r"__stack_chk_fail@",
}


def faults(program):
    """What this program lacks."""
    said = subprocess.run(["readelf", "-W", "-h", "-l", "-d", "--dyn-syms", str(program)], capture_output=True, text=True, check=True).stdout
    return [what for what, shown in MUST_HAVE.items() if not re.search(shown, said, re.MULTILINE)]
