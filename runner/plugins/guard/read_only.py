"""Read-only copies of arrays and dataclasses, as inputs of plug-ins."""

from dataclasses import fields, is_dataclass, replace
from typing import Any

import numpy as np


def read_only(value: Any) -> Any:
    """Return a copy of an array, or of a dataclass of arrays, that cannot be written to; any other value as it is.

    As it is a copy, one that is made writable again reaches nothing of ours.
    """
    if isinstance(value, np.ndarray):
        copied = value.copy()
        copied.setflags(write=False)
        return copied
    if is_dataclass(value) and not isinstance(value, type):
        return replace(value, **{field.name: read_only(getattr(value, field.name)) for field in fields(value)})
    return value
