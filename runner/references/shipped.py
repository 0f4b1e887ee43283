"""The references that come with the package, one for each published experiment and preset."""

from pathlib import Path
from typing import TYPE_CHECKING

from runner.config.options import described_files
from runner.errors import RunnerError, nearest
from runner.references.reference import Reference, load_reference

if TYPE_CHECKING:
    from runner.store import Run

_FOLDER = Path(__file__).resolve().parent


def shipped_references() -> list[str]:
    """Return their names, such as "thesis/figure_3_5.as_reported", sorted."""
    return list(described_files(_FOLDER))


def find_shipped(run: "Run") -> Reference:
    """Return the reference for the experiment and preset that a run was composed from.

    Raises:
        RunnerError: if there is none; names those there are.
    """
    choices = run.provenance.get("choices", {})
    name = f"{choices.get('experiment')}.{choices.get('preset')}"
    known = shipped_references()
    if name not in known:
        what = f"'{name}'{nearest(name, known)}" if choices.get("experiment") else "a run without an experiment"
        raise RunnerError(
            f"{run.folder}: no reference comes with the runner for {what}; give one by --reference FILE; there are: "
            f"{', '.join(known) or 'none'}"
        )
    return load_reference(_FOLDER / f"{name}.yaml", name)
