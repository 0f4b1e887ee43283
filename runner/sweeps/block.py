"""Blocks of cells whose configs differ only in the seed."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from runner.config.compose.compose import Composed


@dataclass(frozen=True)
class Block:
    """Cells whose configs differ in nothing but the seed.

    Attributes:
        cells: The cells.
        seeds: Seed of each; None of a single cell.
    """

    cells: range
    seeds: Sequence[int] | None = None


@dataclass(frozen=True)
class Alike(Sequence[Composed]):
    """Configs that differ in nothing but the seed, made when asked for: to another process goes one of them.

    Attributes:
        first: One of them.
        seeds: Seed of each.
        texts: The override that gives each its seed.
        place: Place of that among the overrides.
    """

    first: Composed
    seeds: Sequence[int]
    texts: Sequence[str]
    place: int

    def __len__(self) -> int:
        return len(self.seeds)

    def __getitem__(self, number: Any) -> Any:
        first, place = self.first, self.place
        overrides = (*first.overrides[:place], self.texts[number], *first.overrides[place + 1 :])
        resolved = {**first.resolved, "seed": self.seeds[number]}
        return Composed(resolved, overrides, first.choices, first.config_dirs, first.root)


@dataclass(frozen=True)
class Part:
    """Runs whose configs differ in nothing but the seed, or a single run or calibration.

    Attributes:
        names: Hash of each.
        configs: Composed config of each.
    """

    names: Sequence[str]
    configs: Sequence[Composed]
