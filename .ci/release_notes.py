"""`make release-notes`: print what CHANGELOG.md says of the version of pyproject.toml, or of what is not released."""

import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent


def notes(changelog: str, version: str) -> str:
    """Return the section of a version, without its head; that of Unreleased where the version has none.

    Args:
        changelog: Text in the format of Keep a Changelog.
        version: Such as "1.2.0".

    Raises:
        ValueError: if there is neither section, or it is empty.
    """
    sections = dict(re.findall(r"^## \[(.+?)\].*?\n(.*?)(?=^## \[|\Z)", changelog, re.M | re.S))
    text = sections.get(version, sections.get("Unreleased", "")).strip()
    if not text:
        raise ValueError(f"CHANGELOG.md has no section [{version}] or [Unreleased] with a text")
    return text


def main() -> int:
    """Print them; exit code 2 where there are none."""
    (version,) = re.findall(r'^version = "(.+)"$', (ROOT / "pyproject.toml").read_text(encoding="utf-8"), re.M)
    try:
        print(notes((ROOT / "CHANGELOG.md").read_text(encoding="utf-8"), version))
    except ValueError as error:
        print(f"make release-notes: {error}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
