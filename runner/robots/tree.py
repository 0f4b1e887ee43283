"""URDF tree of links and joints: safe XML parsing, checks of structure and of numeric values."""

import math
import xml.etree.ElementTree as ET
from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from runner.base.errors import ConfigError, nearest
from runner.base.limits import ARM_PARTS, XML, XML_ATTRIBUTES, XML_ELEMENTS, ExcessError, read_text
from runner.base.sanitize import quoted
from runner.schema.model import LARGEST, SMALLEST

_NAME = 200  # characters
_DEPTH = 20
_XACRO = "{http://www.ros.org/wiki/xacro}"


@dataclass(frozen=True)
class UrdfTree:
    """URDF whose links form a tree with one root.

    Attributes:
        robot: The root element of the XML.
        links: Links by name.
        joints: Joints by name.
        root: Name of the link without a parent joint.
        ties: Constrained joints with their constraints, as in "mimics 'q1'".
        home: Joint positions of the file's keyframe `home`, in rad or m; empty without this keyframe.
        renamed: Messages about joints that were renamed because a link has the same name.
    """

    robot: ET.Element
    links: dict[str, ET.Element]
    joints: dict[str, ET.Element]
    root: str
    ties: Mapping[str, str] = field(default_factory=dict)
    home: Mapping[str, float] = field(default_factory=dict)
    renamed: tuple[str, ...] = ()

    @property
    def bearers(self) -> dict[str, str]:
        """Name of the parent joint of each link except the root."""
        return {end_of(joint, "child"): name for name, joint in self.joints.items()}

    @property
    def ends(self) -> list[str]:
        """Links without child joints, in the order of the file."""
        bearing = {end_of(joint, "parent") for joint in self.joints.values()}
        return [name for name in self.links if name not in bearing]

    def way(self, link: str) -> list[str]:
        """Return the joints from the root to a link, in order."""
        bearers, way = self.bearers, []
        while link != self.root:
            way.append(bearers[link])
            link = end_of(self.joints[way[-1]], "parent")
        return way[::-1]

    @property
    def chain(self) -> list[str]:
        """Moving joints on the path with the most of them, in order; for a serial arm, all moving joints."""
        ways = [[name for name in self.way(end) if moves(self.joints[name])] for end in self.ends]
        return max(ways, key=len)

    def no_joint(self, name: str) -> str:
        """Return a message about a name that no moving joint has."""
        said = "it is held fixed" if name in self.joints else f"no such joint{nearest(name, self.chain)}"
        return f"{said}; joints: {', '.join(self.chain)}"


def check_tip(tip: str, frames: Sequence[str]) -> None:
    """Check that a tip is the name of exactly one frame of an arm, a link or a joint.

    Raises:
        ConfigError: if no frame or several frames have this name.
    """
    if tip not in frames:
        raise ConfigError(f"robot.tip: no frame '{tip}'{nearest(tip, frames)}; frames: {', '.join(frames)}")
    if frames.count(tip) > 1:
        raise ConfigError(f"robot.tip: '{tip}' is the name of {frames.count(tip)} links and joints; rename all but one")


def end_of(joint: ET.Element, role: str) -> str:
    """Return the name of the link at an end of a joint; role is "parent" or "child"."""
    element = joint.find(role)
    return "" if element is None else element.get("link", "")


def moves(joint: ET.Element) -> bool:
    """Return True if the type of a joint is not fixed."""
    return joint.get("type") != "fixed"


def read_tree(path: Path) -> UrdfTree:
    """Read a URDF file.

    Raises:
        ConfigError: if the file is not a URDF, has a document type or macros, exceeds the limits of the engines, or if
            its links do not form one tree.
    """
    return make_tree(parse_xml(path), path)


def tree_of(urdf: str, path: Path) -> UrdfTree:
    """Return the tree of a URDF string that was made from a checked file; see make_tree."""
    return make_tree(ET.fromstring(urdf), path)  # noqa: S314 - our own text


