"""List of the variations of a challenge: values of `conf/challenge/`, changed by `--vary` and `--without`."""

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path

from pydantic import ValidationError

from runner.base.bounded_yaml import CONFIG, read_yaml
from runner.base.dotted_keys import dotted, get, leaves
from runner.base.errors import ConfigError, RunnerError, unknown
from runner.base.paths import conf_dir
from runner.schema.model import StrictModel
from runner.sweeps.challenge.case import Case
from runner.sweeps.challenge.families import FAMILIES, Family, NotApplicableError, SidesChange
from runner.sweeps.challenge.question import CLASSES, LeftOutVariation, Value, Variation

GROUP = "challenge"
_STANDARD = "standard"
_TOP_LEVEL = "gravity"  # key without a dot that is a choice
_MOST = 200  # variations
_COMMA = re.compile(r",(?![^\[]*\])")  # outside of a list such as [1,2,3]

Values = Mapping[str, Sequence[Value]]


class _Table(StrictModel):
    """Values of each family, by class.

    Attributes:
        numbers: Those of the numerical choices.
        equivalent: Those of the equivalent choices.
        conditions: Those of the conditions.
        fairness: Those of changes of only one side.
    """

    numbers: dict[str, list[float | int | str]]
    equivalent: dict[str, list[float | int | str]]
    conditions: dict[str, list[float | int | str]]
    fairness: dict[str, list[float | int | str]]


def read_values(config_dirs: Sequence[Path]) -> dict[str, list[Value]]:
    """Return the values of each family, in the order of the classes.

    Raises:
        ConfigError: if the file is invalid, or a family is in another class or unknown.
    """
    folders = [*config_dirs, conf_dir()]
    path = next(file for folder in folders if (file := folder / GROUP / f"{_STANDARD}.yaml").is_file())
    try:
        table = _Table.model_validate(read_yaml(path.read_text(encoding="utf-8"), path, CONFIG))
    except (OSError, ValueError, ValidationError) as error:
        raise ConfigError(f"{path}: it is not a table of variations: {error}") from None
    found: dict[str, list[Value]] = {}
    for kind in CLASSES:
        for name, values in getattr(table, kind).items():
            _known(name, str(path))
            if FAMILIES[name][0].kind != kind:
                raise ConfigError(f"{path}: {name} is in {kind}. Allowed: in {FAMILIES[name][0].kind}.")
            found[name] = list(values)
    return found


def change_values(values: Values, vary: Sequence[str], without: Sequence[str]) -> dict[str, list[Value]]:
    """Return values with those of `--vary "KEY=a,b"`, and without some families.

    Args:
        values: Values of each family.
        vary: A family or a dotted key with its values, such as "duration=0.7,3" or "gravity=1.62".
        without: Names of families.

    Raises:
        RunnerError: for a family that does not exist, or a text without values.
    """
    for name in without:
        _known(name, "--without")
    found = {name: list(some) for name, some in values.items() if name not in without}
    for text in vary:
        name, _, listed = text.partition("=")
        given = [_value(part.strip()) for part in _COMMA.split(listed) if part.strip()]
        if not name or not given:
            raise RunnerError(f"--vary: no values ({text!r}). Allowed: KEY=A,B, such as duration=0.7,3.")
        if "." not in name and name not in (*FAMILIES, _TOP_LEVEL):
            raise RunnerError(unknown("family", name, [*FAMILIES, _TOP_LEVEL], "--vary"))
        found[name] = given
    return found


def list_variations(case: Case, values: Values) -> tuple[list[Variation], list[LeftOutVariation]]:
    """Return the variations of a case in the order of the budget, and those that do not apply.

    Raises:
        RunnerError: if there are too many, or a key does not exist.
    """
    found: list[Variation] = []
    left: list[LeftOutVariation] = []
    for name, some in values.items():
        if name not in FAMILIES:
            _check_key(case, name)
        for value in some:
            for place, family in enumerate(FAMILIES.get(name, [Family("conditions", _setting(name), name)])):
                try:
                    change = family.change(case, value)
                except NotApplicableError as error:
                    if str(error):  # not the asked value itself
                        left.append(LeftOutVariation(name, value, str(error), family.kind))
                    continue
                except (TypeError, ValueError):
                    raise RunnerError(f"challenge.{name}: not a value of this family ({value!r}).") from None
                found.append(Variation(family.kind, name, value, change.label, change.sides, place))
    if len(found) > _MOST:
        raise RunnerError(f"challenge: too many variations ({len(found)}). Allowed: at most {_MOST}.")
    order = list(CLASSES)
    return sorted(found, key=lambda one: order.index(one.kind)), list(_distinct(left))


def _check_key(case: Case, key: str) -> None:
    """Check that a group of the asked configs has a key; keys within a value, such as a stage, are checked later.

    Raises:
        RunnerError: if it has not.
    """
    parent, _, name = key.rpartition(".")
    within = [config.resolved if not parent else get(config.resolved, parent) for config in case.configs]
    if any(each is None or (isinstance(each, Mapping) and name not in each) for each in within):
        known = dict.fromkeys(dotted(place) for config in case.configs for place, _ in leaves(config.resolved))
        raise RunnerError(unknown("key", key, known, "--vary"))


def _setting(key: str) -> Callable[[Case, Value], SidesChange]:
    def change(case: Case, value: Value) -> SidesChange:
        return SidesChange(f"{key}={value}", [[f"{key}={value}"] for _ in case.sides])

    return change


def _distinct(left: Sequence[LeftOutVariation]) -> Iterator[LeftOutVariation]:
    """Yield the first of several that are left out for the same reason."""
    seen: set[tuple[str, str]] = set()
    for one in left:
        if (one.family, one.reason) not in seen:
            seen.add((one.family, one.reason))
            yield one


def _known(name: str, place: str) -> None:
    if name not in FAMILIES:
        raise RunnerError(unknown("family", name, FAMILIES, place))


def _value(text: str) -> Value:
    try:
        return float(text)
    except ValueError:
        return text
