"""What of others the operators' page has in it (services/cloud-gateway/web): versions and licences from its lock file."""
import json
import urllib.parse

from documents import Part

# The page's own packages, with what of theirs runs in the browser; the rest of the lock file builds and tests.
BUNDLED = ["svelte", "clsx", "uplot", "@xyflow/svelte", "@xyflow/system", "@svelte-put/shortcut", "d3-color", "d3-dispatch", "d3-drag", "d3-ease",
           "d3-interpolate", "d3-selection", "d3-timer", "d3-transition", "d3-zoom"]


def parts(lock_file):
    with open(lock_file, encoding="utf-8") as file:
        locked = json.load(file)["packages"]
    found = []
    for name in BUNDLED:
        row = locked[f"node_modules/{name}"]
        purl = f"pkg:npm/{urllib.parse.quote(name, safe='/')}@{row['version']}"
        found.append(Part(f"npm-{name}", name, row["version"], row["license"], purl, "compiled in"))
    return found
