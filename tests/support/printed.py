"""Printed lines of a command, for tests that are not about caveats: aborted runs of tests have some."""


def without_caveats(text):
    """Return a string without its lines on caveats."""
    return "".join(line for line in text.splitlines(keepends=True) if "caveat" not in line)


def without_results(text):
    """Return the lines of a run on standard error without those of every good run, with or without PyBullet."""
    missing = "runner: PyBullet is not installed"
    lines = (line for line in text.splitlines(keepends=True) if not line.startswith(("  ", missing)))
    return "".join(line for line in lines if " repetition" not in line.partition(" in ")[0])
