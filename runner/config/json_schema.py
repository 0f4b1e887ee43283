"""JSON Schema of configs, with which an editor completes keys and shows their meaning and unit."""

import inspect
import re
from collections.abc import Mapping
from functools import lru_cache
from typing import Annotated, Any

from pydantic import TypeAdapter

from runner.base.errors import RunnerError, unknown
from runner.config.groups import GROUPS
from runner.config.robot import StageConfig
from runner.config.settings import RunSettings
from runner.plugins.registry import Kinds
from runner.schema.model import StrictModel, nested_model
from runner.schema.units import Unit

_DIALECT = "https://json-schema.org/draft/2020-12/schema"
_INTERPOLATED = {"type": "string", "pattern": r"^\$\{.*\}$"}
_WITH_UNIT = {"type": ["string", "array"]}


def json_schema(group: str = "") -> dict[str, Any]:
    """Return the schema of a config file at the root, such as an experiment, or of a file of a group.

    No key is required, because a file changes only some of them. Plug-ins that are in use are included.

    Args:
        group: Name of the group; empty for the root.

    Raises:
        RunnerError: if there is no such group.
    """
    if group and group not in GROUPS:
        raise RunnerError(unknown("group", group, GROUPS))
    properties = _of_group(group) if group else _properties(RunSettings)
    if not group:
        properties |= {name: {"anyOf": [_object(_of_group(name)), {"type": "null"}]} for name in GROUPS}
    more = {"defaults": {"type": "array", "description": "Options of groups that this file takes, in order."}}
    if not group:
        more["hydra"] = {"type": "object", "description": "Settings of Hydra."}
    title = f"{group} of a run" if group else "Config of a run"
    return {"$schema": _DIALECT, "title": title, **_object({**more, **properties})}


def meanings(model: type[StrictModel]) -> dict[str, str]:
    """Return the description of each key in the docstrings of a model and its bases."""
    found: dict[str, str] = {}
    for base in reversed(model.__mro__):
        text = inspect.cleandoc(base.__doc__ or "").partition("Attributes:\n")[2]
        entries = re.findall(r"^    (\w+): (.+?)(?=^    \w|\Z)", text, re.M | re.S)
        found |= {name: " ".join(meaning.split()) for name, meaning in entries if name in model.model_fields}
    return found


def _of_group(name: str) -> dict[str, Any]:
    """Return the keys of all models that a group may have; a key of several models allows what any of them does."""
    known = GROUPS[name]
    kinds = {kind: known.config_model(kind) for kind in known.names()} if isinstance(known, Kinds) else {"": known}
    found: dict[str, list[dict[str, Any]]] = {}
    for model in kinds.values():
        for key, schema in _properties(model).items():
            some = found.setdefault(key, [])
            some += [schema] if schema not in some else []
    properties = {key: _merged(some) for key, some in found.items()}
    if isinstance(known, Kinds):
        properties["kind"] = {"enum": list(kinds), "description": f"Which {name} it is."}
    if name == "robot":
        stage = _object(_properties(StageConfig))
        properties["stages"] = {"type": "object", "additionalProperties": stage, "description": "Arms, by name."}
        properties |= {key: schema for key, schema in stage["properties"].items() if key not in properties}
    return properties


def _merged(schemas: list[dict[str, Any]]) -> dict[str, Any]:
    """Return the union of some schemas of a key, with all its meanings."""
    meanings = dict.fromkeys(schema["description"] for schema in schemas)
    forms = [form for schema in schemas for form in schema["anyOf"][:-1]]
    return {"description": " Or: ".join(meanings), "anyOf": [*forms, _INTERPOLATED]}


def _properties(model: type[StrictModel]) -> dict[str, Any]:
    told = meanings(model)
    return {name: _property(model, name, told.get(name, "")) for name in model.model_fields}


@lru_cache(maxsize=2048)
def _property(model: type[StrictModel], name: str, meaning: str) -> dict[str, Any]:
    field = model.model_fields[name]
    inner = nested_model(field.annotation)
    forms: list[Mapping[str, Any]] = []
    if inner is not None:
        forms += [_object(_properties(inner)), {"type": ["null", "array"]}]
        if "dict" in str(field.annotation):
            forms[0] = {"type": "object", "additionalProperties": forms[0]}
    else:
        kind: Any = Annotated[field.annotation, *field.metadata] if field.metadata else field.annotation
        made = TypeAdapter(kind).json_schema()
        forms.append(_inlined(made, made.pop("$defs", {})))
    if any(isinstance(each, Unit) and each.first for each in field.metadata):
        forms.append(_WITH_UNIT)
    return {"description": meaning, "anyOf": [*forms, _INTERPOLATED]}


def _inlined(schema: Any, parts: Mapping[str, Any]) -> Any:
    """Return a schema with its references replaced by the parts that they name."""
    if isinstance(schema, list):
        return [_inlined(each, parts) for each in schema]
    if not isinstance(schema, dict):
        return schema
    if "$ref" in schema:
        return _inlined(parts[str(schema["$ref"]).rpartition("/")[2]], parts)
    return {name: _inlined(value, parts) for name, value in schema.items()}


def _object(properties: Mapping[str, Any]) -> dict[str, Any]:
    return {"type": "object", "properties": dict(properties), "additionalProperties": False}
