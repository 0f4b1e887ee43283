"""Vibration of arms: natural modes, and flexible links as beams, modelled by chains of rigid segments and springs."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from runner.base import portable
from runner.base.arrays import FloatArray
from runner.base.lazy_modules import pin
from runner.robots.model import RobotModel
from runner.robots.robot import Robot, with_models


class Mode(NamedTuple):
    """Natural vibration mode.

    Attributes:
        frequency: Undamped frequency, in Hz.
        damping_ratio: Damping ratio, from 0 to below 1.
    """

    frequency: float
    damping_ratio: float

    def amplitude(self, times: FloatArray, signal: FloatArray, after: float) -> float:
        """Return the amplitude of this mode in a signal at the start of its free vibration.

        The mode and a constant are fitted to the signal from this time to the end.

        Args:
            times: Times of the samples, ascending, shape (T,), in s.
            signal: Samples of the signal, shape (T,).
            after: Start of the free vibration, in s.
        """
        on, omega = times >= after - 1e-9, 2.0 * np.pi * self.frequency
        since = times[on] - after
        phase = omega * np.sqrt(1.0 - self.damping_ratio**2) * since
        fall = portable.exp(-self.damping_ratio * omega * since)
        waves = np.stack([fall * np.cos(phase), fall * np.sin(phase), np.ones_like(since)], axis=1)
        return float(np.hypot(*np.linalg.lstsq(waves, signal[on], rcond=None)[0][:2]))


def find_modes(M: FloatArray, D: FloatArray, K: FloatArray) -> list[Mode]:
    r"""Return the vibration modes of a system in order of frequency; overdamped motions are left out.

    .. math:: M \ddot x + D \dot x + K x = 0, \qquad s = -\zeta \omega \pm j \omega \sqrt{1 - \zeta^2}

    Args:
        M: Mass matrix, shape (n, n), positive definite.
        D: Damping matrix, shape (n, n).
        K: Stiffness matrix, shape (n, n).
    """
    roots = _roots(M, D, K)
    rates = np.abs(roots)
    ringing = roots.imag > 1e-9 * rates.max()
    return sorted(
        Mode(rate / (2.0 * np.pi), -root.real / rate) for rate, root in zip(rates[ringing], roots[ringing], strict=True)
    )


def largest_rate(M: FloatArray, D: FloatArray, K: FloatArray) -> float:
    """Return the largest magnitude of s in find_modes, in 1/s; K and D can be singular."""
    return float(np.abs(_roots(M, D, K)).max())


def _roots(M: FloatArray, D: FloatArray, K: FloatArray) -> NDArray[np.complex128]:
    n = len(M)
    slopes = np.linalg.solve(M, np.hstack([-K, -D]))
    return np.asarray(np.linalg.eigvals(np.vstack([np.eye(n, 2 * n, n), slopes])), dtype=np.complex128)


@dataclass(frozen=True)
class Beam:
    """Link with bending flexibility.

    Attributes:
        EI: Bending stiffness, in N m^2, the same in both planes.
        mass: Mass uniformly distributed along the link, in addition to that in the robot's file, in kg.
    """

    EI: float
    mass: float


def moving_links(arm: RobotModel) -> dict[str, int]:
    """Return the index of the moving joint in Pinocchio's model by the name of its link."""
    model = arm.pin_model
    return {
        frame.name: frame.parentJoint
        for frame in model.frames
        if frame.type == pin.FrameType.BODY and model.frames[frame.parentFrame].type == pin.FrameType.JOINT
    }


def span(arm: RobotModel, joint: int, flange: str) -> FloatArray:
    """Return the end of the link that a joint moves, in its frame, shape (3,), in m.

    The end is the position of the next joint, or the flange for the last link.
    """
    model = arm.pin_model
    children = [model.jointPlacements[j] for j in range(joint + 1, model.njoints) if model.parents[j] == joint]
    end: FloatArray = (children or [model.frames[model.getFrameId(flange)].placement])[0].translation.copy()
    return end


