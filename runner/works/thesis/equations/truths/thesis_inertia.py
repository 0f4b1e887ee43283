"""What (3.11), (3.16) and (4.5) of the thesis say of links that resist turning; its point masses cannot tell."""

import xml.etree.ElementTree as ET
from collections.abc import Callable
from functools import lru_cache

import numpy as np

from runner.audit.chains import derivative, rotation
from runner.audit.truth import Elements, FloatArray, Symbols, Truth, Way
from runner.robots.model import RobotModel
from runner.works.thesis.equations.truths.thesis_arms import MACRO, MINI, Arm, combined_robot
from runner.works.thesis.equations.truths.thesis_dynamics import model_mass_matrix
from runner.works.thesis.equations.truths.thesis_jacobians import model_jacobian

_SHAPE = np.diag([0.02, 0.05, 0.09])  # of m L^2, about the masses of links 2 and 3, along the axes of the link
_LINKS = (("q3", "link2"), ("tip", "link3"))  # where each one's mass is, and its frame


def _tensor(arm: Arm) -> FloatArray:
    return _SHAPE * arm.masses[2] * arm.a[2] ** 2


def _urdf(arm: Arm) -> str:
    return combined_robot().stages[0 if arm is MACRO else 1].urdf


@lru_cache(maxsize=4)
def _turning_model(arm: Arm) -> RobotModel:
    """Return an arm with links 2 and 3 that resist turning."""
    tree = ET.fromstring(_urdf(arm))  # noqa: S314 - a text of ours
    for link in tree.iter("link"):
        inertia = link.find("inertial/inertia")
        if inertia is not None and link.get("name") in ("link2", "link3"):
            inertia.attrib.update({f"i{axis}{axis}": repr(float(_tensor(arm)[i, i])) for i, axis in enumerate("xyz")})
    return RobotModel(ET.tostring(tree, encoding="unicode"), "tip")


def _mass_matrix(arm: Arm, turned: int) -> Way:
    """Return M by (3.11) with the inertia turned into the base frame so many times."""

    def matrix(s: Symbols) -> Elements:
        q = arm.q(s)
        total = np.zeros((len(q), 3, 3))
        for (end, link), mass in zip(_LINKS, arm.masses[1:], strict=True):
            J_v, J_w = model_jacobian(arm, q, end)[:, :3], model_jacobian(arm, q, link)[:, 3:]
            R = np.array([_turning_model(arm).frame_poses(row, (link,))[0, :3, :3] for row in q])
            inertia = np.tile(_tensor(arm), (len(q), 1, 1))
            for _ in range(turned):
                inertia = R @ inertia @ R.transpose(0, 2, 1)
            total += mass * J_v.transpose(0, 2, 1) @ J_v + J_w.transpose(0, 2, 1) @ inertia @ J_w
        return {"M": total}

    return matrix


turned_once, turned_twice = _mass_matrix(MACRO, 1), _mass_matrix(MACRO, 2)
mini_turned_once, mini_turned_twice = _mass_matrix(MINI, 1), _mass_matrix(MINI, 2)
"""(3.11) with I_C in the link's own frame, and with the I_C that (3.16) or (4.5) gives, turned already."""


def _by_energy(arm: Arm) -> Way:
    """Return M from the kinetic energy at unit velocities: masses and turning links, rates by differences."""

    def matrix(s: Symbols) -> Elements:
        q = arm.q(s)
        velocities = [np.sqrt(arm.masses[link - 1]) * _rates(_end(arm, link), q) for link in (2, 3)]
        spins = [_spins(link, q) for link in (2, 3)]

        def energy(dq: FloatArray) -> FloatArray:
            moving = sum(((v @ dq) ** 2).sum(axis=1) for v in velocities)
            turning = sum((w @ dq) ** 2 @ np.diag(_tensor(arm)) for w in spins)
            return np.asarray(0.5 * (moving + turning))

        unit = np.eye(3)
        rows = [[energy(e_i + e_j) - energy(e_i) - energy(e_j) for e_j in unit] for e_i in unit]
        return {"M": np.moveaxis(np.array(rows), -1, 0)}

    return matrix


