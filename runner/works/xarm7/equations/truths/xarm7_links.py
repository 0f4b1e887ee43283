"""The xArm7 as its maker gives it: transforms between neighbouring links, against those that the report starts from."""

from collections.abc import Callable
from functools import cache

import numpy as np

from runner.audit.chains import product, rotation
from runner.audit.truth import Elements, FloatArray, Symbols, Truth
from runner.paths import robots_dir
from runner.robots.model import RobotModel
from runner.works.xarm7.equations.truths.xarm7 import JOINTS, positions, steps

_ORIGINS = (  # of each joint in the link before it, in cm, and its roll in quarter turns: the maker's numbers
    ((0, 0, 26.7), 0),
    ((0, 0, 0), -1),
    ((0, -29.3, 0), 1),
    ((5.25, 0, 0), 1),
    ((7.75, -34.25, 0), 1),
    ((0, 0, 0), 1),
    ((7.6, 9.7, 0), -1),
)


@cache
def arm() -> RobotModel:
    """Return the arm of robots/xarm7.urdf."""
    return RobotModel((robots_dir() / "xarm7.urdf").read_text(encoding="utf-8"), "link7")


def _by_model(values: Symbols) -> Elements:
    names = ("link_base", *(f"link{i + 1}" for i in range(JOINTS)))
    frames = np.array([arm().frame_poses(q, names) for q in positions(values)])
    frames[..., :3, 3] *= 100
    return {f"A_{i + 1}": np.linalg.inv(frames[:, i]) @ frames[:, i + 1] for i in range(JOINTS)}


def _by_origins(values: Symbols) -> Elements:
    q = positions(values)
    result = {}
    for i, (origin, quarters) in enumerate(_ORIGINS):
        placed = rotation("x", quarters * np.pi / 2).copy()
        placed[:, :3, 3] = origin
        result[f"A_{i + 1}"] = placed @ rotation("z", q[:, i])
    return result


link = Truth(_by_model, _by_origins, ("Pinocchio, robots/xarm7.urdf", "the maker's joint origins"))


def _step(place: int) -> Callable[[Symbols], Elements]:
    def printed(values: Symbols) -> Elements:
        transforms: FloatArray = product(steps(place, positions(values)[:, place]))
        return {f"A_{place + 1}": transforms}

    return printed


step_1, step_2, step_3, step_4, step_5, step_6, step_7 = (_step(place) for place in range(JOINTS))
