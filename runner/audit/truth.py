"""What an equation claims to equal, in two independent ways."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
Symbols = Mapping[str, FloatArray]
"""Values of each symbol at the samples, by name; the first axis counts the samples."""

Elements = Mapping[str, FloatArray]
"""Values of each element of an equation at the samples: shape (T,), or (T, ...) where an element is a matrix."""

Way = Callable[[Symbols], Elements]


@dataclass(frozen=True)
class Truth:
    """What an equation claims to equal.

    Attributes:
        first: One way to work it out, from the model: a chain of transforms, Pinocchio.
        second: Another that shares nothing with it but the arm's measures, such as finite differences.
        ways: The two in a few words, for the report.
    """

    first: Way
    second: Way
    ways: tuple[str, str]
