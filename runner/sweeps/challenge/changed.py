"""Plan of runs that differ from the asked case in few keys, composed together."""

from collections.abc import Iterator, Sequence

from runner.base.dotted_keys import get, split_override
from runner.config.compose.composer import Composer
from runner.config.compose.files import groups
from runner.store.axes import override_value
from runner.sweeps.challenge.case import Case
from runner.sweeps.plan import Item, Listed

Cell = tuple[int, tuple[str, ...]]
"""Side, and the overrides that it gets."""


class Changed(Listed):
    """Runs of both sides with further overrides.

    Keys that other runs change are set to their values in the asked case, so that all runs of a side have the same
    keys: these are composed from one template, which is much faster than one composition for each run.

    Args:
        case: The asked case.
        cells: The runs.
        keys: Keys that some run of the challenge changes.
        shared: Overrides of all runs.
        loader: Composer of the configs.
    """

    def __init__(
        self, case: Case, cells: Sequence[Cell], keys: Sequence[str], shared: Sequence[str], loader: Composer
    ) -> None:
        sides = case.sides
        self._own = [(*sides[side].overrides, *more) for side, more in cells]
        filled = [list(_filling(case, side, keys)) for side in range(len(sides))]
        items = {
            str(place): Item((*sides[side].overrides, *filled[side], *more)) for place, (side, more) in enumerate(cells)
        }
        super().__init__(items, shared, loader)

    def overrides(self, cell: int) -> tuple[str, ...]:
        """Return the overrides of a cell, without those of the asked case; see Plan."""
        return self._own[cell]


def changed_keys(texts: Sequence[str], config_groups: Sequence[str] = ()) -> list[str]:
    """Return the keys of overrides, each once, without groups, whose options are composed one by one."""
    named = config_groups or groups()
    return [key for key in dict.fromkeys(split_override(text)[0] for text in texts) if key not in named]


def _filling(case: Case, side: int, keys: Sequence[str]) -> Iterator[str]:
    resolved = case.configs[side].resolved
    for key in keys:
        parent, _, name = key.rpartition(".")
        within = get(resolved, parent) if parent else resolved
        if isinstance(within, dict) and name in within:
            yield f"{key}={override_value(within[name])}"
