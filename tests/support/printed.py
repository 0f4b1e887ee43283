"""What a command prints, for tests that are not about caveats: runs aborted for a test spring some."""


def without_caveats(text):
    """Return a string without its lines on caveats."""
    return "".join(line for line in text.splitlines(keepends=True) if "caveat" not in line)


def without_results(text):
    """Return what a run prints on standard error without what every good one has: where it is, and its metrics."""
    lines = text.splitlines(keepends=True)
    return "".join(
        line for line in lines if not line.startswith("  ") and " repetition" not in line.partition(" in ")[0]
    )
