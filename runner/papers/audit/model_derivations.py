"""Reference derivations from a robot model: position, Jacobians, mass matrix, gravity and Coriolis torques.

An equations file names the robot and needs no Python. The derivation of an entry is then one of `DERIVATIONS`, such as
`model.jacobian`. Units are SI, vectors are in the base frame. Indices of elements start at 1; the letter without
indices names the whole vector or matrix:

    model.position          P_x, P_y, P_z        the tip
    model.transform         T_11 to T_44         the tip's frame
    model.jacobian          J_11 to J_6n         of the tip, linear rows first; J_1 to J_n are its columns
    model.linear_jacobian   J_11 to J_3n         its linear rows
    model.angular_jacobian  J_11 to J_3n         its angular rows
    model.mass_matrix       M_11 to M_nn
    model.gravity           G_1 to G_n
    model.coriolis          V_1 to V_n           of V = C [dq^2] + B [dq dq], with C_ij and with B_ik,
                                                 k counting the pairs (1, 2), (1, 3), ... (thesis eq. 3.19)
    model.dynamics          tau_1 to tau_n       M ddq + V + G, with all elements of its terms

The first derivation uses Pinocchio; the second evaluates the URDF without Pinocchio (`urdf_chain.py`).
"""

import xml.etree.ElementTree as ET
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import reduce
from itertools import combinations
from operator import or_
from pathlib import Path

import numpy as np

from runner.assembly.validation import validate
from runner.base.arrays import FloatArray
from runner.base.errors import RunnerError, nearest
from runner.base.paths import conf_dir
from runner.config.compose.compose import compose
from runner.papers.audit.derivations import (
    Derivations,
    Symbols,
    along,
    columns,
    coordinates,
    jacobian_by_differences,
    whole_and_elements,
)
from runner.papers.audit.urdf_chain import UrdfChain
from runner.robots.description import find_urdf
from runner.robots.model import RobotModel
from runner.robots.tree import read_tree

_BODIES = "of the URDF's bodies"
_SECOND_METHODS = {
    **dict.fromkeys(("model.position", "model.transform"), "product of the URDF's transforms"),
    **dict.fromkeys(
        ("model.jacobian", "model.linear_jacobian", "model.angular_jacobian"),
        "differences of the product of the URDF's transforms",
    ),
    "model.mass_matrix": f"kinetic energy {_BODIES}",
    "model.gravity": f"differences of the potential energy {_BODIES}",
    "model.coriolis": f"Christoffel symbols, by differences of the kinetic energy {_BODIES}",
    "model.dynamics": f"kinetic and potential energy {_BODIES}, and differences",
}
DERIVATIONS = tuple(_SECOND_METHODS)
"""The quantities that a model gives."""


@dataclass(frozen=True, eq=False)
class AuditedArm:
    """A robot that equations are about.

    Attributes:
        model: Its model; the tip is the frame that is meant.
        urdf: The URDF that describes the model, as a string.
        joints: Names of its joint positions in a sample; d and dd before them are velocities and accelerations.
    """

    model: RobotModel
    urdf: str
    joints: tuple[str, ...]

    def at(self, tip: str) -> "AuditedArm":
        """Return the same arm with another of its frames as the tip; "" changes nothing."""
        return replace(self, model=RobotModel(self.urdf, tip)) if tip else self

    def derivations(self, name: str) -> Derivations:
        """Return one of `DERIVATIONS`.

        Raises:
            RunnerError: If there is none of this name.
        """
        if name not in DERIVATIONS:
            raise RunnerError(f"no derivation '{name}'{nearest(name, DERIVATIONS)}; allowed: {', '.join(DERIVATIONS)}")
        first, second = by_model(self.model), by_urdf(self.urdf, self.model)
        return Derivations(
            lambda s: first.named(name, *self.motion(s)),
            lambda s: second.named(name, *self.motion(s)),
            ("Pinocchio", _SECOND_METHODS[name]),
        )

    def motion(self, values: Symbols) -> list[FloatArray]:
        """Return joint positions, velocities and accelerations of a sample, shape (T, n); 0 where it has none."""
        q = columns(values, self.joints)
        rates = [[d + joint for joint in self.joints] for d in ("d", "dd")]
        return [q, *(columns(values, names) if set(names) <= set(values) else 0.0 * q for names in rates)]


