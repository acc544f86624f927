"""What a working copy may hold beside the source (keys and passphrases of demonstration fleets among it) never goes to
the builder of the images."""
import pathlib
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]


def rows(name):
    return {line.strip().strip("/") for line in (ROOT / name).read_text().splitlines() if line.strip()}


class Context(unittest.TestCase):
    def test_every_place_that_git_ignores_is_left_out_of_the_images_context(self):
        places = {line.strip("/") for line in (ROOT / ".gitignore").read_text().splitlines() if line.startswith("/")}
        self.assertIn("deploy/compose/one", places)
        self.assertEqual(places - rows("deploy/compose/Dockerfile.dockerignore"), set())


if __name__ == "__main__":
    unittest.main()
