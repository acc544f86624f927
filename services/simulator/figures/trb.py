"""The command line, asked for JSON."""
import json
import subprocess
import sys


class Trb:
    def __init__(self, programs):
        self.program = programs / "trb"

    def ask(self, *words):
        done = subprocess.run([self.program, *map(str, words), "--json"], capture_output=True, text=True, check=False)
        if done.returncode:
            sys.exit(f"figures: {' '.join(map(str, words))}: {done.stdout}{done.stderr}")
        return json.loads(done.stdout)
