"""Link inertials and joint armatures of a URDF: named sets, scaled masses, payloads and validity checks."""

import itertools
import math
import xml.etree.ElementTree as ET
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, TypeVar

import numpy as np
from pydantic import Field, NonNegativeFloat, TypeAdapter, ValidationError

from runner.base.bounded_yaml import STORED, YamlError, read_yaml
from runner.base.errors import ConfigError, nearest
from runner.base.lazy_modules import eigen, pin
from runner.base.limits import ExcessError, read_text
from runner.base.sanitize import quoted
from runner.robots.elements import TENSOR, vector_text
from runner.robots.tree import UrdfTree
from runner.schema.model import StrictModel
from runner.schema.values import expand


@dataclass(frozen=True)
class Payload:
    """Point mass fixed on a link.

    Attributes:
        link: Name of the link at the tip.
        mass: The mass, in kg.
        position: Position in the link's frame, shape (3,), in m.
    """

    link: str
    mass: float
    position: Sequence[float]


class _Tensor(StrictModel):
    """Inertia about the centre of mass, in the axes of the link's frame, in kg m^2."""

    ixx: NonNegativeFloat
    ixy: float
    ixz: float
    iyy: NonNegativeFloat
    iyz: float
    izz: NonNegativeFloat


class _Inertial(StrictModel):
    mass: NonNegativeFloat  # kg
    centre_of_mass: Annotated[list[float], Field(min_length=3, max_length=3)]  # m, in the link's frame
    inertia: _Tensor


class _InertialSet(StrictModel):
    source: str
    links: dict[str, _Inertial]


T = TypeVar("T", bound=StrictModel)


def set_file(urdf: Path) -> Path:
    """Return the file with the inertial sets of a URDF: `arm.inertials.yaml` next to `arm.urdf`."""
    return urdf.with_suffix(".inertials.yaml")


def replace_inertials(links: Mapping[str, ET.Element], urdf: Path, name: str) -> dict[str, str]:
    """Replace the inertials of links by those of a named set; links that are not in the set do not change.

    Args:
        links: The URDF's links by name, changed in place.
        urdf: The URDF's file.
        name: Name of the set.

    Returns:
        Source of each replaced inertial, for messages about it, by link.

    Raises:
        ConfigError: if the set does not exist, its file cannot be read, or it has a link that the URDF does not have.
    """
    found = _find_set("robot.inertials", set_file(urdf), _InertialSet, name, "; allowed: null").links
    strange = [link for link in found if link not in links]
    if strange:
        raise ConfigError(
            f"robot.inertials: set '{name}' names the link '{link}', which {urdf.name} does not have"
            f"{nearest(link, links)}; links: {', '.join(links)}"
            for link in strange
        )
    for link, values in found.items():
        _write(links[link], values.mass, values.centre_of_mass, values.inertia.model_dump())
    return {link: f"robot.inertials: set '{name}' in {set_file(urdf)} gives link '{link}'" for link in found}


def _find_set(key: str, path: Path, kind: type[T], name: str, no_file: str = "", allowed: str = "") -> T:
    """Return a set of a file; `no_file` and `allowed` are added to the messages.

    Raises:
        ConfigError: if the set does not exist; see read_sets.
    """
    sets = read_sets(key, path, kind)
    if name not in sets:
        there = f"sets: {', '.join(sets)}" if sets else f"there is no {path.name}{no_file}"
        raise ConfigError(f"{key}: no set '{name}'{nearest(name, sets)}; {there}{allowed}")
    return sets[name]


def read_sets(key: str, path: Path, kind: type[T]) -> dict[str, T]:
    """Return the sets in a file by name, as instances of `kind`; empty if the file does not exist.

    Raises:
        ConfigError: if the file cannot be read or does not match; the message contains key, file and location.
    """
    if not path.is_file():
        return {}
    try:
        return TypeAdapter(dict[str, kind]).validate_python(read_yaml(read_text(path, STORED.size), path))  # type: ignore[valid-type]
    except (YamlError, ExcessError, UnicodeDecodeError) as error:
        raise ConfigError(f"{key}: {path} cannot be read: {error}") from error
    except ValidationError as error:
        raise ConfigError(
            f"{key}: {path}: {'.'.join(map(str, problem['loc']))}: {problem['msg']}; found {quoted(problem['input'])}"
            for problem in error.errors()
        ) from None


def scale_inertial(link: ET.Element, mass: float) -> None:
    """Set the mass of a link, in kg, and scale its inertia by the same factor (a uniform change of density)."""
    element, inertia = link.find("inertial/mass"), link.find("inertial/inertia")
    if element is None:
        return
    scale = mass / float(element.get("value", "nan"))
    element.set("value", repr(float(mass)))
    for key, value in dict({} if inertia is None else inertia.attrib).items():
        if inertia is not None:
            inertia.set(key, repr(float(value) * scale))


