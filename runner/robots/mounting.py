"""Mounting of arms on each other, and of a tool on the flange: URDF links, inertia and reaction wrench of the tool."""

import xml.etree.ElementTree as ET

import numpy as np

from runner.base.errors import ConfigError, nearest
from runner.base.lazy_modules import pin
from runner.robots.canonical import write_text
from runner.robots.elements import add_joint, vector_text
from runner.robots.inertials import impossible_inertia
from runner.schema.values import MountConfig, ToolConfig

TOOL, TOOL_TIP, TOOL_MOUNT = "tool", "tool_tip", "tool_mount"
"""Names of the tool's link, of the massless link at the tool centre point, and of the joint to the flange."""


def mount(macro: str, mini: str, prefix: str, place: MountConfig) -> tuple[str, str]:
    """Return the URDF of an arm with another arm mounted on it, and the name of the mounted arm's root link.

    The links and joints of the mounted arm get a prefix; the names of the base arm do not change.

    Args:
        macro: URDF of the base arm, or of a chain returned by this function.
        mini: URDF of the mounted arm.
        prefix: Prefix of the mounted arm's names: the name of its stage and an underscore.
        place: Frame and pose of the mount.

    Raises:
        ConfigError: if the frame does not exist, or if a name would not be unique.
    """
    whole, mounted = ET.fromstring(macro), ET.fromstring(mini)  # noqa: S314 - resolves no external entities
    links = _names(whole, "link")
    if place.frame not in links:
        raise ConfigError(
            f"robot.stages.{prefix.rstrip('_')}.mount.frame: no link '{place.frame}'{nearest(place.frame, links)}; "
            f"links: {', '.join(links)}"
        )
    _rename(mounted, prefix)
    for kind in ("link", "joint"):
        twice = sorted(set(_names(whole, kind)) & set(_names(mounted, kind)))
        if twice:
            raise ConfigError(
                f"robot.stages.{prefix.rstrip('_')}: the {kind} name {twice[0]} stands in the carrying arm "
                "already; name the stage differently"
            )
    children = {child.get("link") for child in mounted.findall("joint/child")}
    root = next(name for name in _names(mounted, "link") if name not in children)
    pose = {"xyz": vector_text(place.translation), "rpy": vector_text(place.rotation)}
    add_joint(whole, f"{prefix}mount", "fixed", place.frame, root, **pose)
    whole.extend(element for element in mounted if element.tag in ("link", "joint"))
    return write_text(whole), root


def _names(robot: ET.Element, kind: str) -> list[str]:
    return [element.get("name", "") for element in robot.findall(kind)]


def _rename(robot: ET.Element, prefix: str) -> None:
    for element in (*robot.findall("link"), *robot.findall("joint")):
        element.set("name", prefix + element.get("name", ""))
    for joint in robot.findall("joint"):
        for role in ("parent", "child"):
            end = joint.find(role)
            if end is not None:
                end.set("link", prefix + end.get("link", ""))


def mount_tool(urdf: str, flange: str, tool: ToolConfig) -> str:
    """Return a URDF with a tool fixed on a link.

    Args:
        urdf: URDF of the arm.
        flange: Name of the link on which the tool is fixed.
        tool: Config of the tool.

    Raises:
        ConfigError: if the link does not exist, if names clash, or if the tool's inertia is impossible.
    """
    robot = ET.fromstring(urdf)  # noqa: S314 - our own text, checked when it was read
    links = [link.get("name", "") for link in robot.iter("link")]
    if flange not in links:
        raise ConfigError(
            f"robot.tool: the flange '{flange}' is not a link to fix a tool on; links: {', '.join(links)}"
        )
    if {TOOL, TOOL_TIP} & set(links):
        raise ConfigError(f"robot.tool: the URDF already has a link '{TOOL}' or '{TOOL_TIP}'; allowed: null")
    body = ET.SubElement(robot, "link", name=TOOL)
    inertial = ET.SubElement(body, "inertial")
    ET.SubElement(inertial, "origin", xyz=vector_text(tool.centre_of_mass))
    ET.SubElement(inertial, "mass", value=repr(float(tool.mass)))
    moments = dict(zip(("ixx", "iyy", "izz"), (repr(float(value)) for value in tool.inertia), strict=True))
    ET.SubElement(inertial, "inertia", {**moments, "ixy": "0", "ixz": "0", "iyz": "0"})
    impossible = impossible_inertia(body)
    if impossible:
        raise ConfigError(f"robot.tool.inertia: {problem}" for problem in impossible)
    tip = np.array(tool.tip, dtype=float)
    _add_rod(body, tip, tool.tip_radius)
    ball = ET.SubElement(body, "collision")
    ET.SubElement(ball, "origin", xyz=vector_text(tip))
    ET.SubElement(ET.SubElement(ball, "geometry"), "sphere", radius=repr(float(tool.tip_radius)))
    point = ET.SubElement(ET.SubElement(robot, "link", name=TOOL_TIP), "inertial")
    ET.SubElement(point, "mass", value="0")
    ET.SubElement(point, "inertia", dict.fromkeys(("ixx", "ixy", "ixz", "iyy", "iyz", "izz"), "0"))
    add_joint(robot, TOOL_MOUNT, "fixed", flange, TOOL, xyz="0 0 0")
    add_joint(robot, "tool_end", "fixed", TOOL, TOOL_TIP, xyz=vector_text(tip))
    return write_text(robot)


def find_tool(model: "pin.Model", flange: int) -> "pin.Inertia":
    """Return the inertia of the tool on a flange, in the flange's frame; zero without a tool."""
    if not model.existFrame(TOOL_MOUNT):
        return pin.Inertia.Zero()
    mount = model.frames[model.getFrameId(TOOL_MOUNT)]  # Pinocchio keeps a fixed link's inertia at its joint
    return (model.frames[flange].placement.inverse() * mount.placement).act(mount.inertia)


def holding_wrench(
    model: "pin.Model", data: "pin.Data", flange: int, tool: "pin.Inertia", gravity: np.ndarray
) -> np.ndarray:
    """Return the wrench of a flange on its tool for weight and motion, from the tool's rigid-body balance.

    Args:
        model: Model of the arm.
        data: Data of the model after forward kinematics up to accelerations, with an updated flange frame.
        flange: Index of the flange's frame.
        tool: Inertia of the tool in the flange's frame.
        gravity: Gravity in the base frame, shape (3,), in m/s^2.

    Returns:
        Force in N and moment about the flange's origin in N m, along its axes, shape (6,).
    """
    velocity = pin.getFrameVelocity(model, data, flange)
    acceleration = pin.getFrameAcceleration(model, data, flange)
    acceleration.linear -= data.oMf[flange].rotation.T @ gravity
    wrench: np.ndarray = (tool * acceleration + tool.vxiv(velocity)).vector
    return wrench


def _add_rod(body: ET.Element, tip: np.ndarray, radius: float) -> None:
    length = float(np.linalg.norm(tip))
    if length == 0.0:
        return
    rotation = pin.Quaternion.FromTwoVectors(np.array([0.0, 0.0, 1.0]), tip).toRotationMatrix()
    rod = ET.SubElement(body, "visual")
    ET.SubElement(rod, "origin", xyz=vector_text(0.5 * tip), rpy=vector_text(pin.rpy.matrixToRpy(rotation)))
    ET.SubElement(ET.SubElement(rod, "geometry"), "cylinder", radius=repr(radius), length=repr(length))
