"""Unit of a dotted key, from the model of its group."""

import contextlib
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from runner.base.errors import ConfigError
from runner.calibration.procedures import CALIBRATIONS
from runner.config.compose.documentation import Units, find_units
from runner.config.groups import GROUPS
from runner.config.plugin_groups import PLUGGED
from runner.config.robot import OneArmConfig, StageConfig
from runner.config.settings import RunSettings
from runner.plugins.registry import Kinds
from runner.schema.model import StrictModel


def key_unit(key: str) -> str:
    """Return the unit of a dotted key, such as "rad/s" of "controller.natural_frequency".

    It is "1" for a key without unit, of which nothing is known, or that counts otherwise in each kind of its group.
    """
    return units_of_key(key).first or "1"


def units_of_key(key: str) -> Units:
    """Return the units of a dotted key; none where it counts otherwise in each kind of its group."""
    group, *rest = key.split(".")
    found = {find_units(model, rest or [group]) for model in _models(group if rest else "", rest)} - {None}
    return found.pop() or Units() if len(found) == 1 else Units()


def units_at(resolved: Mapping[str, Any], place: Sequence[str | int]) -> Units:
    """Return the units of a place in a config, as the kinds chosen there have it: keys, and numbers in lists."""
    group, *rest = [str(part) for part in place]
    options = resolved.get(group)
    kind = options.get("kind") if rest and isinstance(options, Mapping) else None
    for model in _models(group if rest else "", rest, kind):
        return find_units(model, rest or [group]) or Units()
    return Units()


def _models(group: str, rest: Sequence[str], chosen: str | None = None) -> Iterator[type[StrictModel]]:
    """Yield the models of a group, or of the one kind of it that is chosen."""
    known = CALIBRATIONS if group == CALIBRATIONS.group else GROUPS.get(group)
    if not group:
        yield RunSettings
    elif rest[0] == "stages":
        yield from (StageConfig, OneArmConfig)
    elif isinstance(known, Kinds):
        for kind in known.names() if chosen is None else [chosen]:
            with contextlib.suppress(ConfigError):  # a part of the user's that cannot be imported
                yield known.config_model(kind)
    elif group in PLUGGED and chosen is not None:
        with contextlib.suppress(ConfigError):
            yield PLUGGED[group].config_model(chosen)
    elif known is not None:
        yield known
