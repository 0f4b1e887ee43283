"""Made-up arms, and equivalent ways to write each of them as a URDF."""

from dataclasses import dataclass

import numpy as np
import pinocchio as pin


@dataclass(frozen=True)
class MadeJoint:
    """A joint and its child link; axis and inertia are in the frame of that link."""

    prismatic: bool
    place: pin.SE3
    axis: np.ndarray
    limits: tuple[float, float]
    inertia: pin.Inertia


@dataclass(frozen=True)
class MadeArm:
    """Joints from the base outwards, and the tip in the frame of the last link."""

    joints: tuple[MadeJoint, ...]
    tip: pin.SE3


def random_place(generator, size=0.3):
    turn = pin.Quaternion(generator.normal(size=4)).normalized().toRotationMatrix()
    return pin.SE3(turn, generator.uniform(-size, size, 3))


def make_arm(generator):
    """An arm of 2 to 7 joints; some axes are the format's default, x, and some frames parallel."""
    joints = []
    for number in range(generator.integers(2, 8)):
        place, axis = random_place(generator), generator.normal(size=3)
        if generator.random() < 0.4:
            place = pin.SE3(np.eye(3), place.translation)
        if generator.random() < 0.4:
            axis = np.array([1.0, 0.0, 0.0])
        prismatic = bool(number and generator.random() < 0.2)
        bound = 0.4 if prismatic else 2.8
        limits = -bound * generator.uniform(0.8, 1.0), bound * generator.uniform(0.8, 1.0)
        moments = generator.uniform(0.002, 0.02, 3)
        moments = moments.sum() - moments  # of second moments of the mass: each at most the sum of the others
        turn = random_place(generator).rotation
        mass, centre = generator.uniform(0.5, 3.0), generator.uniform(-0.1, 0.1, 3)
        inertia = pin.Inertia(mass, centre, turn @ np.diag(moments) @ turn.T)
        joints.append(MadeJoint(prismatic, place, axis / np.linalg.norm(axis), limits, inertia))
    return MadeArm(tuple(joints), random_place(generator))


class Writer:
    """One way to write arms: notation is drawn at each element, if `plain` is false.

    Attributes:
        signs: 1, or -1 for each joint that is written with the opposite axis.
    """

    def __init__(self, generator, plain=False):
        self._generator, self._plain = generator, plain
        self.signs: list[float] = []

    def write(self, arm):
        links, joints, version = ['<link name="l0"/>'], [], ""
        for number, joint in enumerate(arm.joints, start=1):
            rest, child = self._split(joint.inertia)
            links.append(f'<link name="l{number}">{self._inertial(rest)}</link>')
            joints.append(self._moving(number, joint))
            if child is not None:
                place = random_place(self._generator)
                links.append(f'<link name="c{number}">{self._inertial(place.actInv(child))}</link>')
                joints.append(self._fixed(f"f{number}", f"l{number}", f"c{number}", place))
        links.append('<link name="tip"/>')
        joints.append(self._fixed("end", f"l{len(arm.joints)}", "tip", arm.tip))
        parts = [*links, *joints]
        if self._differs():
            self._generator.shuffle(parts)
        text = "\n".join(parts)
        version = ' version="1.1"' if "quat_xyzw" in text else ""
        return f'<robot name="made"{version}>\n{text}\n</robot>'

    def _differs(self):
        return not self._plain and self._generator.random() < 0.5

    def _number(self, value):
        return f" {float(value)!r} " if self._differs() else repr(float(value))

    def _vector(self, values):
        return ("  " if self._differs() else " ").join(map(self._number, values))

    def _origin(self, place):
        attributes = (
            [] if not place.translation.any() and self._differs() else [f'xyz="{self._vector(place.translation)}"']
        )
        if np.array_equal(place.rotation, np.eye(3)) and self._differs():
            pass  # the default
        elif self._differs():
            quaternion = pin.Quaternion(place.rotation).coeffs() * self._generator.choice([-1.0, 1.0])
            attributes.append(f'quat_xyzw="{self._vector(quaternion)}"')
        else:
            attributes.append(f'rpy="{self._vector(pin.rpy.matrixToRpy(place.rotation))}"')
        return f"<origin {' '.join(attributes)}/>" if attributes else ""

    def _split(self, inertia):
        """Half of the body may be another link, behind a fixed joint."""
        if not self._differs():
            return inertia, None
        half = pin.Inertia(0.5 * inertia.mass, inertia.lever, 0.5 * inertia.inertia)
        return half, half

    def _inertial(self, inertia):
        turn = random_place(self._generator).rotation if self._differs() else np.eye(3)
        tensor = turn.T @ inertia.inertia @ turn
        values = zip(("ixx", "ixy", "ixz", "iyy", "iyz", "izz"), tensor[np.triu_indices(3)], strict=True)
        moments = " ".join(f'{key}="{self._number(value)}"' for key, value in values)
        origin = self._origin(pin.SE3(turn, inertia.lever))
        return f'<inertial>{origin}<mass value="{self._number(inertia.mass)}"/><inertia {moments}/></inertial>'

    def _moving(self, number, joint):
        (lower, upper), axis = joint.limits, joint.axis
        sign = -1.0 if self._differs() else 1.0
        self.signs.append(sign)
        if sign < 0.0:
            axis, lower, upper = -axis, -upper, -lower
        length = 10.0 ** self._generator.uniform(-1.0, 1.0) if self._differs() else 1.0
        missing = np.array_equal(axis, [1.0, 0.0, 0.0]) and self._differs()
        written = "" if missing else f'<axis xyz="{self._vector(axis * length)}"/>'
        effort = "inf" if self._differs() else "1e6"
        return (
            f'<joint name="q{number}" type="{"prismatic" if joint.prismatic else "revolute"}">'
            f'<parent link="l{number - 1}"/><child link="l{number}"/>{self._origin(joint.place)}{written}'
            f'<limit lower="{self._number(lower)}" upper="{self._number(upper)}" effort="{effort}" velocity="1e6"/>'
            "</joint>"
        )

    def _fixed(self, name, parent, child, place):
        ends = f'<parent link="{parent}"/><child link="{child}"/>'
        return f'<joint name="{name}" type="fixed">{ends}{self._origin(place)}</joint>'