def _end(arm: Arm, link: int) -> Callable[[FloatArray], FloatArray]:
    return lambda q: arm.frame(link, q)[:, :3, 3]


def _rates(function: Callable[[FloatArray], FloatArray], q: FloatArray) -> FloatArray:
    return np.stack([derivative(function, q, joint) for joint in range(3)], axis=2)


def _spins(link: int, q: FloatArray) -> FloatArray:
    """Return a link's angular velocity along its own axes at unit velocities, shape (T, 3, 3)."""

    def turn(at: FloatArray) -> FloatArray:
        tilt = at[:, 1] + (at[:, 2] if link == 3 else 0.0)
        R: FloatArray = rotation("z", at[:, 0]) @ rotation("x", tilt)
        return R[:, :3, :3]

    back = turn(q).transpose(0, 2, 1)
    skew = [back @ derivative(turn, q, joint) for joint in range(3)]
    return np.stack([np.column_stack([W[:, 2, 1], W[:, 0, 2], W[:, 1, 0]]) for W in skew], axis=2)


def _turning_truth(arm: Arm) -> Truth:
    return Truth(
        lambda s: {"M": np.array([_turning_model(arm).mass_matrix(row) for row in arm.q(s)])},
        _by_energy(arm),
        ("Pinocchio", "kinetic energy at unit velocities, rates by differences"),
    )


mass_matrix, mini_mass_matrix = _turning_truth(MACRO), _turning_truth(MINI)


# The tensors of the thesis' own links: zero.


def no_tensor(s: Symbols) -> Elements:
    """Return three tensors of zeros."""
    return {"I": np.zeros((len(s["q1"]), 3, 3, 3))}


def no_turning(s: Symbols) -> Elements:
    """Return a matrix of zeros."""
    return {"M": np.zeros((len(s["q1"]), 3, 3))}


def _tensors(arm: Arm) -> Truth:
    def by_model(s: Symbols) -> Elements:
        tensors = np.array([inertia.inertia for inertia in list(arm.model().pin_model.inertias)[1:]])
        return {"I": np.tile(tensors, (len(s["q1"]), 1, 1, 1))}

    def by_urdf(s: Symbols) -> Elements:
        links = [link.find("inertial/inertia") for link in ET.fromstring(_urdf(arm)).iter("link")]  # noqa: S314
        written = [[float(tag.attrib[f"i{key}"]) for key in _KEYS] for tag in links[1:4] if tag is not None]
        return {"I": np.tile(np.array(written).reshape(3, 3, 3), (len(s["q1"]), 1, 1, 1))}

    return Truth(by_model, by_urdf, ("Pinocchio", "the URDF as written"))


_KEYS = ("xx", "xy", "xz", "xy", "yy", "yz", "xz", "yz", "zz")
macro_tensors, mini_tensors = _tensors(MACRO), _tensors(MINI)


def _turning(link: int) -> Truth:
    """Return what turning adds to the Mini's M by one of its links."""

    def by_link(s: Symbols) -> Elements:
        q, frame = MINI.q(s), f"link{link}"
        tensor = list(MINI.model().pin_model.inertias)[link].inertia
        R = np.array([MINI.model().frame_poses(row, (frame,))[0, :3, :3] for row in q])
        J_w = model_jacobian(MINI, q, frame)[:, 3:]
        return {"M": J_w.transpose(0, 2, 1) @ (R @ tensor @ R.transpose(0, 2, 1)) @ J_w}

    def by_rest(s: Symbols) -> Elements:
        return {"M": model_mass_matrix(MINI, MINI.q(s)) - MINI.mass_matrix(MINI.q(s))}

    return Truth(by_link, by_rest, ("Pinocchio's inertias", "what the point masses leave of Pinocchio's M"))


mini_turning_5, mini_turning_6 = _turning(2), _turning(3)
