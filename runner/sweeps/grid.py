"""Every combination of the values of some keys: the plan of `runner -m`."""

import math
from collections.abc import Sequence
from pathlib import Path

from runner.config.compose import Composed
from runner.config.composition_errors import COMPOSITION_ERRORS, explain
from runner.config.options import groups
from runner.config.overrides import force
from runner.errors import ConfigError
from runner.sweeps.loading import ConfigSource, Loader
from runner.sweeps.swept import is_simulated, parse_sweep
from runner.sweeps.template import Template


class Grid:
    """Every combination of the values of a sweep's keys; the last key changes fastest. See Plan.

    Args:
        arguments: Overrides, such as "robot=macro,mini" and "noise.position=1e-4,1e-3".
        source: Composes the configs.

    Raises:
        ConfigError: for what is no override, and for a key that is swept over no value.
    """

    def __init__(self, arguments: Sequence[str], source: ConfigSource) -> None:
        self._source = source
        self._keys = parse_sweep(force(arguments), groups(source.config_dirs), source.hydra)
        self._templates: dict[tuple[int, ...], Template | ConfigError] = {}

    def __len__(self) -> int:
        return math.prod(len(key.values) for key in self._keys)

    def overrides(self, cell: int) -> tuple[str, ...]:
        """Return the overrides of a cell; see Plan."""
        pairs = zip(self._keys, self._numbers(cell), strict=True)
        return tuple(key.overrides[number].removeprefix("++") for key, number in pairs if is_simulated(key.name))

    def composed(self, cell: int) -> Composed:
        """Return the composed config of a cell; see Plan."""
        numbers = self._numbers(cell)
        pairs = list(zip(self._keys, numbers, strict=True))
        template = self._template(tuple(number for key, number in pairs if key.option))
        resolved = template.resolve([number for key, number in pairs if not key.option])
        return Composed(resolved, self.overrides(cell), template.choices, self._source.config_dirs)

    def _numbers(self, cell: int) -> list[int]:
        """Return the number of each key's value in a cell."""
        numbers = []
        for key in reversed(self._keys):
            cell, number = divmod(cell, len(key.values))
            numbers.append(number)
        return numbers[::-1]

    def _template(self, numbers: tuple[int, ...]) -> Template:
        if numbers not in self._templates:
            self._templates[numbers] = self._compose(numbers)
        template = self._templates[numbers]
        if isinstance(template, ConfigError):
            raise template
        return template

    def _compose(self, numbers: Sequence[int]) -> Template | ConfigError:
        options = [key for key in self._keys if key.option]
        texts = [key.overrides[number] for key, number in zip(options, numbers, strict=True)]
        try:
            config, own = self._source.load(texts), self._source.config_dirs
            return Template(config, config.hydra.runtime.choices, own, [key for key in self._keys if not key.option])
        except COMPOSITION_ERRORS as error:
            return explain(error, self._source.config_dirs)
        except ConfigError as error:
            return error


def plan_sweep(overrides: Sequence[str], config_dirs: Sequence[Path] = ()) -> Grid:
    """Plan what `runner -m OVERRIDES` makes, from Python; see Grid."""
    return Grid(overrides, Loader(config_dirs))
