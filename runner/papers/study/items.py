"""Execution of the missing runs and calibrations of a study by the sweep engine."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from runner.config.compose.composer import Composer
from runner.config.compose.files import outputs_override
from runner.store import RunOutcome
from runner.sweeps.plan import Item, Listed
from runner.sweeps.run import Engine, run_sweep


@dataclass(frozen=True)
class Way:
    """Settings of the execution of runs and calibrations.

    Attributes:
        outputs: Folder in which they are stored.
        overrides: Overrides of the engine: keys of hydra.sweeper, sweep and limits.
        command: The command that executes and continues them.
        config_dirs: Config folders.
    """

    outputs: Path
    overrides: Sequence[str] = ()
    command: str = "runner reproduce"
    config_dirs: Sequence[Path] = ()


@dataclass(frozen=True)
class MadeItem:
    """One of them.

    Attributes:
        place: Name of its folder.
        end: How it ended; None where it was not begun.
    """

    place: str
    end: RunOutcome | None

    @property
    def missing(self) -> str:
        """Why it has no result to read; empty if it has one."""
        if self.end is None:
            return "not begun"
        return self.end.failure if self.end.cut_short else ""


def make_items(items: Mapping[str, Item], way: Way, trace: Literal["all", "never"] = "all") -> dict[str, MadeItem]:
    """Make what is not stored yet; return all by name.

    Args:
        items: What to make, by name.
        way: How.
        trace: Whether runs keep their traces.

    Raises:
        ConfigError: if one cannot be made, or all would cost too much; nothing has been started then.
        StoreError: if the disk does not take them.
        RunnerError: if the Dask scheduler does not answer.
    """
    loader = Composer(way.config_dirs)
    return make_listed(listed(items, way, loader, trace), items, way, loader)


def make_listed(plan: Listed, names: Iterable[str], way: Way, loader: Composer) -> dict[str, MadeItem]:
    """Make the runs and calibrations of a plan that are not stored yet, by their names; see `make_items`."""
    sweeper = loader.sweeper([text for text in way.overrides if text.startswith("hydra.")])
    ended = run_sweep(plan, Engine(sweeper.workers, sweeper.address), way.command, accept_cut_short=False)
    places = zip(names, ended.names, strict=True)
    return {name: MadeItem(place, ended.ends.get(place)) for name, place in places}


def listed(items: Mapping[str, Item], way: Way, loader: Composer, trace: str = "all") -> Listed:
    """Return the plan of some runs and calibrations."""
    shared = [text for text in way.overrides if not text.startswith("hydra.")]
    return Listed(items, [*shared, f"sweep.trace={trace}", outputs_override(way.outputs)], loader)