def sample(model: RobotModel, joints: tuple[str, ...], count: int, generator: np.random.Generator) -> Symbols:
    """Return random motions: each joint from a full turn or all of its slide, s1, c1 and so on, and rates up to 1.

    Args:
        model: The robot.
        joints: Names of its joint positions.
        count: How many.
        generator: Source of the draw.
    """
    low, high = np.where(model.prismatic, model.position_limits, [[-np.pi], [np.pi]])
    values: dict[str, FloatArray] = {}
    for i, (name, q) in enumerate(zip(joints, generator.uniform(low, high, (count, model.nq)).T, strict=True), start=1):
        values |= {name: q, f"s{i}": np.sin(q), f"c{i}": np.cos(q)}
    return values | {d + name: generator.uniform(-1.0, 1.0, count) for d in ("d", "dd") for name in joints}


@dataclass(frozen=True)
class Dynamics:
    """One derivation of an arm's kinematics and dynamics, at joint positions q of shape (T, n).

    Attributes:
        pose: Homogeneous transforms of the tip, shape (T, 4, 4).
        jacobian: Of the tip, shape (T, 6, n), linear rows first.
        mass_matrix: M(q), shape (T, n, n).
        gravity: G(q), shape (T, n).
        velocity_torque: V(q, dq) for each of several velocities, shapes (T, n) and (K, T, n) to (K, T, n).
    """

    pose: Callable[[FloatArray], FloatArray]
    jacobian: Callable[[FloatArray], FloatArray]
    mass_matrix: Callable[[FloatArray], FloatArray]
    gravity: Callable[[FloatArray], FloatArray]
    velocity_torque: Callable[[FloatArray, FloatArray], FloatArray]

    def named(self, name: str, q: FloatArray, dq: FloatArray, ddq: FloatArray) -> dict[str, FloatArray]:
        """Return one of `DERIVATIONS` at joint positions, velocities and accelerations: wholes and elements by name."""
        match name.removeprefix("model."):
            case "position":
                P = self.pose(q)[:, :3, 3]
                return {"P": P} | coordinates("P", P)
            case "transform":
                return whole_and_elements("T", self.pose(q))
            case "jacobian" | "linear_jacobian" | "angular_jacobian" as kind:
                rows = {"linear_jacobian": slice(0, 3), "angular_jacobian": slice(3, 6)}.get(kind, slice(0, 6))
                J = self.jacobian(q)[:, rows]
                return whole_and_elements("J", J) | {f"J_{i}": J[:, :, i - 1] for i in range(1, J.shape[2] + 1)}
            case "mass_matrix":
                return whole_and_elements("M", self.mass_matrix(q))
            case "gravity":
                return whole_and_elements("G", self.gravity(q))
            case "coriolis":
                return self._velocity_terms(q, dq)
            case _:
                terms = [self.named(term, q, dq, ddq) for term in ("mass_matrix", "coriolis", "gravity")]
                return reduce(or_, terms) | whole_and_elements("tau", self.torque(q, dq, ddq))

    def torque(self, q: FloatArray, dq: FloatArray, ddq: FloatArray) -> FloatArray:
        """Return M ddq + V + G, shape (T, n)."""
        V: FloatArray = self.velocity_torque(q, dq[None])[0]
        return along(self.mass_matrix(q), ddq) + V + self.gravity(q)

    def _velocity_terms(self, q: FloatArray, dq: FloatArray) -> dict[str, FloatArray]:
        """Return V, and C and B from V at unit velocities and at their sums in pairs."""
        unit, pairs = np.eye(q.shape[1]), list(combinations(range(q.shape[1]), 2))
        rows = [*unit, *(unit[i] + unit[j] for i, j in pairs)]
        found = self.velocity_torque(q, np.stack([dq, *(np.broadcast_to(row, q.shape) for row in rows)]))
        squares, sums = found[1 : len(unit) + 1], found[len(unit) + 1 :]
        products = [total - squares[i] - squares[j] for total, (i, j) in zip(sums, pairs, strict=True)]
        terms = whole_and_elements("V", found[0]) | whole_and_elements("C", np.moveaxis(squares, 0, 2))
        return terms | (whole_and_elements("B", np.stack(products, axis=2)) if products else {})


