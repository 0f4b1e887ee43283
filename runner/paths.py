"""Where the configs, robots and templates are: in the checkout beside the package, or inside an installed wheel."""

from functools import cache
from pathlib import Path

_PACKAGE = Path(__file__).resolve().parent


@cache
def _root() -> Path:
    checkout = _PACKAGE.parent
    return checkout if (checkout / "conf" / "config.yaml").is_file() else _PACKAGE / "_data"


def package_dir() -> Path:
    """Return the folder of this package's source."""
    return _PACKAGE


def conf_dir() -> Path:
    """Return the folder of the Hydra groups."""
    return _root() / "conf"


def ships(path: Path) -> bool:
    """Tell whether a file is one of our configs, which may set what no file from outside may."""
    return conf_dir() in path.resolve().parents


def robots_dir() -> Path:
    """Return the folder of our own URDFs."""
    return _root() / "robots"


def works_dir() -> Path:
    """Return the folder of the published works, a folder each."""
    return _PACKAGE / "works"


def works_with(file: str) -> list[str]:
    """Return the names of our works that have a file, such as "claims.yaml", sorted."""
    return sorted(folder.name for folder in works_dir().iterdir() if (folder / file).is_file())


def examples_dir() -> Path:
    """Return the folder of the examples, which `runner example` copies."""
    return _root() / "examples"


def example_work_dir() -> Path:
    """Return the folder of the work that `runner work new` starts from."""
    return examples_dir() / "own_paper"


def templates_dir() -> Path:
    """Return the folder of the report templates."""
    return _root() / "reports" / "templates"
