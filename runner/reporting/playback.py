"""Data of a motion for the page's script: frames, shapes of the arm, joints, paths and the first view."""

import xml.etree.ElementTree as ET
from collections.abc import Iterator
from typing import Any

import numpy as np
import pinocchio as pin

from runner.base.arrays import FloatArray
from runner.base.sanitize import plain
from runner.reporting.charts.figure import spaced_indices
from runner.reporting.charts.interactive import pack
from runner.reporting.document import Playback, PlaybackBody
from runner.robots.model import RobotModel

Json = dict[str, Any]

FRAME_RATE = 30.0
"""Most frames a second."""
FRAMES = 150
"""Most frames of a playback."""
_POINTS = 400  # of a path


def playback_spec(playback: Playback) -> Json:
    """Return the data for the page's script: a motion for each run, and the direction of the first view, in rad."""
    azimuth, elevation = first_view(playback)
    return {
        "runs": [_motion(each) for each in (playback, *playback.others)],
        "azimuth": azimuth,
        "elevation": elevation,
    }


def first_view(playback: Playback) -> tuple[float, float]:
    """Return azimuth and elevation of the viewer, in rad: square to the plane of a planar arm, otherwise oblique."""
    x, y, z = _view(np.ptp(finite_places(playback), axis=0))
    return float(np.arctan2(y, x)), float(np.arcsin(z))


def frames(playback: Playback) -> list[int]:
    """Return the indices of the instants to show: evenly spaced, and none from where a body's pose is not finite."""
    times = np.asarray(playback.times)
    finite = np.isfinite(times)
    for body in playback.bodies:
        finite &= np.isfinite(body.positions).all(axis=1) & np.isfinite(body.rotations).all(axis=1)
    length = times.size if finite.all() else int(finite.argmin())
    if length == 0:
        return []
    span = float(times[length - 1] - times[0])
    count = min(FRAMES, length, int(span * FRAME_RATE) + 1)
    wanted = np.linspace(times[0], times[length - 1], count)
    return [int(index) for index in np.unique(np.searchsorted(times[:length], wanted - 1e-9))]


def _motion(run: Playback) -> Json:
    chosen = frames(run)
    return {
        "name": plain(run.name),
        "ends": plain(run.ends),
        "look": run.look,
        "times": pack(run.times[chosen]),
        "shapes": [
            {"ends": pack(ends[chosen]), "balls": ends.shape[1] == 1, "radius": radius, "color": body.color}
            for body in run.bodies
            for ends, radius in body_shapes(body)
        ],
        "joints": [{"name": plain(name), "at": pack(places[chosen])} for name, places in run.joints.items()],
        "tip": pack(run.tip[chosen] if run.tip.size else run.tip),
        "target": pack(run.target[chosen] if run.target.size else run.target),
        "path": pack(_thinned(run.path)),
        "desired": pack(_thinned(run.desired)),
    }


def body_shapes(body: PlaybackBody) -> Iterator[tuple[FloatArray, float]]:
    """Yield ends of segments and centres of balls in the base frame, shape (T, 2, 3) and (T, 1, 3), and the radius."""
    segments = [((start, end), radius) for start, end, radius in body.segments]
    for ends, radius in [*segments, *(((center,), radius) for center, radius in body.balls)]:
        places = [body.positions + _rotated(body.rotations, np.asarray(end, dtype=float)) for end in ends]
        yield np.stack(places, axis=1), radius


def finite_places(playback: Playback) -> FloatArray:
    """Return all places that a picture shows, shape (N, 3)."""
    chosen = frames(playback)
    found = [ends[chosen].reshape(-1, 3) for body in playback.bodies for ends, _ in body_shapes(body)]
    found += [_thinned(playback.path), _thinned(playback.desired), np.zeros((1, 3))]
    return np.concatenate(found)


def _view(size: FloatArray) -> FloatArray:
    """Return the unit vector towards the viewer of a motion of a size."""
    direction = [0.9, -1.3, 0.75]
    thin = int(size.argmin())
    if size[thin] < 0.25 * size.max():
        # A little from the side, so that depth is seen.
        direction = {0: [1.0, -0.35, 0.3], 1: [0.35, -1.0, 0.3], 2: [0.25, -0.6, 1.0]}[thin]
    return np.array(direction) / float(np.linalg.norm(direction))


def _rotated(quaternions: FloatArray, vector: FloatArray) -> FloatArray:
    """Return a vector turned by quaternions w, x, y, z of shape (T, 4), shape (T, 3)."""
    unit = quaternions / np.linalg.norm(quaternions, axis=1, keepdims=True)
    w, v = unit[:, :1], unit[:, 1:]
    cross = np.cross(v, vector)
    turned: FloatArray = vector + 2 * (w * cross + np.cross(v, cross))
    return turned


def _thinned(path: FloatArray | None) -> FloatArray:
    """Return the finite points of a path, of many some that are evenly spaced, shape (N, 3)."""
    if path is None:
        return np.zeros((0, 3))
    points: FloatArray = path[np.isfinite(path).all(axis=1)]
    return points[spaced_indices(len(points), _POINTS)] if len(points) else points


Point = tuple[float, float, float]
Segment = tuple[Point, Point, float]
Ball = tuple[Point, float]

_BONE = 0.015  # radius of a bone, as a fraction of the arm's reach


def playback_bodies(urdf_text: str, model: RobotModel, q: FloatArray) -> list[PlaybackBody]:
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
        PlaybackBody(
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