def make_tree(robot: ET.Element, path: Path) -> UrdfTree:
    """Return the tree of links of a URDF's root element; see read_tree for the errors, whose messages contain the file.

    The element is changed in place: a robot without a name gets that of its file, and a joint with the name of a link
    is renamed, because engines look up both by name.
    """
    links = {link.get("name", ""): link for link in robot.findall("link")}
    if robot.tag != "robot" or not links:
        raise ConfigError(f"robot.urdf: {path} is not a URDF: it needs a <robot> with links")
    if path.suffix == ".xacro" or any(element.tag.startswith(_XACRO) for element in robot.iter()):
        made = f"{path.name.removesuffix('.xacro').removesuffix('.urdf')}{'_made' * (path.suffix == '.urdf')}.urdf"
        raise ConfigError(f"robot.urdf: {path} holds xacro macros; make a URDF of it first: xacro {path.name} > {made}")
    robot.set("name", robot.get("name") or path.stem)
    renamed = _rename_joints(robot, links)
    joints = {joint.get("name", ""): joint for joint in robot.findall("joint")}
    excess = _excess(robot)
    if excess:
        raise ConfigError(f"robot.urdf: {path}: {problem}" for problem in excess)
    problems = [*_repeated(robot), *_loose_ends(links, joints)]
    children = Counter(end_of(joint, "child") for joint in joints.values())
    problems += [f"link '{name}' is borne by {count} joints" for name, count in children.items() if count > 1]
    roots = [name for name in links if name not in children]
    if not roots:
        problems.append("its joints run in a circle, and no link is the base")
    elif len(roots) > 1:
        problems.append(f"it holds several trees, with the bases {', '.join(roots)}; join them by a fixed joint")
    if not problems:
        mimics = {name: mimic for name, joint in joints.items() if (mimic := joint.find("mimic")) is not None}
        ties = {name: f"mimics '{mimic.get('joint', '')}'" for name, mimic in mimics.items()}
        tree = UrdfTree(robot, links, joints, roots[0], ties, renamed=renamed)
        circling = _circling(tree)
        if not circling:
            return tree
        problems.append(f"the links {', '.join(circling)} run in a circle, apart from the base '{roots[0]}'")
    raise ConfigError(f"robot.urdf: {path}: {problem}; allowed: one tree of links" for problem in problems)


class _Builder(ET.TreeBuilder):
    """Builder that rejects document types, because entities can expand without limit, and too many elements."""

    def __init__(self) -> None:
        super().__init__()
        self._elements = 0

    def start(self, tag: str, attrs: dict[str, str], /) -> ET.Element:
        self._elements += 1
        if excess := XML_ELEMENTS.excess(self._elements) or XML_ATTRIBUTES.excess(len(attrs)):
            raise ExcessError(excess)
        return super().start(tag, attrs)

    def doctype(self, name: str, pubid: str | None, system: str | None) -> None:
        raise ET.ParseError("it has a document type (<!DOCTYPE>), which no arm needs; remove it")


def parse_xml(path: Path, key: str = "robot.urdf") -> ET.Element:
    """Return the root element of an XML file without a document type.

    Args:
        path: The file.
        key: Config key of the file, for messages.

    Raises:
        ConfigError: if the file cannot be read, is not XML or exceeds the limits.
    """
    try:
        text = read_text(path, XML)
        return ET.fromstring(text, parser=ET.XMLParser(target=_Builder()))  # noqa: S314 - no entities, see there
    except ExcessError as error:
        raise ConfigError(f"{key}: {path} {error}") from error
    except (ET.ParseError, ValueError) as error:
        hint = "; xacro macros? Make a URDF of it first" if "unbound prefix" in str(error) else ""
        raise ConfigError(f"{key}: {path} is not XML: {error}{hint}") from error
    except OSError as error:
        raise ConfigError(f"{key}: {path} cannot be read: {error.strerror or error}") from error


def is_mjcf(path: Path) -> bool:
    """Return True if the root element of an XML file is that of an MJCF.

    Raises:
        ConfigError: if the file is not XML or cannot be read.
    """
    return parse_xml(path).tag == "mujoco"


def _rename_joints(robot: ET.Element, links: Collection[str]) -> tuple[str, ...]:
    """Rename each joint that has the name of a link; return messages about the changes."""
    joints, told = robot.findall("joint"), []
    taken = {*links, *(joint.get("name", "") for joint in joints)}
    for joint in joints:
        name = new = joint.get("name", "")
        if name and name in links:
            while new in taken:
                new += "_joint"
            taken.add(new)
            for element, key in ((joint, "name"), *((mimic, "joint") for mimic in robot.iterfind("joint/mimic"))):
                if element.get(key) == name:
                    element.set(key, new)
            told.append(f"joint '{name}' is '{new}', as a link has the name")
    return tuple(told)


def _excess(robot: ET.Element) -> list[str]:
    """Return messages about exceeded limits of the engines; PyBullet overwrites memory if a name is too long."""
    named = (robot, *robot.findall("link"), *robot.findall("joint"))
    if excess := ARM_PARTS.excess(len(named) - 1):
        return [f"it {excess}"]
    if deep := excess_depth(robot, _DEPTH):
        return [deep]
    return [
        f"the name of a {element.tag} has {len(name)} characters, {quoted(name)}; allowed: up to {_NAME}"
        for element in named
        if len(name := element.get("name", "")) > _NAME
    ]


def excess_depth(root: ET.Element, allowed: int) -> str | None:
    """Return a message about elements that are nested too deeply; None if they are not."""
    level, depth = [root], 0
    while level:
        level, depth = [inner for element in level for inner in element], depth + 1
    return f"its elements stand {depth} deep within each other; allowed: up to {allowed}" if depth > allowed else None


