"""Bundled baselines, one for each published experiment and preset."""

from pathlib import Path
from typing import TYPE_CHECKING

from runner.base.errors import RunnerError, nearest
from runner.base.paths import studies_dir
from runner.config.compose.options import described_files
from runner.store.references.reference import Reference, load_reference

if TYPE_CHECKING:
    from runner.store import Run

_FOLDER = "references"


def shipped_references() -> list[str]:
    """Return their names, such as "thesis/figure_3_5.as_reported", sorted."""
    return list(described_references())


def described_references() -> dict[str, str]:
    """Return their names, sorted, each with the first line of its comment."""
    return {
        f"{folder.parent.name}/{name}": description
        for folder in sorted(studies_dir().glob(f"*/{_FOLDER}"))
        for name, description in described_files(folder).items()
    }


def find_shipped(run: "Run") -> Reference:
    """Return the baseline for the experiment and preset that a run was composed from.

    Raises:
        RunnerError: if there is none; says where those there are stand.
    """
    choices = run.provenance.get("choices", {})
    name = f"{choices.get('experiment')}.{choices.get('preset')}"
    known = shipped_references()
    if name not in known:
        what = f"'{name}'{nearest(name, known)}" if choices.get("experiment") else "a run without an experiment"
        raise RunnerError(
            f"{run.folder}: no baseline comes with the runner for {what}; give one by --baseline FILE, which "
            f"--save-baseline FILE makes of a sweep; `runner list baselines` prints the {len(known)} that come with it"
        )
    return load_reference(reference_path(name), name)


def reference_path(name: str) -> Path:
    """Return the file of a baseline, such as "thesis/figure_3_5.full_equations", whether it is there or not."""
    study, _, file = name.partition("/")
    return studies_dir() / study / _FOLDER / f"{file}.yaml"
