"""Points and directions in trajectory configs."""

from typing import Annotated

import numpy as np
from pydantic import AfterValidator, Field, ValidationInfo

from runner.base.arrays import FloatArray

_PERPENDICULAR = 1e-6  # largest cosine of an angle that counts as a right angle


def _check_direction(value: list[float]) -> list[float]:
    if np.linalg.norm(value) == 0.0:
        raise ValueError("must have a direction, so not all zero")
    return value


def check_perpendicular(value: list[float], normal: list[float]) -> list[float]:
    """Return a direction after checking that it is perpendicular to a normal.

    Raises:
        ValueError: if it is not perpendicular; the message contains the angle.
    """
    unit, axis = (np.array(v) / np.linalg.norm(v) for v in (value, normal))
    cosine = float(unit @ axis)
    if abs(cosine) > _PERPENDICULAR:
        angle = float(np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0))))
        raise ValueError(f"must be perpendicular to normal {normal}, which is {angle:.4g} deg away")
    return value


def _check_in_plane(value: list[float], info: ValidationInfo) -> list[float]:
    return check_perpendicular(value, info.data["normal"]) if "normal" in info.data else value


Point = Annotated[list[float], Field(min_length=3, max_length=3)]
Direction = Annotated[Point, AfterValidator(_check_direction)]
InPlane = Annotated[Direction, AfterValidator(_check_in_plane)]
"""Direction perpendicular to the field `normal`, which must precede it in the model."""


def component(points: FloatArray, direction: FloatArray) -> FloatArray:
    """Return the scalar product of points with a direction, shapes (..., 3) and (3,) to (...).

    `@` is not used, because the rounding of BLAS depends on the position of a point in the array.
    """
    product: FloatArray = points[..., 0] * direction[0] + points[..., 1] * direction[1] + points[..., 2] * direction[2]
    return product


def plane_axes(normal: list[float], direction: list[float]) -> tuple[FloatArray, FloatArray]:
    """Return two perpendicular unit vectors of a plane, each of shape (3,).

    Args:
        normal: Normal of the plane, of any length.
        direction: Direction of the first vector, perpendicular to the normal; rounding errors are removed.

    Returns:
        The first vector, and that vector rotated by 90 degrees counter-clockwise about the normal.
    """
    n = np.array(normal) / np.linalg.norm(normal)
    first = np.array(direction) - n * (n @ np.array(direction))
    first /= np.linalg.norm(first)
    return first, np.cross(n, first)
