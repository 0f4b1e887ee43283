"""URDF tree of links and joints: safe XML parsing, checks of structure and of numeric values."""

import xml.etree.ElementTree as ET
from collections import Counter
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path

from runner.base.errors import ConfigError, nearest
from runner.base.limits import ARM_PARTS, XML, XML_ATTRIBUTES, XML_ELEMENTS, ExcessError, read_text
from runner.base.sanitize import few, quoted
from runner.robots.canonical import Change, canonize
from runner.robots.elements import end_of, moves
from runner.robots.file_extensions import declare_prefixes, drop_definitions, read_motors

_NAME = 200  # characters
_DEPTH = 20


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
        changes: Changes of values for the canonical text; see canonize.
    """

    robot: ET.Element
    links: dict[str, ET.Element]
    joints: dict[str, ET.Element]
    root: str
    ties: Mapping[str, str] = field(default_factory=dict)
    home: Mapping[str, float] = field(default_factory=dict)
    renamed: tuple[str, ...] = ()
    changes: tuple[Change, ...] = ()

    @cached_property
    def bearers(self) -> dict[str, str]:
        """Name of the parent joint of each link except the root."""
        return {end_of(joint, "child"): name for name, joint in self.joints.items()}

    @cached_property
    def borne(self) -> dict[str, list[str]]:
        """Names of the joints on each link that bears some, in the order of the file."""
        found: dict[str, list[str]] = {}
        for name, joint in self.joints.items():
            found.setdefault(end_of(joint, "parent"), []).append(name)
        return found

    @property
    def ends(self) -> list[str]:
        """Links without child joints, in the order of the file."""
        return [name for name in self.links if name not in self.borne]

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

    The element is changed in place: its values become canonical, a robot without a name gets that of its file, and a
    joint with the name of a link is renamed, because engines look up both by name.
    """
    try:
        unused = drop_definitions(robot)
    except ValueError:
        made = f"{path.name.removesuffix('.xacro').removesuffix('.urdf')}{'_made' * (path.suffix == '.urdf')}.urdf"
        command = f"xacro {path.name} > {made}"
        raise ConfigError(
            f"robot.urdf: {path} uses xacro; make a URDF of it first: {command} (pip has xacro)"
        ) from None
    links = {link.get("name", ""): link for link in robot.findall("link")}
    if robot.tag != "robot" or not links:
        raise ConfigError(f"robot.urdf: {path} is not a URDF: it needs a <robot> with links")
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
            read_motors(robot, joints)
            left_out = (
                [Change("xacro", f"definitions that nothing uses: {few(unused)}", "now left out")] if unused else []
            )
            return replace(tree, changes=(*left_out, *canonize(links, joints)))
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
        parser = ET.XMLParser(target=_Builder())  # noqa: S314 - no entities, see there
        return ET.fromstring(declare_prefixes(text), parser=parser)  # noqa: S314
    except ExcessError as error:
        raise ConfigError(f"{key}: {path} {error}") from error
    except (ET.ParseError, ValueError) as error:
        raise ConfigError(f"{key}: {path} is not XML: {error}") from error
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
