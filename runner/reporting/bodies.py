"""Bodies of a playback, from the shapes of a URDF and the motion of the arm."""

import xml.etree.ElementTree as ET

import numpy as np
import pinocchio as pin

from runner.base.arrays import FloatArray
from runner.reporting.document import Body
from runner.robots.model import RobotModel

Point = tuple[float, float, float]
Segment = tuple[Point, Point, float]
Ball = tuple[Point, float]

_BONE = 0.015  # radius of a bone, as a fraction of the arm's reach


def playback_bodies(urdf_text: str, model: RobotModel, q: FloatArray) -> list[Body]:
    """Return a body per link that can be seen, with its pose at each instant.

    A cylinder becomes a segment, a sphere a ball, a box the cylinder around it along its longest side. A link
    without any such shape (only meshes, or none) that carries joints is drawn as thin bones to those joints.

    Args:
        urdf_text: The robot's URDF.
        model: The model built from it.
        q: Joint positions, shape (T, nq), in rad.

    Returns:
        Bodies in the URDF's order; a body's colour counts the moving joints below it.
    """
    robot = ET.fromstring(urdf_text)  # noqa: S314 - ElementTree resolves no external entities
    shapes = {link.get("name", ""): _shapes(link) for link in robot.findall("link")}
    for name, (segments, balls) in shapes.items():
        if not segments and not balls:
            segments.extend(_bones(robot, name, _BONE * model.reach))
    names = tuple(name for name, (segments, balls) in shapes.items() if segments or balls)
    poses = np.array([model.frame_poses(row, names) for row in q]).reshape(len(q), len(names), 4, 4)
    pin_model = model.pin_model
    return [
        Body(
            name=name,
            segments=shapes[name][0],
            balls=shapes[name][1],
            positions=poses[:, index, :3, 3],
            rotations=_quaternions(poses[:, index, :3, :3]),
            color=int(pin_model.frames[pin_model.getFrameId(name)].parentJoint),
        )
        for index, name in enumerate(names)
    ]


def joint_places(model: RobotModel, q: FloatArray) -> dict[str, FloatArray]:
    """Return the position of each joint at each instant, shape (T, 3), in m, for joint positions of shape (T, nq)."""
    poses = np.array([model.frame_poses(row, model.joint_names) for row in q])
    return {name: poses[:, place, :3, 3] for place, name in enumerate(model.joint_names)}


def _shapes(link: ET.Element) -> tuple[list[Segment], list[Ball]]:
    segments: list[Segment] = []
    balls: list[Ball] = []
    for visual in link.findall("visual"):
        centre, rotation = _origin(visual)
        cylinder, sphere, box = (visual.find(f"geometry/{kind}") for kind in ("cylinder", "sphere", "box"))
        if cylinder is not None:
            half = rotation[:, 2] * float(cylinder.get("length", "0")) / 2.0
            segments.append((_point(centre - half), _point(centre + half), float(cylinder.get("radius", "0"))))
        elif sphere is not None:
            balls.append((_point(centre), float(sphere.get("radius", "0"))))
        elif box is not None:
            size = _numbers(box.get("size", "0 0 0"))
            longest = int(np.argmax(size))
            half = rotation[:, longest] * size[longest] / 2.0
            radius = float(np.linalg.norm(np.delete(size, longest))) / 2.0
            segments.append((_point(centre - half), _point(centre + half), radius))
    return segments, balls


def _bones(robot: ET.Element, link: str, radius: float) -> list[Segment]:
    """Return segments from a link's origin to the joints it carries."""
    bones = []
    for joint in robot.findall("joint"):
        parent = joint.find("parent")
        end = _origin(joint)[0]
        if parent is not None and parent.get("link") == link and np.linalg.norm(end) > radius:
            bones.append(((0.0, 0.0, 0.0), _point(end), radius))
    return bones


def _origin(element: ET.Element) -> tuple[FloatArray, FloatArray]:
    """Return position and rotation matrix of an element's <origin>, which may be missing."""
    origin = element.find("origin")
    attributes = {} if origin is None else origin.attrib
    rotation: FloatArray = pin.rpy.rpyToMatrix(_numbers(attributes.get("rpy", "0 0 0")))
    return _numbers(attributes.get("xyz", "0 0 0")), rotation


def _numbers(text: str) -> FloatArray:
    return np.array([float(word) for word in text.split()])


def _point(vector: FloatArray) -> Point:
    x, y, z = (float(value) for value in vector)
    return x, y, z


def _quaternions(rotations: FloatArray) -> FloatArray:
    """Return unit quaternions w, x, y, z that never jump in sign, shapes (T, 3, 3) to (T, 4)."""
    quaternions = np.array([np.roll(pin.Quaternion(R).coeffs(), 1) for R in rotations]).reshape(-1, 4)
    jumps = np.einsum("ij,ij->i", quaternions[1:], quaternions[:-1]) < 0.0
    quaternions[1:] *= np.cumprod(np.where(jumps, -1.0, 1.0))[:, None]
    return quaternions
