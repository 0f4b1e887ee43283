"""Reference derivations of the thesis' kinematics: tables, transforms, positions and axes, for both arms.

The first derivation is the model, built by Pinocchio from the URDF, with frames on its joint axes. The second is the
product of elementary rotations and translations with the dimensions of Tables 2.1, 3.1 and 4.1.
"""

from collections.abc import Callable
from functools import lru_cache

import numpy as np
from scipy.spatial.transform import Rotation

from runner.base.arrays import FloatArray
from runner.papers.audit.derivations import (
    Derivation,
    Derivations,
    Elements,
    Symbols,
    product,
    rotation,
    whole_and_elements,
)
from runner.papers.audit.model_derivations import by_model
from runner.papers.studies.thesis.denavit_hartenberg import DenavitHartenbergRow, denavit_hartenberg, frames, transform
from runner.papers.studies.thesis.equations.derivations.thesis_arms import MACRO, MINI, ThesisArm

METHODS = ("Denavit-Hartenberg frames placed on the model's joint axes", "product of elementary turns and shifts")


@lru_cache(maxsize=4)
def _rows(arm: ThesisArm) -> tuple[DenavitHartenbergRow, ...]:
    return denavit_hartenberg(arm.model)


def model_step(arm: ThesisArm, link: int, q: FloatArray) -> FloatArray:
    """Return the transform from frame i = link to frame i-1, from the model, shape (T, 4, 4)."""
    return np.array([transform(_rows(arm)[link - 1], float(q_i)) for q_i in q[:, link - 1]])


def model_frame(arm: ThesisArm, link: int, q: FloatArray) -> FloatArray:
    """Return frame i = link in the base frame, from the model, shape (T, 4, 4)."""
    return np.array([frames(_rows(arm), row)[link] for row in q])


def tip_pose(arm: ThesisArm, q: FloatArray) -> FloatArray:
    """Return the tip's transforms by Pinocchio, shape (T, 4, 4)."""
    return by_model(arm.model).pose(q)


# Transforms.


def _transforms(
    model: Callable[..., FloatArray], chain: Callable[..., FloatArray], arm: ThesisArm, link: int
) -> Derivations:
    return Derivations(
        lambda s: whole_and_elements("T", model(arm, link, arm.q(s))),
        lambda s: whole_and_elements("T", chain(arm, link, arm.q(s))),
        METHODS,
    )


macro_step_1, macro_step_2, macro_step_3 = (_transforms(model_step, ThesisArm.step, MACRO, link) for link in (1, 2, 3))
mini_step_1, mini_step_2, mini_step_3 = (_transforms(model_step, ThesisArm.step, MINI, link) for link in (1, 2, 3))
macro_frame_2, mini_frame_2 = (_transforms(model_frame, ThesisArm.frame, arm, 2) for arm in (MACRO, MINI))


def _any_link(s: Symbols) -> FloatArray:
    T = np.tile(np.eye(4), (len(s["theta"]), 1, 1))
    T[:, :3, :3] = Rotation.from_euler("ZX", np.column_stack([s["theta"], s["alpha"]])).as_matrix()
    T[:, :3, 3] = Rotation.from_euler("z", s["theta"][:, None]).apply(np.column_stack([s["a"], 0.0 * s["a"], s["d"]]))
    return T


def _any_link_by_steps(s: Symbols) -> FloatArray:
    shift = np.tile(np.eye(4), (len(s["theta"]), 1, 1))
    shift[:, 0, 3], shift[:, 2, 3] = s["a"], s["d"]
    return product([rotation("z", s["theta"]), shift, rotation("x", s["alpha"])])


any_link = Derivations(
    lambda s: whole_and_elements("T", _any_link_by_steps(s)),
    lambda s: whole_and_elements("T", _any_link(s)),
    ("product of elementary turns and shifts", "quaternions"),
)
"""A link's transform from its four parameters, (3.2)."""


# Tables.


def _table(arm: ThesisArm) -> Derivation:
    def rows(s: Symbols) -> Elements:
        found: dict[str, FloatArray] = {}
        for place, (number, row) in enumerate(zip(_numbers(arm), _rows(arm), strict=True)):
            q = arm.q(s)[:, place]
            found |= {f"theta_{number}": row.theta + q, f"alpha_{number}": row.alpha + 0.0 * q}
            found |= {f"d_{number}": row.d + 0.0 * q, f"a_{number}": row.a + 0.0 * q}
        return found

    return rows


def _table_by_axes(arm: ThesisArm) -> Derivation:
    """Return the same from the joint axes and origins at each sample, by the rules of section 3.1.

    Joint axes 1 and 2 intersect, so x_1 lies along z_0 x z_1; axes 2 and 3 are parallel, so x_2 runs from one to the
    other.
    """

    def rows(s: Symbols) -> Elements:
        q, model = arm.q(s), arm.model
        axes = np.array([model.tip_jacobian(row)[3:].T for row in q])
        origins = np.array([model.frame_poses(row, model.joint_names)[:, :3, 3] for row in q])
        tip = tip_pose(arm, q)
        zs = [axes[:, 0], axes[:, 1], axes[:, 2], tip[:, :3, 2]]
        points = [origins[:, 0], origins[:, 1], origins[:, 2], tip[:, :3, 3]]
        link = points[2] - points[1]
        base = np.tile([1.0, 0.0, 0.0], (len(q), 1))
        xs = [base, np.cross(zs[0], zs[1]), link / np.linalg.norm(link, axis=1, keepdims=True), tip[:, :3, 0]]
        found: dict[str, FloatArray] = {}
        for i, number in enumerate(_numbers(arm), start=1):
            shift = points[i] - points[i - 1]
            found[f"theta_{number}"] = _angle(xs[i - 1], xs[i], zs[i - 1])
            found[f"alpha_{number}"] = _angle(zs[i - 1], zs[i], xs[i])
            found[f"d_{number}"] = (shift * zs[i - 1]).sum(axis=1)
            found[f"a_{number}"] = (shift * xs[i]).sum(axis=1)
        return found

    return rows


def _numbers(arm: ThesisArm) -> range:
    return range(arm.joints.start + 1, arm.joints.stop + 1)


def _angle(start: FloatArray, end: FloatArray, axis: FloatArray) -> FloatArray:
    return np.asarray(np.arctan2((np.cross(start, end) * axis).sum(axis=1), (start * end).sum(axis=1)))


def _entries(arm: ThesisArm, letters: tuple[str, str]) -> Derivations:
    """Return the two columns of an arm's table whose names begin so."""

    def only(rows: Derivation) -> Derivation:
        return lambda s: {name: values for name, values in rows(s).items() if name.startswith(letters)}

    methods = (METHODS[0], "angles and distances between the joint axes at each posture")
    return Derivations(only(_table(arm)), only(_table_by_axes(arm)), methods)


macro_angles, mini_angles = (_entries(arm, ("theta", "alpha")) for arm in (MACRO, MINI))
macro_lengths, mini_lengths = (_entries(arm, ("a_", "d_")) for arm in (MACRO, MINI))
