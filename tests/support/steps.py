"""A story told in steps: each says what is so after it, and the first that fails ends the story."""
import time


class Steps:
    """A decorator that collects the steps in their order; a step's docstring is its line."""

    def __init__(self):
        self.all = []

    def __call__(self, step):
        self.all.append(step)
        return step

    def play(self, story, faults, on_fault=lambda story: None):
        """The status to exit with. `faults`: the exceptions by which a step fails; `on_fault` prints what helps to find why."""
        for each in self.all:
            began = time.monotonic()
            try:
                each(story)
            except faults as fault:
                print(f"FAILED {time.monotonic() - began:6.1f} s  {each.__doc__}\n  {fault}", flush=True)
                on_fault(story)
                return 1
            print(f"ok     {time.monotonic() - began:6.1f} s  {each.__doc__}", flush=True)
        print("\n".join(story.figures) + f"\nall {len(self.all)} steps are good")
        return 0
