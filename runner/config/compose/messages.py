"""Messages for validation errors of pydantic."""

import re
from collections.abc import Iterator
from typing import Any

from pydantic import ValidationError

from runner.base.errors import nearest
from runner.base.former_names import KEYS, explain_key
from runner.base.sanitize import quoted
from runner.schema.model import StrictModel, nested_model
from runner.schema.units import explain_quantity, quantities_in

_NUMBERS = {
    "greater_than": "must be above {gt:g}",
    "greater_than_equal": "must be {ge:g} or more",
    "less_than": "must be below {lt:g}",
    "less_than_equal": "must be {le:g} or less",
    "finite_number": "must be a finite number",
    "float_type": "must be a number",
    "int_type": "must be a whole number",
    "int_from_float": "must be a whole number",
    "bool_type": "must be true or false",
    "string_type": "must be a string",
    "string_too_short": "must not be empty",
    "string_too_long": "must have at most {max_length} characters",
    "list_type": "must be a list of numbers",
    "dict_type": "must be a group of keys",
    "model_type": "must be a group of keys",
}
_OF_NUMBERS = ("float_type", "int_type", "list_type", "value_error")


def describe(group: str, model: type[StrictModel], error: ValidationError) -> Iterator[str]:
    """Yield one message for each problem that pydantic found in a group.

    Args:
        group: Name of the group, "" for the root.
        model: The model that the group was checked against.
        error: Exception of pydantic.
    """
    items = [(*_locate(group, item["loc"]), dict(item)) for item in error.errors()]
    renamed = {KEYS[key] for key, location, item in items if _is_renamed(model, key, location, item)}
    seen = set(renamed)  # their values are under the former keys
    for key, location, item in items:
        if key not in seen:  # a union reports each of its branches
            seen.add(key)
            told = explain_key(key) if KEYS.get(key) in renamed else _explain(model, location, item)
            yield f"{key}: {told}"


def _locate(group: str, place: tuple[int | str, ...]) -> tuple[str, list[str]]:
    """Return the dotted key of a problem, and the parts of the key below the group."""
    location = [str(part) for part in place if not str(part).startswith(("list[", "[key]", "function-", "constrained"))]
    return ".".join([*([group] if group else []), *location]), location


def _is_renamed(model: type[StrictModel], key: str, location: list[str], item: dict[str, Any]) -> bool:
    """Return True if a problem is the former name of a key that the model has."""
    present = KEYS.get(key, "").rpartition(".")[2]
    return item["type"] == "extra_forbidden" and present in _innermost(model, location).model_fields


def _explain(model: type[StrictModel], location: list[str], item: dict[str, Any]) -> str:
    kind, context = item["type"], item.get("ctx", {})
    found = item["input"] if kind.startswith("int_") else _without_zeros(item["input"])
    quantity = next(quantities_in(found), None) if kind in _OF_NUMBERS and location else None
    unit = model.find_unit(location) if quantity is not None else None
    if quantity is not None and unit is not None:
        return explain_quantity(quantity, unit.at([int(part) if part.isdecimal() else part for part in location]))
    if kind == "extra_forbidden":
        keys = [field.alias or name for name, field in _innermost(model, location).model_fields.items()]
        return f"unknown key{nearest(location[-1], keys)}; keys: {', '.join(keys)}"
    if kind == "missing":
        return "missing"
    if kind == "literal_error":
        allowed = re.findall(r"'([^']*)'", context["expected"])
        return f"found {quoted(found)}{nearest(str(found), allowed)}; allowed: {', '.join(allowed)}"
    if kind in ("too_short", "too_long"):
        expected = context.get("min_length", context.get("max_length"))
        return f"must have {expected} values; found {len(found)}: {quoted(found)}"
    if kind == "value_error":
        return f"{context['error']}; found {quoted(found)}"
    wanted = _NUMBERS.get(kind)
    if wanted == _NUMBERS["int_type"] and isinstance(found, float) and found.is_integer():
        return f"{wanted}; found {quoted(found)}; write {int(found)}"
    return f"{wanted.format(**context) if wanted else item['msg']}; found {quoted(found)}"


def _without_zeros(value: Any) -> Any:
    """Return a value with whole floats as integers, as they are typed; see to_si."""
    if isinstance(value, list):
        return [_without_zeros(part) for part in value]
    if isinstance(value, dict):
        return {key: _without_zeros(part) for key, part in value.items()}
    return int(value) if isinstance(value, float) and value.is_integer() else value


def _innermost(model: type[StrictModel], location: list[str]) -> type[StrictModel]:
    """Return the model of the innermost group that contains the last key."""
    for part in location[:-1]:
        field = model.model_fields.get(part)
        model = (nested_model(field.annotation) if field is not None else None) or model
    return model
