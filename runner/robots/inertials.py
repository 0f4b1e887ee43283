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
from runner.base.lazy_modules import pin
from runner.base.limits import ExcessError, read_text
from runner.base.sanitize import quoted
from runner.robots.tree import UrdfTree
from runner.schema.model import StrictModel
from runner.schema.values import expand


@dataclass(frozen=True)
class Payload:
    """A point mass fixed on a link.

    Attributes:
        link: Name of the link, the tip's.
        mass: Its mass, in kg.
        position: Its place in the link's frame, (3,), in m.
    """

    link: str
    mass: float
    position: Sequence[float]


class _Tensor(StrictModel):
    """Inertia about the centre of mass, in axes of the link's frame, in kg m^2."""

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
    """Return the file of a URDF's other inertial sets: `arm.inertials.yaml` beside `arm.urdf`."""
    return urdf.with_suffix(".inertials.yaml")


def replace_inertials(links: Mapping[str, ET.Element], urdf: Path, name: str) -> dict[str, str]:
    """Give links the inertials of a named set; links that it leaves out keep theirs.

    Args:
        links: The URDF's links by name, changed in place.
        urdf: The URDF's file.
        name: Name of the set.

    Returns:
        Where each link's inertial comes from that is no more the file's own, for messages about it.

    Raises:
        ConfigError: if there is no such set, its file cannot be read, or it names a link that the URDF does not have.
    """
    sets = read_sets("robot.inertials", set_file(urdf), _InertialSet)
    if name not in sets:
        there = f"sets: {', '.join(sets)}" if sets else f"there is no {set_file(urdf).name}; allowed: null"
        raise ConfigError(f"robot.inertials: no set '{name}'{nearest(name, sets)}; {there}")
    strange = [link for link in sets[name].links if link not in links]
    if strange:
        raise ConfigError(
            f"robot.inertials: set '{name}' names the link '{link}', which {urdf.name} does not have"
            f"{nearest(link, links)}; links: {', '.join(links)}"
            for link in strange
        )
    for link, values in sets[name].links.items():
        _write(links[link], values.mass, values.centre_of_mass, values.inertia.model_dump())
    return {link: f"robot.inertials: set '{name}' in {set_file(urdf)} gives link '{link}'" for link in sets[name].links}


def read_sets(key: str, path: Path, kind: type[T]) -> dict[str, T]:
    """Return the sets in a file by name, each of a kind; none where it is not there.

    Raises:
        ConfigError: if it cannot be read, or holds something else; names the key, the file and the place.
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
    """Give a link another mass, in kg, and scale its inertia along (a uniform change of density)."""
    element, inertia = link.find("inertial/mass"), link.find("inertial/inertia")
    if element is None:
        return
    scale = mass / float(element.get("value", "nan"))
    element.set("value", repr(float(mass)))
    for key, value in dict({} if inertia is None else inertia.attrib).items():
        if inertia is not None:
            inertia.set(key, repr(float(value) * scale))


def add_payload(links: Mapping[str, ET.Element], payload: Payload) -> None:
    """Merge a payload with the inertial of the link that carries it, so that every engine reads the same body.

    Raises:
        ConfigError: if the tip is no link of the URDF, but another frame.
    """
    if payload.link not in links:
        raise ConfigError(
            f"robot.payload: the tip frame '{payload.link}' is no link{nearest(payload.link, links)}; a payload "
            f"needs one: add a massless link there, fixed. Links: {', '.join(links)}"
        )
    link = links[payload.link]
    frame, own = place_of(link.find("inertial")), _own_inertia(link)
    whole = frame.act(own) + pin.Inertia(payload.mass, np.array(payload.position, dtype=float), np.zeros((3, 3)))
    write_inertial(link, whole.mass, whole.lever, whole.inertia)


def impossible_inertia(link: ET.Element) -> list[str]:
    """Return what is wrong with a link's inertia that no rigid body has; PyBullet takes zero in its place."""
    moments = principal_moments(link)
    listed = ", ".join(f"{moment:.3g}" for moment in moments)
    if moments[0] < -_ROUNDING * moments[2]:
        return [f"an inertia that is not positive definite (principal moments {listed} kg m^2): no body has it"]
    if moments[2] > (1.0 + _ROUNDING) * (moments[0] + moments[1]):
        return [
            f"principal moments of inertia of {listed} kg m^2: no body has one above the sum of the others, and "
            "PyBullet would take zero for all"
        ]
    return []


def principal_moments(link: ET.Element) -> np.ndarray:
    """Return a link's principal moments of inertia about its centre of mass, shape (3,), in kg m^2, ascending."""
    return np.asarray(np.linalg.eigvalsh(_tensor(link)))


def fix_inertia(link: ET.Element) -> None:
    """Give a link the nearest inertia that a rigid body can have.

    What a body's mass is spread by along its axes, sum m x x^T = tr(I)/2 - I, cannot be negative; such spreads become a
    thousandth of the largest one.
    """
    tensor = _tensor(link)
    spread, axes = np.linalg.eigh(0.5 * np.trace(tensor) * np.eye(3) - tensor)
    spread = np.maximum(spread, 1e-3 * max(float(spread[2]), 0.0))
    fixed = axes @ np.diag(spread.sum() - spread) @ axes.T
    inertia = link.find("inertial/inertia")
    if inertia is not None:
        for row, column in _UPPER:
            inertia.set(f"i{'xyz'[row]}{'xyz'[column]}", repr(float(fixed[row, column])))


