"""Reference derivations of (3.11), (3.16) and (4.5) for links with rotational inertia instead of point masses."""

import xml.etree.ElementTree as ET
from functools import lru_cache

import numpy as np

from runner.base.arrays import FloatArray
from runner.papers.audit.derivations import Derivations, Elements, Symbols
from runner.papers.audit.model_derivations import AuditedArm, Dynamics, by_model
from runner.papers.studies.thesis.equations.derivations.thesis_arms import MACRO, MINI, ThesisArm
from runner.robots.model import RobotModel

_SHAPE = np.diag([0.02, 0.05, 0.09])  # of m L^2, about the masses of links 2 and 3, along the axes of the link


def _tensor(arm: ThesisArm) -> FloatArray:
    return _SHAPE * arm.masses[2] * arm.a[2] ** 2


@lru_cache(maxsize=2)
def _turning(arm: ThesisArm) -> AuditedArm:
    """Return an arm with links 2 and 3 that resist turning."""
    tree = ET.fromstring(arm.audited.urdf)  # noqa: S314 - a text of ours
    for link in tree.iter("link"):
        inertia = link.find("inertial/inertia")
        if inertia is not None and link.get("name") in ("link2", "link3"):
            inertia.attrib.update({f"i{axis}{axis}": repr(float(_tensor(arm)[i, i])) for i, axis in enumerate("xyz")})
    urdf = ET.tostring(tree, encoding="unicode")
    return AuditedArm(RobotModel(urdf, "tip"), urdf, arm.audited.joints)


def _at(arm: ThesisArm, frame: str) -> Dynamics:
    return by_model(arm.audited.at(frame).model)


def tensor_symbols(arm: ThesisArm, q: FloatArray) -> Symbols:
    """Return rotations `R_C_i` of an arm's links, and inertias.

    `I_xx_i` to `I_zz_i` are of links that resist turning, about the axes of the link; `I_own_i` and `D_own_i`, all
    zeros, those of the thesis' own links.
    """
    found: dict[str, FloatArray] = {}
    for link, number in enumerate(range(arm.joints.start + 1, arm.joints.stop + 1), start=1):
        found[f"R_C_{number}"] = _at(arm, f"link{link}").pose(q)[:, :3, :3]
        found |= {f"{name}_{number}": np.zeros((len(q), 3, 3)) for name in ("I_own", "D_own")}
        for place, axis in enumerate("xyz"):
            found[f"I_{axis}{axis}_{number}"] = np.full(len(q), _tensor(arm)[place, place] if link > 1 else 0.0)
    return found


mass_matrix, mini_mass_matrix = (_turning(arm).derivations("model.mass_matrix") for arm in (MACRO, MINI))


# The tensors of the thesis' own links: zero.


def _by_link(arm: ThesisArm, tensors: FloatArray, s: Symbols) -> Elements:
    first = arm.joints.start + 1
    return {f"I_own_{i}": np.tile(tensor, (len(s["q1"]), 1, 1)) for i, tensor in enumerate(tensors, start=first)}


def _tensors(arm: ThesisArm) -> Derivations:
    def by_model(s: Symbols) -> Elements:
        tensors = np.array([inertia.inertia for inertia in list(arm.model.pin_model.inertias)[1:]])
        return _by_link(arm, tensors, s)

    def by_urdf(s: Symbols) -> Elements:
        links = [link.find("inertial/inertia") for link in ET.fromstring(arm.audited.urdf).iter("link")]  # noqa: S314
        written = [[float(tag.attrib[f"i{key}"]) for key in _KEYS] for tag in links[1:4] if tag is not None]
        return _by_link(arm, np.array(written).reshape(3, 3, 3), s)

    return Derivations(by_model, by_urdf, ("Pinocchio", "the URDF as written"))


_KEYS = ("xx", "xy", "xz", "xy", "yy", "yz", "xz", "yz", "zz")
macro_tensors, mini_tensors = _tensors(MACRO), _tensors(MINI)


def _of_link(link: int) -> Derivations:
    """Return the contribution to the Mini's M of the rotation of one of its links."""

    def by_link(s: Symbols) -> Elements:
        q, at = MINI.q(s), _at(MINI, f"link{link}")
        tensor, R = list(MINI.model.pin_model.inertias)[link].inertia, at.pose(q)[:, :3, :3]
        J_w = at.jacobian(q)[:, 3:]
        return {"M": J_w.transpose(0, 2, 1) @ (R @ tensor @ R.transpose(0, 2, 1)) @ J_w}

    def by_rest(s: Symbols) -> Elements:
        Js = [np.sqrt(MINI.masses[i - 1]) * MINI.end_jacobian(i, MINI.q(s))[:, :3] for i in (2, 3)]
        points = np.sum([J.transpose(0, 2, 1) @ J for J in Js], axis=0)
        return {"M": by_model(MINI.model).mass_matrix(MINI.q(s)) - points}

    return Derivations(by_link, by_rest, ("Pinocchio's inertias", "what the point masses leave of Pinocchio's M"))


mini_turning_5, mini_turning_6 = _of_link(2), _of_link(3)
