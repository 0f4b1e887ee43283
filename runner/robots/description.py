"""The URDF of a robot as text: found, checked, and with the masses that a config asks for."""

import itertools
import math
import xml.etree.ElementTree as ET
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
import pinocchio as pin

from runner.errors import ConfigError, nearest
from runner.paths import robots_dir


def find_urdf(name: str, config_dirs: Sequence[Path] = ()) -> Path:
    """Return the file of a URDF: an absolute path, or a name in a config folder of the user's or among our robots.

    Args:
        name: Value of `robot.urdf`.
        config_dirs: Config folders of the user's; each is searched itself and in its sub-folder `robots`.

    Raises:
        ConfigError: if no such file exists; names the places searched.
    """
    places = [place for folder in config_dirs for place in (folder / "robots", folder)] + [robots_dir()]
    candidates = [Path(name)] if Path(name).is_absolute() else [place / name for place in places]
    for candidate in candidates:
        if candidate.is_file():
            return candidate
    own = sorted(path.name for path in robots_dir().glob("*.urdf"))
    raise ConfigError(
        [
            f"robot.urdf: no file '{name}'{nearest(name, own)}; looked in "
            f"{', '.join(str(c.parent) for c in candidates)}; ours: {', '.join(own)}"
        ]
    )


def read_urdf(path: Path, masses: Mapping[str, float], rotor_inertia: float = 0.0) -> str:
    """Return a URDF's text with the given link masses, inertias scaled along (a uniform change of density).

    Args:
        path: The URDF file.
        masses: Mass of links by name, in kg; links not named keep theirs.
        rotor_inertia: Inertia added to each moving link about its joint's axis, in kg m^2, and half of it across: a
            rotor, a thin disc, that turns with the link, without gear.

    Raises:
        ConfigError: if the file is no URDF, a link named does not exist or has no mass to change, or a link's own
            mass is negative or not finite.
    """
    try:
        tree = ET.fromstring(path.read_text())  # noqa: S314 - ElementTree resolves no external entities
    except (ET.ParseError, UnicodeDecodeError) as error:
        raise ConfigError([f"robot.urdf: {path} is no XML: {error}"]) from error
    links = {link.get("name", ""): link for link in tree.iter("link")}
    if tree.tag != "robot" or not links:
        raise ConfigError([f"robot.urdf: {path} is no URDF: it needs a <robot> with links"])
    problems = []
    for name, link in links.items():
        if link.find("inertial/mass") is None:
            problems.append(
                f"robot.urdf: link '{name}' in {path} has no <inertial><mass>; PyBullet would make it 1 kg: write its "
                "mass, or zero mass and zero inertia"
            )
        elif not 0.0 <= _mass(link) < math.inf:
            problems.append(f"robot.urdf: link '{name}' in {path} has mass {_mass(link):g} kg; allowed: 0 or more")
        problems.extend(f"robot.urdf: link '{name}' in {path} has {bad}" for bad in _bad_inertia(link))
    for name in masses:
        if name not in links:
            problems.append(f"robot.masses.{name}: no such link{nearest(name, links)}; links: {', '.join(links)}")
        elif _mass(links[name]) == 0.0:
            problems.append(f"robot.masses.{name}: link '{name}' is massless in {path.name}; its mass cannot be scaled")
    if not problems:
        for name, mass in masses.items():
            _scale_inertial(links[name], mass)
    if problems:
        raise ConfigError(problems)
    if rotor_inertia:
        for joint in tree.iter("joint"):
            _add_rotor(joint, links, rotor_inertia)
    return ET.tostring(tree, encoding="unicode")


def _mass(link: ET.Element) -> float:
    element = link.find("inertial/mass")
    return math.nan if element is None else _number(element.get("value"))


def _number(text: str | None) -> float:
    """Return what a URDF attribute says, or NaN where it is missing or no number."""
    try:
        return math.nan if text is None else float(text)
    except ValueError:
        return math.nan


def _bad_inertia(link: ET.Element) -> list[str]:
    inertia = link.find("inertial/inertia")
    values = {} if inertia is None else {key: _number(value) for key, value in inertia.attrib.items()}
    wrong = [f"inertia {key} that is no finite number" for key, value in values.items() if not math.isfinite(value)]
    if not wrong and _mass(link) == 0.0 and any(values.values()):
        wrong.append("inertia but no mass; PyBullet would drop it: give it a mass, or zero inertia")
    return wrong


def _scale_inertial(link: ET.Element, mass: float) -> None:
    element = link.find("inertial/mass")
    inertia = link.find("inertial/inertia")
    if element is None:
        return
    scale = mass / _mass(link)
    element.set("value", repr(float(mass)))
    for key, value in dict({} if inertia is None else inertia.attrib).items():
        if inertia is not None:
            inertia.set(key, repr(float(value) * scale))


def _add_rotor(joint: ET.Element, links: Mapping[str, ET.Element], rotor_inertia: float) -> None:
    child, axis = joint.find("child"), joint.find("axis")
    link = None if child is None else links.get(child.get("link", ""))
    inertia = None if link is None else link.find("inertial/inertia")
    if joint.get("type") == "fixed" or link is None or inertia is None:
        return
    frame = link.find("inertial/origin")
    rotation = pin.rpy.rpyToMatrix(_vector("0 0 0" if frame is None else frame.get("rpy", "0 0 0")))
    direction = rotation.T @ _vector("1 0 0" if axis is None else axis.get("xyz", "1 0 0"))
    # A thin disc: PyBullet drops an inertia that no body has, such as one about a single axis.
    added = 0.5 * rotor_inertia * (np.eye(3) + np.outer(direction, direction) / float(direction @ direction))
    for row, column in itertools.combinations_with_replacement(range(3), 2):
        key = f"i{'xyz'[row]}{'xyz'[column]}"
        inertia.set(key, repr(float(inertia.get(key, "0")) + float(added[row, column])))


def _vector(text: str) -> np.ndarray:
    return np.array([float(value) for value in text.split()])
