"""Units of metrics, built-in and user-supplied."""

from collections.abc import Iterable, Mapping
from functools import lru_cache
from types import ModuleType

from runner.base.errors import ConfigError
from runner.plugins.registry import Kinds

METRICS = Kinds(
    "metric",
    {name: f"runner.metrics.{name}" for name in ("positioning", "tracking", "effort", "reaching", "contact")},
)
"""Families of metrics, in the order in which reports list them; all of them measure every run."""


def families() -> list[ModuleType]:
    """Return the modules of all families of metrics, the built-in ones first; see `added_families`."""
    return [*METRICS.built_in(), *added_families()]


def added_families() -> list[ModuleType]:
    """Return the modules of the user-supplied families of metrics.

    Raises:
        ConfigError: if a module cannot be imported, or has no UNITS or no `evaluate`.
    """
    modules = METRICS.added()
    for module in modules:
        if not (isinstance(getattr(module, "UNITS", None), Mapping) and callable(getattr(module, "evaluate", None))):
            name = module.__name__
            raise ConfigError(
                f"metric {name.rpartition('.')[2]}: module {name} needs UNITS, a unit for each name, and evaluate"
            )
    return modules


def units() -> dict[str, str]:
    """Return the unit of each metric by name, without the suffixes of joints and axes."""
    return {name: unit for family in families() for name, unit in family.UNITS.items()}


def units_of(names: tuple[str, ...]) -> tuple[str, ...]:
    """Return the units of metrics by names with an optional stage as prefix and joint or axis as suffix."""
    return _units_among(names, tuple(units().items()))


@lru_cache(maxsize=64)
def _units_among(names: tuple[str, ...], known: tuple[tuple[str, str], ...]) -> tuple[str, ...]:
    by_name = dict(known)
    return tuple(by_name[_base(name, by_name)] for name in names)


def unit_of(name: str) -> str | None:
    """Return the unit of a metric, or None if it is unknown; see `units_of` for the name."""
    known = units()
    return known.get(_base(name, known))


def _base(name: str, known: Iterable[str]) -> str:
    """Return the longest known metric that a name contains, or the name itself if it contains none."""
    return max((base for base in known if f"_{base}_" in f"_{name}_"), key=len, default=name)
