"""Parts of a grid: `sweep.part=K/N` simulates the cells K, K + N, K + 2N, ... of one sweep, which all parts share."""

from collections.abc import Hashable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from math import lcm
from pathlib import Path
from typing import Any, cast

import numpy as np

from runner import store
from runner.assembly.arms import build_robot, read_outline
from runner.base import progress
from runner.base.errors import ConfigError
from runner.base.memory import Memory
from runner.config.composed import Composed
from runner.config.groups import read_groups
from runner.config.limits import split_part
from runner.config.parsing import Problems, require
from runner.config.settings import RunSettings
from runner.store.axes import Axes
from runner.store.names import Names, Texts
from runner.store.sweep import Sweep, without_keys
from runner.sweeps.check import Checked
from runner.sweeps.plan import Alike, Grid, Plan, SeedBlock
from runner.sweeps.swept import SweptKey

_MEMORY = Memory(4096)


class GridPart(Plan):
    """Cells of a grid that have the same remainder; cell i is the cell `number + i * parts` of the grid.

    Args:
        whole: The grid.
        number: Number of the part, from 0.
        parts: Number of parts.

    Attributes:
        cells: Numbers of the cells in the grid.
        name: The part as K/N.

    Raises:
        ConfigError: if there are more parts than cells.
    """

    def __init__(self, whole: Grid, number: int, parts: int) -> None:
        super().__init__(whole._source)
        if parts > len(whole):
            raise ConfigError(f"sweep.part: must have at most as many parts as cells, {len(whole)}; found {parts}")
        self._whole, self.cells, self.name = whole, range(number, len(whole), parts), f"{number}/{parts}"

    @property
    def whole(self) -> Grid:
        """The grid."""
        return self._whole

    def __len__(self) -> int:
        return len(self.cells)

    def overrides(self, cell: int) -> tuple[str, ...]:
        """Return the overrides of a cell; see Plan."""
        return self.whole.overrides(self.cells[cell])

    def composed(self, cell: int) -> Composed:
        """Return the composed config of a cell; see Plan."""
        return self._without_part(self.whole.composed(self.cells[cell]))

    def blocks(self) -> Iterator[SeedBlock]:
        """Yield the cells in blocks; see Plan."""
        for block in self.whole.blocks():
            own = _common(block.cells, self.cells)
            if own:
                places = range(self.cells.index(own[0]), self.cells.index(own[-1]) + 1, own.step // self.cells.step)
                first, step = block.cells.index(own[0]), own.step // block.cells.step
                yield SeedBlock(places, None if block.seeds is None else block.seeds[first::step])

    def alike(self, cells: Sequence[int]) -> Iterator[tuple[Sequence[int], Sequence[Composed]]]:
        """Yield groups of the given cells whose configs differ only in the seed, with their configs; see Plan."""
        for own, configs in self.whole.alike([self.cells[cell] for cell in cells]):
            if isinstance(configs, Alike):
                configs = replace(configs, first=self._without_part(configs.first))
            else:
                configs = [self._without_part(composed) for composed in configs]
            yield [self.cells.index(cell) for cell in own], configs

    def _without_part(self, composed: Composed) -> Composed:
        """Return a config as in the whole sweep, because it is stored with its run."""
        settings = _MEMORY.recall(_settings_of_whole, composed.resolved["sweep"])
        return replace(composed, resolved={**composed.resolved, "sweep": settings})

    def _locate(self, cell: int) -> tuple[Hashable, Sequence[int]]:
        return self.whole._locate(self.cells[cell])

    def _parts(self, group: Hashable) -> tuple[Sequence[str], Sequence[SweptKey], str]:
        return self.whole._parts(group)


def own_part(plan: Plan) -> Plan:
    """Return the part of a grid that its configs name in sweep.part; the plan itself if they name none.

    Raises:
        ConfigError: if there are more parts than cells.
    """
    if not isinstance(plan, Grid):
        return plan
    try:
        text = cast(Mapping[str, Any], plan.composed(0).resolved["sweep"])["part"]
        part = None if text is None else split_part(str(text))
    except (ConfigError, ValueError):  # the check of the plan reports it
        return plan
    return plan if part is None else GridPart(plan, *part)


def share_sweep(part: GridPart, checked: Checked, command: str) -> Path:
    """Return the folder of the sweep of a whole grid; the first of its parts names all runs and writes it.

    Args:
        part: The part.
        checked: Result of the check of the part.
        command: The command of the part, which is stored without sweep.part.

    Raises:
        ConfigError: if a cell of another part has a config that cannot be read.
        StoreError: if the sweep cannot be written.
    """
    axes = part.whole.axes()
    # Configs and code may have changed since a sweep with these axes was stored; the own names would differ.
    for path in sorted(checked.outputs.glob("sweeps/*/runs.bin")):
        with suppress(store.DamagedError):
            sweep = store.open_sweep(path.parent)
            if _has(sweep, axes, part.cells, checked.names):
                return path.parent
    names = _name_all(part.whole)
    return store.write_grid(
        checked.outputs, axes, names, without_keys(command, ("sweep.part",)), checked.first.spec.metrics
    )


def _settings_of_whole(settings: Mapping[str, object]) -> Mapping[str, object]:
    return {**settings, "part": None}


def _has(sweep: Sweep, axes: Axes, cells: range, names: Names) -> bool:
    """Return True if a stored sweep has these axes, and these names in some cells."""
    if not (isinstance(sweep.overrides, Axes) and sweep.overrides.content() == axes.content()):
        return False
    return [sweep.hashes[cell] for cell in cells] == list(names)


def _name_all(plan: Grid) -> Names:
    """Return the hash of each run of a grid; the configs are not checked beyond their groups."""
    names = np.empty(len(plan), dtype="S24")
    progress.begin("naming", len(plan), "cells")
    for block in plan.blocks():
        try:
            found = _names(plan.composed(block.cells[0]), block)
        except ConfigError as error:
            cell = " ".join(plan.overrides(block.cells[0]))
            raise ConfigError([f"[{cell}] {problem}" for problem in error.problems], "  nothing was started") from None
        names[block.cells.start : block.cells.stop : block.cells.step] = found
        progress.step(len(block.cells))
    return Names(names)


def _names(composed: Composed, block: SeedBlock) -> Texts:
    problems = Problems(_MEMORY)
    groups = read_groups(composed.resolved, problems)
    outline = problems.recall(read_outline, groups.get("robot"), composed.config_dirs)
    problems.report()
    settings, sensor = cast(RunSettings, groups["settings"]), groups.get("wrist_sensor")
    arm = problems.recall(build_robot, outline, settings.gravity, sensor)
    problems.report()
    seeds = block.seeds if block.seeds is not None else [cast(int, composed.resolved["seed"])]
    return store.run_hashes(composed.resolved, require(arm).urdf, seeds).texts


def _common(one: range, other: range) -> range:
    """Return the numbers that two ascending ranges share."""
    step = lcm(one.step, other.step)
    first = next((number for number in one[: step // one.step] if number in other), None)
    return range(0) if first is None else range(first, min(one[-1], other[-1]) + 1, step)
