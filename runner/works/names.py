"""Which works there are, told without importing one."""

from runner.paths import works_dir


def work_names() -> tuple[str, ...]:
    """Return the names of the works' folders, sorted."""
    return tuple(sorted(path.parent.name for path in works_dir().glob("*/work.py")))
