"""What of others the operators' page has in it (services/cloud-gateway/web): versions and licences from its lock file."""
import json

from documents import Part, Supplier, purl

# What of others runs in the browser, as the page itself says (src/views/about/licences.ts); the rest of the lock file builds and tests. Who
# they are from, which the lock file does not say: the author in package.json, or who has the copyright in the licence.
BUNDLED = {
    "svelte": Supplier("Svelte Contributors", None, True), "uplot": Supplier("Leon Sorokin", None, False),
    "esm-env": Supplier("Ben McCann", None, False), "clsx": Supplier("Luke Edwards", None, False),
}


def parts(lock_file):
    with open(lock_file, encoding="utf-8") as file:
        locked = json.load(file)["packages"]
    found = []
    for name, supplier in BUNDLED.items():
        row = locked[f"node_modules/{name}"]
        scope, _, last = name.rpartition("/")
        found.append(Part(f"npm-{name}", name, row["version"], row["license"], purl("npm", scope, last, row["version"]), "compiled in", supplier))
    return found
