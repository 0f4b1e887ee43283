"""Explicit list of runs and calibrations, as the plan of a study."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from runner.config.compose.compose import Composed
from runner.config.compose.composition_errors import COMPOSITION_ERRORS, explain
from runner.config.compose.options import groups
from runner.config.compose.overrides import force
from runner.sweeps.loading import Loader
from runner.sweeps.plan import Block
from runner.sweeps.swept import SweptKey, parse_sweep
from runner.sweeps.template import Template


@dataclass(frozen=True)
class Item:
    """One of them.

    Attributes:
        overrides: The overrides that make it.
        root: Name of the file in conf/ that its config hangs on: "config" of a run, "calibrate" of a calibration.
    """

    overrides: tuple[str, ...]
    root: str = "config"


class Listed:
    """Runs and calibrations by name. See Plan.

    Those that choose the same options and give the same keys values are composed together, as the cells of a grid are.

    Args:
        items: What to make, by name.
        shared: Overrides of all runs, such as "outputs=FOLDER" and "sweep.trace=all"; a calibration takes the first of
            these two alone.
        loader: Composes the configs.

    Raises:
        ConfigError: for what is no override.
    """

    def __init__(self, items: Mapping[str, Item], shared: Sequence[str], loader: Loader) -> None:
        self._loader = loader
        self._items = tuple(items.values())
        self._keys = [self._parse(item, shared) for item in self._items]
        self._shared: dict[tuple[object, ...], list[int]] = {}
        self._places: list[int] = []  # of each cell among those composed with it
        for cell, keys in enumerate(self._keys):
            together = self._shared.setdefault(self._group(cell, keys), [])
            self._places.append(len(together))
            together.append(cell)
        self._templates: dict[tuple[object, ...], Template] = {}

    def __len__(self) -> int:
        return len(self._items)

    def overrides(self, cell: int) -> tuple[str, ...]:
        """Return the overrides of a cell; see Plan."""
        return self._items[cell].overrides

    def axes(self) -> None:
        """Return None: they are no grid; see Plan."""

    def blocks(self) -> Iterator[Block]:
        """Yield the cells one by one; see Plan."""
        return (Block(range(cell, cell + 1)) for cell in range(len(self)))

    def alike(self, cells: Sequence[int]) -> Iterator[tuple[Sequence[int], Sequence[Composed]]]:
        """Yield the cells one by one, with their configs; see Plan."""
        return (([cell], [self.composed(cell)]) for cell in cells)

    def composed(self, cell: int) -> Composed:
        """Return the composed config of a cell; see Plan."""
        group = self._group(cell, self._keys[cell])
        if group not in self._templates:
            self._templates[group] = self._compose(group)
        template, place = self._templates[group], self._places[cell]
        values = [key for key in self._keys[cell] if not key.option]
        resolved = template.resolve([place] * len(values))
        item = self._items[cell]
        return Composed(resolved, item.overrides, template.choices, self._loader.config_dirs, item.root)

    def _parse(self, item: Item, shared: Sequence[str]) -> list[SweptKey]:
        taken = [text for text in shared if item.root == "config" or text.startswith("outputs=")]
        known = groups(self._loader.config_dirs)
        return parse_sweep(force([*item.overrides, *taken]), known, self._loader.hydra)

    def _group(self, cell: int, keys: Sequence[SweptKey]) -> tuple[object, ...]:
        """Return what cells have in common that are composed together: root, options, and which keys have values."""
        options = tuple(key.overrides[0] for key in keys if key.option)
        return self._items[cell].root, options, tuple(key.name for key in keys if not key.option)

    def _compose(self, group: tuple[object, ...]) -> Template:
        cells = self._shared[group]
        first = self._keys[cells[0]]
        together = [[key for key in self._keys[cell] if not key.option] for cell in cells]
        keys = [
            replace(same[0], overrides=[key.overrides[0] for key in same], values=[key.values[0] for key in same])
            for same in zip(*together, strict=True)
        ]
        options = [key.overrides[0] for key in first if key.option]
        try:
            config = self._loader.load(options, self._items[cells[0]].root)
            return Template(config, config.hydra.runtime.choices, self._loader.config_dirs, keys)
        except COMPOSITION_ERRORS as error:
            raise explain(error, self._loader.config_dirs) from None
