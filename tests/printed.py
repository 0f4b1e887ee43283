"""What a command prints, for tests that are not about caveats: runs cut short for a test spring some."""


def without_caveats(text):
    """Return a text without its lines on caveats."""
    return "".join(line for line in text.splitlines(keepends=True) if "caveat" not in line)