def _repeated(robot: ET.Element) -> list[str]:
    found = []
    for kind in ("link", "joint"):
        names = Counter(element.get("name", "") for element in robot.findall(kind))
        found += [f"{count} {kind}s have the name '{name}'" for name, count in names.items() if count > 1]
        found += [f"a {kind} has no name" for name in names if not name]
    return found


def _loose_ends(links: dict[str, ET.Element], joints: dict[str, ET.Element]) -> list[str]:
    return [
        f"joint '{name}' has a {role} '{end_of(joint, role)}', which is not a link{nearest(end_of(joint, role), links)}"
        for name, joint in joints.items()
        for role in ("parent", "child")
        if end_of(joint, role) not in links
    ]


def _circling(tree: UrdfTree) -> Sequence[str]:
    """Return the links that are not connected to the root."""
    hanging, grown = {tree.root}, True
    while grown:
        more = {end_of(j, "child") for j in tree.joints.values() if end_of(j, "parent") in hanging} - hanging
        hanging |= more
        grown = bool(more)
    return [name for name in tree.links if name not in hanging]


NO_LIMIT = 1e6
"""Smallest absolute value, in SI units, that means no limit, because URDF requires limits of joints."""
TENSOR = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")


def number(element: ET.Element | None, key: str) -> float:
    """Return the number in an attribute of an element, or NaN if it is missing or not a number."""
    try:
        return math.nan if element is None else float(element.get(key, "nan"))
    except ValueError:
        return math.nan


def vector_text(values: Iterable[float]) -> str:
    """Return numbers as the value of an XML attribute."""
    return " ".join(repr(float(value)) for value in values)


def add_joint(robot: ET.Element, name: str, kind: str, parent: str, child: str, **origin: str) -> ET.Element:
    """Add a joint between two links to a URDF; `origin` has the attributes of its origin."""
    joint = ET.SubElement(robot, "joint", name=name, type=kind)
    ET.SubElement(joint, "parent", link=parent)
    ET.SubElement(joint, "child", link=child)
    ET.SubElement(joint, "origin", origin)
    return joint


def limit_of(joint: ET.Element, key: str) -> float:
    """Return a limit of a moving joint, in SI units: infinite if it means no limit, 0 if it is missing."""
    value = number(joint.find("limit"), key)
    return 0.0 if math.isnan(value) else value if abs(value) < NO_LIMIT else math.copysign(math.inf, value)


def wrong_places(element: ET.Element) -> Iterator[tuple[str, str]]:
    """Yield messages about invalid positions, rotations and axes of a link or joint, each with a remedy."""
    for part in element.iter():
        for key in ("xyz", "rpy") if part.tag in ("origin", "axis") else ():
            words = part.get(key)
            if words is not None and not _is_vector(words):
                yield (
                    f"<{part.tag} {key}={quoted(words)}>",
                    f"allowed: three numbers, parted by spaces, up to {LARGEST:g}",
                )
            elif part.tag == "axis" and moves(element) and words and not any(map(float, words.split())):
                yield "an axis of length 0", "give it a direction"


def absurd_inertial(link: ET.Element) -> Iterator[str]:
    """Yield messages about absurd masses and inertias of a link; values that are not numbers are checked elsewhere."""
    mass = number(link.find("inertial/mass"), "value")
    if LARGEST < mass < math.inf or 0.0 < mass < SMALLEST:
        yield f"mass {mass:g} kg; allowed: 0, or {SMALLEST:g} to {LARGEST:g}"
    for key in TENSOR:
        moment = number(link.find("inertial/inertia"), key)
        if LARGEST < abs(moment) < math.inf:
            yield f"inertia {key} of {moment:g} kg m^2; allowed: up to {LARGEST:g}"


def wrong_limits(joint: ET.Element) -> Iterator[str]:
    """Yield messages about invalid limits of a moving joint; missing limits are checked elsewhere."""
    limit = joint.find("limit")
    if limit is None or not moves(joint):
        return
    for key in ("lower", "upper", "effort", "velocity"):
        if limit.get(key) is not None and math.isnan(number(limit, key)):
            yield f"a limit {key}={quoted(limit.get(key))}; allowed: a number"
    lower, upper = number(limit, "lower"), number(limit, "upper")
    if lower > upper:
        yield f"limits from {lower:g} to {upper:g}; lower must be below upper"
    for key in ("effort", "velocity"):
        if number(limit, key) < 0.0:
            yield f"{key} limit {number(limit, key):g}; allowed: 0 or more"


def _is_vector(text: str) -> bool:
    try:
        values = [float(word) for word in text.split()]
    except ValueError:
        return False
    return len(values) == 3 and all(abs(value) <= LARGEST for value in values)
