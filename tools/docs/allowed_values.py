"""Descriptions of the allowed values of a config key, from its type."""

from types import NoneType, UnionType
from typing import Annotated, Any, Literal, Union, get_args, get_origin

from runner.config.robot import Armature
from runner.schema.model import StrictModel
from runner.schema.values import (
    FiniteByJoint,
    FinitePerStage,
    NonNegativeByJoint,
    NonNegativePerStage,
    OptionalFiniteByJoint,
    OptionalNonNegativeByJoint,
    OptionalPositiveByJoint,
    PositivePerStage,
    TorquePerStage,
)
from runner.trajectories.joint_motion import Configuration

_IN_WORDS = {
    FinitePerStage: "number, by stage",
    PositivePerStage: "number above 0, by stage",
    NonNegativePerStage: "number of 0 or more, by stage",
    TorquePerStage: "number above 0, or a list with one for each joint, by stage",
    FiniteByJoint: "number, a list with one for each joint, or numbers by joint",
    NonNegativeByJoint: "number of 0 or more, a list with one for each joint, or numbers by joint",
    OptionalFiniteByJoint: "number, a list with one for each joint, numbers by joint, or `null`",
    OptionalNonNegativeByJoint: "number of 0 or more, a list with one for each joint, numbers by joint, or `null`",
    OptionalPositiveByJoint: "number above 0, a list with one for each joint, numbers by joint, or `null`",
    Configuration: "number, or a list with one for each joint",
    Armature: "number of 0 or more, or a list with one for each joint, or the name of a set",
}
_BOUNDS = {"gt": "above {:g}", "ge": "of {:g} or more", "lt": "below {:g}", "le": "of {:g} or less"}


def describe(annotation: Any, metadata: list[Any] | tuple[Any, ...] = ()) -> str:
    """Return the values that a type and its constraints allow."""
    for known, words in _IN_WORDS.items():
        if any(item in get_args(known)[1:] for item in metadata):
            return words
    origin, parts = get_origin(annotation), get_args(annotation)
    if origin is Annotated:
        return describe(parts[0], (*parts[1:], *metadata))
    if origin is Literal:
        return ", ".join(f"`{part}`" for part in parts)
    if origin in (Union, UnionType):
        return ", or ".join(dict.fromkeys(describe(part, metadata) for part in parts))
    if origin is list:
        return _list(parts[0], metadata)
    if origin is dict:
        return f"by name: {describe(parts[1])}"
    return _plain(annotation, metadata)


def _list(item: Any, metadata: list[Any] | tuple[Any, ...]) -> str:
    bounds = {name: value for entry in metadata for name, value in _bounds(entry, ("min_length", "max_length"))}
    shortest, longest = bounds.get("min_length"), bounds.get("max_length")
    count = "" if shortest is None else f"{shortest} " if shortest == longest else f"{shortest} or more "
    return f"list of {count}({describe(item)})"


def _plain(annotation: Any, metadata: list[Any] | tuple[Any, ...]) -> str:
    if annotation in (NoneType, None):
        return "`null`"
    if isinstance(annotation, type) and issubclass(annotation, StrictModel):
        return "a group of keys"
    words = {float: "number", int: "whole number", bool: "`true`, `false`", str: "text"}.get(
        annotation, str(annotation)
    )
    limits = [_BOUNDS[name].format(value) for entry in metadata for name, value in _bounds(entry, tuple(_BOUNDS))]
    return " ".join([words, ", ".join(limits)]).strip() if annotation in (float, int) else words


def _bounds(entry: Any, names: tuple[str, ...]) -> list[tuple[str, Any]]:
    """Return the bounds that a constraint states; a pydantic Field holds several in its own metadata."""
    inner = getattr(entry, "metadata", None)
    if inner:
        return [bound for item in inner for bound in _bounds(item, names)]
    return [(name, getattr(entry, name)) for name in names if getattr(entry, name, None) is not None]