def add_payload(links: Mapping[str, ET.Element], payload: Payload) -> None:
    """Merge a payload with the inertial of its link, so that all engines read the same body.

    Raises:
        ConfigError: if the tip is a frame that is not a link of the URDF.
    """
    if payload.link not in links:
        raise ConfigError(
            f"robot.payload: the tip frame '{payload.link}' is not a link{nearest(payload.link, links)}; a payload "
            f"needs one: add a massless link there, fixed. Links: {', '.join(links)}"
        )
    link = links[payload.link]
    frame, own = place_of(link.find("inertial")), _own_inertia(link)
    whole = frame.act(own) + pin.Inertia(payload.mass, np.array(payload.position, dtype=float), np.zeros((3, 3)))
    write_inertial(link, whole.mass, whole.lever, whole.inertia)


def impossible_inertia(link: ET.Element) -> list[str]:
    """Return messages about an inertia that is impossible for a rigid body; PyBullet would replace it by zero."""
    moments = principal_moments(link)
    listed = ", ".join(f"{moment:.3g}" for moment in moments)
    if moments[0] < -_ROUNDING * moments[2]:
        return [f"an inertia that is not positive definite (principal moments {listed} kg m^2): no body has it"]
    others = moments[0] + moments[1]
    if moments[2] > (1.0 + _ROUNDING) * others:
        above = f"{100.0 * (moments[2] / others - 1.0):.3g} % above" if others > 0.0 else "above"
        return [
            f"principal moments of inertia of {listed} kg m^2: no body has one above the sum of the others, which the "
            f"largest is {above}, and PyBullet would take zero for all"
        ]
    return []


def principal_moments(link: ET.Element) -> np.ndarray:
    """Return a link's principal moments of inertia about its centre of mass, shape (3,), in kg m^2, ascending."""
    return np.asarray(np.linalg.eigvalsh(_tensor(link)))


def turn_to_principal_axes(link: ET.Element) -> None:
    """Turn the inertial frame of a link to its principal axes: the tensor becomes diagonal, the body stays the same."""
    inertial, inertia, tensor = link.find("inertial"), link.find("inertial/inertia"), _tensor(link)
    if inertial is None or inertia is None or not np.any(tensor - np.diag(np.diag(tensor))):
        return
    principal, place = eigen.SelfAdjointEigenSolver(tensor), place_of(inertial)
    axes = principal.eigenvectors().copy()
    axes[:, 2] = np.cross(axes[:, 0], axes[:, 1])  # right-handed
    for origin in inertial.findall("origin"):
        inertial.remove(origin)
    rpy = vector_text(pin.rpy.matrixToRpy(place.rotation @ axes))
    inertial.insert(0, ET.Element("origin", xyz=vector_text(place.translation), rpy=rpy))
    inertia.attrib.update(dict.fromkeys(TENSOR, "0.0"))
    inertia.attrib.update(zip(("ixx", "iyy", "izz"), map(repr, principal.eigenvalues().tolist()), strict=True))


def fix_inertia(link: ET.Element) -> None:
    """Replace the inertia of a link by the nearest one that is possible for a rigid body; see nearest_moments."""
    moments, axes = np.linalg.eigh(_tensor(link))
    fixed = axes @ np.diag(nearest_moments(moments)) @ axes.T
    inertia = link.find("inertial/inertia")
    if inertia is not None:
        inertia.attrib.update({key: repr(float(fixed[place])) for key, place in _UPPER.items()})


def nearest_moments(moments: np.ndarray) -> np.ndarray:
    """Return the principal moments of a rigid body that are nearest to given ones in the sum of squared differences.

    None of a body is above the sum of the others. The sum stays above by a ten-thousandth of the largest, so that
    rounding does not matter.

    Args:
        moments: Principal moments, shape (3,), ascending, in kg m^2.
    """
    apart = _APART * max(float(moments[2]), 0.0)
    a, b, c = moments - apart  # the allowed set is a cone; this moves its tip to zero
    excess = max(c - a - b, 0.0) / 3.0
    if a + c - excess >= b:  # only the largest moment is at its bound
        nearest = np.array([a + excess, b + excess, c - excess])
    else:  # a rod along the first axis
        nearest = max((b + c) / 2.0, 0.0) * np.array([0.0, 1.0, 1.0])
    return np.asarray(nearest + apart)


def make_massless(link: ET.Element) -> None:
    """Set the mass and inertia of a link to zero."""
    write_inertial(link, 0.0, np.zeros(3), np.zeros((3, 3)))


_ROUNDING = 1e-6  # of the largest moment, because files have few digits
_APART = 1e-4  # of the largest moment: distance of a corrected inertia from impossible ones
_UPPER = dict(zip(TENSOR, itertools.combinations_with_replacement(range(3), 2), strict=True))