def make_massless(link: ET.Element) -> None:
    """Give a link zero mass and zero inertia."""
    write_inertial(link, 0.0, np.zeros(3), np.zeros((3, 3)))


_ROUNDING = 1e-6  # of the largest moment: files print few digits
_UPPER = tuple(itertools.combinations_with_replacement(range(3), 2))


def _own_inertia(link: ET.Element) -> "pin.Inertia":
    """Return a link's inertia in its inertial frame, whose origin is its centre of mass."""
    mass = link.find("inertial/mass")
    return pin.Inertia(math.nan if mass is None else float(mass.get("value", "nan")), np.zeros(3), _tensor(link))


def _tensor(link: ET.Element) -> np.ndarray:
    """Return a link's inertia about its centre of mass in the axes of its inertial frame, shape (3, 3), in kg m^2."""
    inertia, tensor = link.find("inertial/inertia"), np.zeros((3, 3))
    for row, column in _UPPER:
        value = "0" if inertia is None else inertia.get(f"i{'xyz'[row]}{'xyz'[column]}", "0")
        tensor[row, column] = tensor[column, row] = float(value)
    return tensor


def place_of(element: ET.Element | None) -> "pin.SE3":
    """Return the frame that the `<origin>` of a joint or an inertial gives, in that of the link that bears it."""
    origin = None if element is None else element.find("origin")
    xyz, rpy = ("0 0 0", "0 0 0") if origin is None else (origin.get("xyz", "0 0 0"), origin.get("rpy", "0 0 0"))
    return pin.SE3(pin.rpy.rpyToMatrix(_vector(rpy)), _vector(xyz))


def write_inertial(link: ET.Element, mass: float, centre_of_mass: np.ndarray, tensor: np.ndarray) -> None:
    """Give a link an inertial in axes of its frame.

    Args:
        link: The link, changed in place.
        mass: In kg.
        centre_of_mass: Shape (3,), in m.
        tensor: Inertia about it, shape (3, 3), in kg m^2.
    """
    _write(link, mass, centre_of_mass.tolist(), {f"i{'xyz'[row]}{'xyz'[col]}": tensor[row, col] for row, col in _UPPER})


def _write(link: ET.Element, mass: float, centre_of_mass: Sequence[float], tensor: Mapping[str, float]) -> None:
    """Give a link an inertial in axes of its frame."""
    old = link.find("inertial")
    if old is not None:
        link.remove(old)
    inertial = ET.SubElement(link, "inertial")
    ET.SubElement(inertial, "origin", xyz=" ".join(repr(float(value)) for value in centre_of_mass))
    ET.SubElement(inertial, "mass", value=repr(float(mass)))
    ET.SubElement(inertial, "inertia", {key: repr(float(value)) for key, value in tensor.items()})


def _vector(text: str) -> np.ndarray:
    return np.array([float(value) for value in text.split()])


class _ArmatureSet(StrictModel):
    source: str
    joints: dict[str, NonNegativeFloat]  # kg m^2, after the gear; kg where a joint slides


def armature_file(urdf: Path) -> Path:
    """Return the file of a robot's sets of armatures: `arm.armature.yaml` beside `arm.urdf`."""
    return urdf.with_suffix(".armature.yaml")


def armature_by_joint(tree: UrdfTree, path: Path, given: float | Sequence[float] | str) -> dict[str, float]:
    """Return the armature of each joint that moves, in kg m^2; kg where it slides.

    Args:
        tree: The arm.
        path: Its file.
        given: One value for all joints, a list with one for each from the base outwards, or the name of a set.

    Raises:
        ConfigError: for a list of another length, a set that there is not, one that cannot be read, or one that names a
            joint that the arm does not have.
    """
    joints = tree.chain
    if isinstance(given, str):
        return _of_set(tree, path, given)
    each = expand("robot.armature", float(given) if isinstance(given, int | float) else list(given), joints)
    return dict(zip(joints, each, strict=True))


def write_armature(tree: UrdfTree, values: dict[str, float]) -> None:
    """Write the armature of joints into an arm: `<dynamics armature="...">`, which RobotModel reads; 0 is not written.

    What the file itself says there is taken out.

    Args:
        tree: The arm, changed in place.
        values: By joint, in kg m^2.
    """
    for name, joint in tree.joints.items():
        dynamics = joint.find("dynamics")
        if dynamics is not None:
            dynamics.attrib.pop("armature", None)
        if values.get(name, 0.0):
            if dynamics is None:  # readers of URDFs demand these two
                dynamics = ET.SubElement(joint, "dynamics", damping="0.0", friction="0.0")
            dynamics.set("armature", repr(values[name]))


def _of_set(tree: UrdfTree, path: Path, name: str) -> dict[str, float]:
    sets = read_sets("robot.armature", armature_file(path), _ArmatureSet)
    if name not in sets:
        there = f"sets: {', '.join(sets)}" if sets else f"there is no {armature_file(path).name}"
        raise ConfigError(
            f"robot.armature: no set '{name}'{nearest(name, sets)}; {there}. Allowed: a number of 0 or more, in "
            "kg m^2, a list with one for each joint, or the name of a set"
        )
    values, joints = sets[name].joints, tree.chain
    strange = [joint for joint in values if joint not in joints]
    if strange:
        raise ConfigError(
            f"robot.armature: set '{name}' names the joint '{joint}': {tree.no_joint(joint)}" for joint in strange
        )
    return {joint: values.get(joint, 0.0) for joint in joints}
