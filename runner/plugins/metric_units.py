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
        ConfigError: if a module cannot be imported, has no UNITS or no `evaluate`, or names a metric of another family.
    """
    modules = METRICS.added()
    for module in modules:
        if not (isinstance(getattr(module, "UNITS", None), Mapping) and callable(getattr(module, "evaluate", None))):
            name = module.__name__
            raise ConfigError(
                f"metric {name.rpartition('.')[2]}: module {name} needs UNITS, a unit for each name, and evaluate"
            )
    if problems := _taken_names(modules):
        raise ConfigError(problems)
    return modules


def owner_of(name: str) -> ModuleType | None:
    """Return the family that measures a metric, by the longest known metric that its name contains; None if unknown."""
    owners = {known: family for family in families() for known in family.UNITS}
    return owners.get(_base(name, owners))


def _taken_names(modules: list[ModuleType]) -> list[str]:
    """Return messages about names of user-supplied metrics that are, or contain, a metric of another family."""
    everyone, problems = [*METRICS.built_in(), *modules], []
    for module in modules:
        others = {known: family for family in everyone if family is not module for known in family.UNITS}
        for name in module.UNITS:
            taken = _base(name, others)
            if taken in others:
                means = "is a metric" if taken == name else f"contains '{taken}', a metric"
                problems.append(
                    f"metric {name}: in UNITS of {module.__name__}, it {means} of {others[taken].__name__}; rename it"
                )
    return problems


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
