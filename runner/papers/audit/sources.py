"""Sources of printed equations: study folders with their entries and Python modules.

A folder has `equations/*.yaml`. If it needs its own derivations, it also has `equations/derivations/*.py` and
`equations/consequences/*.py`. Built-in studies are folders of `runner/papers/studies/`, known by name. The path names
any other folder.
"""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from runner.base.errors import RunnerError, nearest
from runner.base.paths import studies_dir, studies_with
from runner.plugins.folder_code import folder_module

_FOLDER = "equations"


@dataclass(frozen=True)
class Source:
    """The folder of a study.

    Attributes:
        folder: The folder.
        code: Whether Python of it may run; without it, its derivations are those of a model.
    """

    folder: Path
    code: bool = False

    @property
    def name(self) -> str:
        """Name of the study, that of its folder."""
        return self.folder.resolve().name

    @property
    def equations(self) -> Path:
        """Folder of its entries."""
        return self.folder / _FOLDER


Where = str | Path | Source
"""A built-in study by name; a folder by its path, whose Python does not run; or a Source, which may allow it."""


def sources() -> tuple[str, ...]:
    """Return the names of the built-in studies whose equations are audited."""
    return tuple(studies_with(f"{_FOLDER}/inventory.yaml"))


def source_of(where: Where) -> Source:
    """Return the folder that is meant.

    Raises:
        RunnerError: If no study has this name, or the folder has no equations.
    """
    if isinstance(where, str) and where not in sources():
        raise RunnerError(
            f"no study '{where}'{nearest(where, sources())}; studies: {', '.join(sources())}, or a folder"
        )
    given = Source(studies_dir() / where, code=True) if isinstance(where, str) else where
    source = given if isinstance(given, Source) else Source(given)
    if not source.equations.is_dir():
        raise RunnerError(f"{source.folder}: no folder 'equations' in it")
    return source


def derivation_of(where: Where, name: str) -> Any:
    """Return the object that "module.name" stands for, of a module of the study's `equations/derivations`."""
    return _resolve(source_of(where), "derivations", name)


def consequence_of(where: Where, name: str) -> Any:
    """Return the function that "module.name" stands for, of a module of the study's `equations/consequences`."""
    return _resolve(source_of(where), "consequences", name)


def _resolve(source: Source, kind: str, name: str) -> Any:
    if not source.code:
        raise RunnerError(
            f"'{name}' is Python of {source.folder}, which may not run; allowed: a derivation from a model"
        )
    stem, _, attribute = name.partition(".")
    known = sorted(path.stem for path in (source.equations / kind).glob("[!_]*.py"))
    if stem not in known:
        raise RunnerError(f"'{name}': no module{nearest(stem, known)}; modules: {', '.join(known) or 'none'}")
    module = folder_module(source.folder, f"{_FOLDER}.{kind}.{stem}")
    if not hasattr(module, attribute):
        raise RunnerError(f"'{name}': {stem}.py has no '{attribute}'{nearest(attribute, vars(module))}")
    return getattr(module, attribute)