@dataclass(frozen=True)
class Part:
    """Rigid segment of a link.

    Attributes:
        begin: Start of the segment along the link, in m.
        end: End of the segment along the link, in m.
    """

    begin: float
    end: float

    def rod(self, beam: Beam, length: float, along: FloatArray) -> "pin.Inertia":
        """Return the inertia of a segment of a beam, as a thin rod, about its start."""
        own = self.end - self.begin
        mass = beam.mass * own / length
        across = np.eye(3) - np.outer(along, along)
        return pin.Inertia(mass, 0.5 * own * along, mass * own**2 / 12.0 * across)


def parts_of(length: float, count: int) -> list[Part]:
    """Return the `count` + 1 rigid segments of a link with springs in the middle of `count` equal lengths."""
    cuts = (np.arange(count) + 0.5) * length / count
    return [Part(*ends) for ends in zip([0.0, *cuts], [*cuts, length], strict=True)]


def stiffen_robot(robot: Robot, beams: Mapping[str, Beam]) -> Robot:
    """Return a robot whose rigid links have the masses of beams along them."""
    links = moving_links(robot.model)
    rods = [
        (joint, Part(0.0, length).rod(beam, length, end / length))
        for joint, beam in ((links[name], beam) for name, beam in beams.items())
        for end in [span(robot.model, joint, robot.flange)]
        for length in [float(np.linalg.norm(end))]
    ]

    def loaded(model: RobotModel, joints: slice, _: bool) -> RobotModel:
        def load(own: "pin.Model") -> None:
            for joint, rod in rods:
                if joints.start < joint <= joints.stop:
                    own.appendBodyToJoint(joint - joints.start, rod, pin.SE3.Identity())

        return model.with_change(load)

    return with_models(robot, loaded)


@dataclass(frozen=True)
class Chain:
    """Arm with springs in its links.

    Attributes:
        pin_model: Model of the rigid bodies; its frames have the same names as in the rigid arm.
        motors: Indices of the coordinates of the arm's joints, shape (nq,).
        springs: Indices of the coordinates of the springs, shape (k,).
        stiffness: Stiffness of the springs, shape (k,), in N m/rad.
    """

    pin_model: "pin.Model"
    motors: np.ndarray
    springs: np.ndarray
    stiffness: FloatArray

    def mass_matrix(self, q: FloatArray) -> FloatArray:
        """Return the mass matrix M of motors and springs with straight links, shape (nq + k, nq + k), in kg m^2.

        Args:
            q: Joint positions, shape (nq,), in rad.
        """
        model, straight = self.pin_model, np.zeros(self.pin_model.nq)
        straight[self.motors] = q
        M = np.triu(pin.crba(model, model.createData(), straight))
        whole: FloatArray = M + np.triu(M, 1).T
        return whole


def cut(arm: RobotModel, flange: str, beams: Mapping[str, Beam], parts: int) -> Chain:
    """Return an arm with flexible links.

    Each flexible link has n equal lengths with two springs n EI/L in the middle of each, one for each plane. Static
    deflections under a force at the end are too small by 1/(4 n^2), and frequencies converge from above as 1/n^2. The
    link's inertia from the robot's file stays together, on the segment that contains its centre of mass.

    Args:
        arm: The rigid arm.
        flange: Frame at the end of the last link.
        beams: Flexible links by name; their lengths must not be zero.
        parts: Number n of equal lengths in each flexible link.
    """
    old, made = arm.pin_model, _Making(pin.Model())
    new, names = made.model, {joint: name for name, joint in moving_links(arm).items()}
    new.gravity = old.gravity
    links = [_Link((0,), np.zeros(0), np.zeros(3))]
    motors = []
    for joint in range(1, old.njoints):
        parent, placement = links[old.parents[joint]].place(old.jointPlacements[joint])
        first = new.addJoint(parent, old.joints[joint], placement, old.names[joint])
        motors.append(new.joints[first].idx_q)
        beam = beams.get(names[joint])
        if beam is None:
            links.append(_Link((first,), np.zeros(0), np.zeros(3)))
        else:
            end = span(arm, joint, flange)
            axes = _planes(old, joint, end / np.linalg.norm(end))
            links.append(made.beam(beam, first, end, axes, parts))
        part, begin = links[-1].part(old.inertias[joint].lever)
        new.appendBodyToJoint(part, old.inertias[joint], pin.SE3(np.eye(3), -begin))
    for frame in list(old.frames)[1:]:
        part, placement = links[frame.parentJoint].place(frame.placement)
        new.addFrame(pin.Frame(frame.name, part, 0, placement, pin.FrameType.OP_FRAME), False)
    return Chain(new, np.array(motors), np.array(made.springs), np.array(made.stiffness))