def by_model(model: RobotModel) -> Dynamics:
    """Return an arm's dynamics by Pinocchio."""
    return Dynamics(
        lambda q: _each(model.tip_pose, q),
        lambda q: _each(model.tip_jacobian, q),
        lambda q: _each(model.mass_matrix, q),
        lambda q: _each(model.gravity_torque, q),
        lambda q, dq: np.array([_each(model.coriolis_torque, q, one) for one in dq]),
    )


def by_urdf(urdf: str, model: RobotModel) -> Dynamics:
    """Return the same by the transforms and energies of a URDF, and differences; the model names joints and tip."""
    chain = UrdfChain(urdf, model.joint_names, model.gravity)

    def pose(q: FloatArray) -> FloatArray:
        return chain.frames(q)[model.tip_name]

    return Dynamics(
        pose,
        lambda q: jacobian_by_differences(pose, q),
        chain.mass_matrix,
        chain.gravity_torque,
        lambda q, dq: np.asarray(np.einsum("tijk,atj,atk->ati", chain.christoffel(q), dq, dq)),
    )


def _each(function: Callable[..., FloatArray], *rows: FloatArray) -> FloatArray:
    return np.array([function(*row) for row in zip(*rows, strict=True)])


def audited_arm(robot: str, tip: str, joints: tuple[str, ...], folder: Path) -> AuditedArm:
    """Return the robot that an equations file names.

    Args:
        robot: Name of a robot's config, built-in or in the folder's `robot/`; or a URDF, built-in or in the folder.
        tip: Frame whose position and Jacobian are meant; "" is the config's tip, or the one end of a URDF.
        joints: Names of the joint positions in a sample; none are q1 to qn.
        folder: Where configs and URDFs are looked for first.

    Raises:
        RunnerError: If there is no such robot or frame, or the names are too many or too few; with the allowed ones.
    """
    file = robot.endswith(".urdf") or Path(robot).is_absolute()
    urdf, own = _from_urdf(robot, tip, folder) if file else _from_config(robot, folder)
    model = RobotModel(urdf, tip or own)
    if joints and len(joints) != model.nq:
        raise RunnerError(f"joints: {len(joints)} names; robot {robot} has {model.nq} joints")
    return AuditedArm(model, urdf, joints or tuple(f"q{i + 1}" for i in range(model.nq)))


def _from_urdf(robot: str, tip: str, folder: Path) -> tuple[str, str]:
    tree = read_tree(find_urdf(robot, [folder / "equations", folder]))
    if not tip and len(tree.ends) > 1:
        raise RunnerError(f"tip: {robot} has several ends, so a tip must be named; ends: {', '.join(tree.ends)}")
    return ET.tostring(tree.robot, encoding="unicode"), tree.ends[0]


def _from_config(robot: str, folder: Path) -> tuple[str, str]:
    known = sorted({path.stem for place in (folder, conf_dir()) for path in (place / "robot").glob("*.yaml")})
    if robot not in known:
        told = f"no robot '{robot}'{nearest(robot, known)}" if robot else "a derivation from a model needs a 'robot'"
        raise RunnerError(f"{told}; robots: {', '.join(known)}, or a .urdf file")
    arm = validate(compose((f"robot={robot}",), [folder])).arm
    return arm.urdf, arm.model.tip_name
