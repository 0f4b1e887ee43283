"""Arms with flexible links, as chains of rigid segments and springs."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np
import pinocchio as pin

from runner.base.arrays import FloatArray
from runner.robots.beams import Beam, moving_links, parts_of, span
from runner.robots.model import RobotModel


@dataclass(frozen=True)
class Chain:
    """An arm with springs in its links.

    Attributes:
        pin_model: Its rigid bodies; frames have the names that they have in the rigid arm.
        motors: Which coordinates are the arm's joints, shape (nq,).
        springs: Which ones are springs, shape (k,).
        stiffness: Of the springs, shape (k,), in N m/rad.
    """

    pin_model: pin.Model
    motors: np.ndarray
    springs: np.ndarray
    stiffness: FloatArray

    def mass_matrix(self, q: FloatArray) -> FloatArray:
        """Return M of motors and springs with straight links, shape (nq + k, nq + k), in kg m^2.

        Args:
            q: Joint positions, shape (nq,), in rad.
        """
        model, straight = self.pin_model, np.zeros(self.pin_model.nq)
        straight[self.motors] = q
        M = np.triu(pin.crba(model, model.createData(), straight))
        whole: FloatArray = M + np.triu(M, 1).T
        return whole


def cut(arm: RobotModel, flange: str, beams: Mapping[str, Beam], parts: int) -> Chain:
    """Return an arm with links that bend.

    Each is cut into equal lengths, with springs n EI/L in the middle of each, one for each plane: static deflections
    under a force at its end fall short by 1/(4 n^2), and frequencies converge from above as 1/n^2. What the robot's
    file gives of the link stays in one piece, on the part that holds its centre of mass.

    Args:
        arm: The rigid arm.
        flange: Frame at which its last link ends.
        beams: The links that bend, by name; they have a length.
        parts: Springs along each, n.
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
    """The parts of a link: the number of the joint that moves each, where all but the first begin, and a direction."""

    joints: tuple[int, ...]
    cuts: FloatArray
    along: FloatArray

    def place(self, placement: pin.SE3) -> tuple[int, pin.SE3]:
        """Return the part on which a place of the rigid link stands, and the place in that part's frame."""
        part, begin = self.part(placement.translation)
        return part, pin.SE3(placement.rotation, placement.translation - begin)

    def part(self, point: FloatArray) -> tuple[int, FloatArray]:
        """Return the part that holds a point of the link, and where it begins, shape (3,), in m."""
        number = int(np.searchsorted(self.cuts, self.along @ point))
        return self.joints[number], (self.cuts[number - 1] if number else 0.0) * self.along


@dataclass
class _Making:
    """A chain that is being made.

    Attributes:
        model: Its bodies so far.
        springs: The coordinates of its springs so far.
        stiffness: Of these, in N m/rad.
    """

    model: pin.Model
    springs: list[int] = field(default_factory=list)
    stiffness: list[float] = field(default_factory=list)

    def beam(self, beam: Beam, first: int, end: FloatArray, axes: tuple[FloatArray, FloatArray], count: int) -> _Link:
        """Add the parts of a link that bends about two axes, of which a joint moves the first; it ends at a place."""
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


def _planes(model: pin.Model, joint: int, along: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the axes about which a link bends: the nearest to its joint's axis across it, and the other."""
    data = model.joints[joint].createData()
    model.joints[joint].calc(data, np.zeros(1))
    S = np.asarray(data.S).ravel()
    axis = S[3:] if np.any(S[3:]) else S[:3]
    across = axis - (axis @ along) * along
    if np.linalg.norm(across) < 0.1:
        across = np.cross(along, np.eye(3)[np.abs(along).argmin()])
    u = across / np.linalg.norm(across)
    return u, np.cross(along, u)