@dataclass(frozen=True)
class _Link:
    """Segments of a link: joint index of each, starts of all except the first, and direction of the link."""

    joints: tuple[int, ...]
    cuts: FloatArray
    along: FloatArray

    def place(self, placement: "pin.SE3") -> "tuple[int, pin.SE3]":
        """Return the joint of the segment that contains a placement of the rigid link, and its placement there."""
        part, begin = self.part(placement.translation)
        return part, pin.SE3(placement.rotation, placement.translation - begin)

    def part(self, point: FloatArray) -> tuple[int, FloatArray]:
        """Return the joint of the segment that contains a point of the link, and its start, shape (3,), in m."""
        number = int(np.searchsorted(self.cuts, self.along @ point))
        return self.joints[number], (self.cuts[number - 1] if number else 0.0) * self.along


@dataclass
class _Making:
    """Chain under construction.

    Attributes:
        model: The bodies so far.
        springs: The coordinates of the springs so far.
        stiffness: The stiffness of the springs so far, in N m/rad.
    """

    model: "pin.Model"
    springs: list[int] = field(default_factory=list)
    stiffness: list[float] = field(default_factory=list)

    def beam(self, beam: Beam, first: int, end: FloatArray, axes: tuple[FloatArray, FloatArray], count: int) -> _Link:
        """Add the segments of a link that bends about two axes, from a first segment that a joint moves to an end."""
        length = float(np.linalg.norm(end))
        along, pieces, joints = end / length, parts_of(length, count), [first]
        for before, piece in pairwise(pieces):
            hinge, last = pin.SE3(np.eye(3), (piece.begin - before.begin) * along), joints[-1]
            for plane, axis in zip("uv", axes, strict=True):
                name = f"{self.model.names[first]}_spring{len(joints)}{plane}"
                last = self.model.addJoint(last, pin.JointModelRevoluteUnaligned(axis), hinge, name)
                hinge = pin.SE3.Identity()
                self.springs.append(self.model.joints[last].idx_q)
                self.stiffness.append(count * beam.EI / length)
            joints.append(last)
        for joint, piece in zip(joints, pieces, strict=True):
            self.model.appendBodyToJoint(joint, piece.rod(beam, length, along), pin.SE3.Identity())
        return _Link(tuple(joints), np.array([piece.begin for piece in pieces[1:]]), along)


def _planes(model: "pin.Model", joint: int, along: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the bending axes of a link: the projection of its joint axis perpendicular to the link, and the other."""
    data = model.joints[joint].createData()
    model.joints[joint].calc(data, np.zeros(1))
    S = np.asarray(data.S).ravel()
    axis = S[3:] if np.any(S[3:]) else S[:3]
    across = axis - (axis @ along) * along
    if np.linalg.norm(across) < 0.1:
        across = np.cross(along, np.eye(3)[np.abs(along).argmin()])
    u = across / np.linalg.norm(across)
    return u, np.cross(along, u)
