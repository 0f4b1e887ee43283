"""Base class of every config model."""

from collections.abc import Sequence
from typing import get_args

from pydantic import BaseModel, ConfigDict

from runner.schema.units import Unit


class StrictModel(BaseModel):
    """Base of every config model: no unknown key, no silent conversion, no NaN or infinity, immutable."""

    model_config = ConfigDict(extra="forbid", strict=True, allow_inf_nan=False, frozen=True)

    @classmethod
    def find_unit(cls, path: Sequence[str]) -> Unit | None:
        """Return the unit of a key below this model; None if there is no such key.

        Args:
            path: Keys that lead to the key, such as ["stages", "macro", "home"]; the method ignores keys and indices
                after it.
        """
        name, *rest = path[2:] if path[0] == "stages" and len(path) > 2 else path
        if name not in cls.model_fields:
            return None
        field = cls.model_fields[name]
        inner, of_one = nested_model(field.annotation), rest[1:] if rest and rest[0].isdecimal() else rest
        if inner is not None and of_one:
            return inner.find_unit(of_one)
        return next((each for each in field.metadata if isinstance(each, Unit)), Unit())


def nested_model(annotation: object) -> type[StrictModel] | None:
    """Return the model of a key that is a group of keys or a list of such groups; None for any other key."""
    for part in (annotation, *get_args(annotation)):
        if isinstance(part, type) and issubclass(part, StrictModel):
            return part
    return None