def _own_inertia(link: ET.Element) -> "pin.Inertia":
    """Return a link's inertia in its inertial frame, whose origin is its centre of mass."""
    mass = link.find("inertial/mass")
    return pin.Inertia(math.nan if mass is None else float(mass.get("value", "nan")), np.zeros(3), _tensor(link))


def _tensor(link: ET.Element) -> np.ndarray:
    """Return a link's inertia about its centre of mass in the axes of its inertial frame, shape (3, 3), in kg m^2."""
    inertia, tensor = link.find("inertial/inertia"), np.zeros((3, 3))
    for key, place in _UPPER.items():
        tensor[place] = tensor[place[::-1]] = float("0" if inertia is None else inertia.get(key, "0"))
    return tensor


def place_of(element: ET.Element | None) -> "pin.SE3":
    """Return the frame in the `<origin>` of a joint or an inertial, relative to its parent link."""
    origin = None if element is None else element.find("origin")
    xyz, rpy = ("0 0 0", "0 0 0") if origin is None else (origin.get("xyz", "0 0 0"), origin.get("rpy", "0 0 0"))
    return pin.SE3(pin.rpy.rpyToMatrix(_vector(rpy)), _vector(xyz))


def write_inertial(link: ET.Element, mass: float, centre_of_mass: np.ndarray, tensor: np.ndarray) -> None:
    """Write the inertial of a link in the axes of its frame.

    Args:
        link: The link, changed in place.
        mass: Mass, in kg.
        centre_of_mass: Centre of mass, shape (3,), in m.
        tensor: Inertia about the centre of mass, shape (3, 3), in kg m^2.
    """
    _write(link, mass, centre_of_mass.tolist(), {key: tensor[place] for key, place in _UPPER.items()})


def _write(link: ET.Element, mass: float, centre_of_mass: Sequence[float], tensor: Mapping[str, float]) -> None:
    """Write the inertial of a link in the axes of its frame; see write_inertial."""
    old = link.find("inertial")
    if old is not None:
        link.remove(old)
    inertial = ET.SubElement(link, "inertial")
    ET.SubElement(inertial, "origin", xyz=vector_text(centre_of_mass))
    ET.SubElement(inertial, "mass", value=repr(float(mass)))
    ET.SubElement(inertial, "inertia", {key: repr(float(value)) for key, value in tensor.items()})


def _vector(text: str) -> np.ndarray:
    return np.array([float(value) for value in text.split()])


class _ArmatureSet(StrictModel):
    source: str
    joints: dict[str, NonNegativeFloat]  # kg m^2, after the gear; kg for prismatic joints


def armature_file(urdf: Path) -> Path:
    """Return the file with the armature sets of a robot: `arm.armature.yaml` next to `arm.urdf`."""
    return urdf.with_suffix(".armature.yaml")


def armature_by_joint(tree: UrdfTree, path: Path, given: float | Sequence[float] | str) -> dict[str, float]:
    """Return the armature of each moving joint by name, in kg m^2; kg for prismatic joints.

    Args:
        tree: The arm.
        path: File of the arm.
        given: One value for all joints, a list with one for each from the base outwards, or the name of a set.

    Raises:
        ConfigError: if the length of a list differs from the number of joints, if the set does not exist or cannot be
            read, or if it has a joint that the arm does not have.
    """
    joints = tree.chain
    if isinstance(given, str):
        return _of_set(tree, path, given)
    each = expand("robot.armature", float(given) if isinstance(given, int | float) else list(given), joints)
    return dict(zip(joints, each, strict=True))


def write_armature(tree: UrdfTree, values: dict[str, float]) -> None:
    """Write the armature of joints into an arm, as `<dynamics armature="...">`, which RobotModel reads.

    The values replace those of the file; zeros are not written.

    Args:
        tree: The arm, changed in place.
        values: Armature by joint, in kg m^2.
    """
    for name, joint in tree.joints.items():
        dynamics = joint.find("dynamics")
        if dynamics is not None:
            dynamics.attrib.pop("armature", None)
        if values.get(name, 0.0):
            if dynamics is None:  # readers of URDFs require these two
                dynamics = ET.SubElement(joint, "dynamics", damping="0.0", friction="0.0")
            dynamics.set("armature", repr(values[name]))


def _of_set(tree: UrdfTree, path: Path, name: str) -> dict[str, float]:
    allowed = ". Allowed: a number of 0 or more, in kg m^2, a list with one for each joint, or the name of a set"
    values = _find_set("robot.armature", armature_file(path), _ArmatureSet, name, allowed=allowed).joints
    joints = tree.chain
    strange = [joint for joint in values if joint not in joints]
    if strange:
        raise ConfigError(
            f"robot.armature: set '{name}' names the joint '{joint}': {tree.no_joint(joint)}" for joint in strange
        )
    return {joint: values.get(joint, 0.0) for joint in joints}
