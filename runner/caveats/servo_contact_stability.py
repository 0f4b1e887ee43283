"""Contact stability of an admittance with joint servos, from the linear map of the whole loop.

With ideal joints, only filter and wall determine stability (`runner/controllers/stability.py`). With
servos, the arm's masses and the servo stiffness act between them. The map therefore covers one controller period tick
by tick, for small motions about the initial configuration. It includes reading, filter, inverse kinematics, set-points,
servos, arm and wall. It assumes permanent contact, no active limits, no joint friction, and an exact nominal model.
"""

from dataclasses import dataclass, replace

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.lazy_modules import pin
from runner.controllers.force.admittance_filter import Admittance, discretise, held_map
from runner.controllers.stability import critical_value, spectral_radius
from runner.plants.servo import ServoLaw
from runner.robots.mounting import find_tool
from runner.robots.robot import Robot

_STEP = 1e-5  # rad and rad/s, for finite differences
_ROUNDING = 1e-9  # of the spectral radius, which is 1 for an axis without spring
_REACHED = 1e-3  # relative to the largest singular value of the tip's Jacobian: below it a configuration is singular


@dataclass(frozen=True)
class ServoContact:
    """An arm with joint servos in contact with a wall, under admittance control.

    Attributes:
        arm: The robot.
        q: Configuration, shape (nq,), in rad, at which the tip touches the wall.
        servo: Control law of the servos.
        step: Integration step of the plant, in s.
        steps: Integration steps in a tick of the servos.
        tick: Period of the servos, in s.
        ticks: Ticks in a period of the controller.
        delay: Ticks from a command until it acts.
        interpolate: True if set-points move at constant speed between commands, False if they jump.
        implicit: True if the plant computes the contact in each step from the velocity at its end, for example
            PyBullet. False if the wall's force is held for a tick and the arm is integrated exactly.
        law: The admittance.
        at_tip: True if the measured moment is about the tip, False if about the flange.
        inertia: True if the tool's inertial wrench is subtracted from the reading, with velocities a controller period
            apart.
        seen: Fraction of a change of the load that the reading follows within a tick: 1 without a low-pass.
        normal: Unit vector out of the wall, shape (3,).
        stiffness: Stiffness of the wall, in N/m.
        damping: Damping of the wall, in N s/m.
    """

    arm: Robot
    q: FloatArray
    servo: ServoLaw
    step: float
    steps: int
    tick: float
    ticks: int
    delay: int
    interpolate: bool
    implicit: bool
    law: Admittance
    at_tip: bool
    inertia: bool
    seen: float
    normal: FloatArray
    stiffness: float
    damping: float


def contact_map(contact: ServoContact) -> FloatArray:
    """Return the matrix that maps small motions in contact from one tick of the controller to the next.

    The state contains joint positions, velocities, velocities a tick before and at the controller's last tick, and
    set-points. It also contains the sensor's reading, the filter's displacement and velocity, and the delayed commands.

    Raises:
        numpy.linalg.LinAlgError: in a singular configuration.
    """
    law, n, ticks = contact.law, contact.arm.model.nq, contact.ticks
    period = ticks * contact.tick
    J = contact.arm.model.tip_jacobian(contact.q)
    values = np.linalg.svd(J, compute_uv=False)
    if values[-1] < _REACHED * values[0]:
        raise np.linalg.LinAlgError
    J_inverse = np.linalg.pinv(J)
    press, moved = _wrenches(contact, J)
    pull, slow, towards, along = _servo_gradients(contact)
    stay, push = _arm(contact, J)
    late, rest = divmod(contact.delay, ticks)
    Phi, Gamma = discretise(law, period)
    sizes = np.cumsum([n, n, n, n, n, 6, 6, 6] + [n] * (late + (rest > 0)))
    whole = np.eye(sizes[-1])
    q, dq, before, last, point, reading, x, dx, *commands = np.split(whole, sizes[:-1])
    wall = -(contact.stiffness * J[:3].T @ contact.normal)[:, None] * (contact.normal @ J[:3])
    damper = wall * (contact.damping / contact.stiffness)
    for tick in range(ticks):
        # sensor load in each tick: the wall, and the tool's inertia
        load = press @ (contact.stiffness * q + contact.damping * dq) - moved @ (dq - before) / contact.tick
        reading = reading + contact.seen * (load - reading)
        before = dq
        if tick == 0:
            wrench = reading + moved @ (dq - last) / period if contact.inertia else reading
            last = dq
            x, dx = (Phi[:, i, 0, None] * x + Phi[:, i, 1, None] * dx + Gamma[:, i, None] * wrench for i in (0, 1))
            commands = [J_inverse @ x, *commands]
        acting = commands[late if tick >= rest else late + 1]
        left = ticks - (tick - rest) % ticks if contact.interpolate else 1
        way = (acting - point) / left
        point = point + way
        tau = pull @ q + slow @ dq + towards @ point
        if contact.interpolate:
            tau = tau + along @ way / contact.tick
        if not contact.implicit:
            tau = tau + wall @ q + damper @ dq
        q, dq = np.split(stay @ np.vstack([q, dq]) + push @ tau, 2)
    return np.vstack([q, dq, before, last, point, reading, x, dx, *commands[: late + (rest > 0)]])


def contact_radius(contact: ServoContact) -> float:
    """Return the spectral radius of the contact map; below 1 it is stable, and an axis without spring gives 1.

    Raises:
        numpy.linalg.LinAlgError: in a singular configuration.
    """
    return spectral_radius(contact_map(contact))


def stiffest_servo_wall(contact: ServoContact) -> float | None:
    """Return the wall stiffness above which contact is unstable, in N/m; 0 if below 100, None if above 10^7.

    Raises:
        numpy.linalg.LinAlgError: in a singular configuration.
    """

    def radius(exponent: float) -> float:
        return contact_radius(replace(contact, stiffness=10.0**exponent))

    exponent = critical_value(radius, np.linspace(2.0, 7.0, 41).tolist(), _ROUNDING, 1e-5)
    return None if exponent == np.inf else 10.0**exponent


def _wrenches(contact: ServoContact, J: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the wrenches on the tool by joint, along the base's axes about the law's reference point.

    Returns:
        Wrench of the wall for unit stiffness and joint displacement, and wrench that accelerates the tool for unit
            joint acceleration, shapes (6, nq).
    """
    model, q = contact.arm.model.pin_model, contact.q
    data = model.createData()
    flange = model.getFrameId(contact.arm.flange)
    of_flange = pin.computeFrameJacobian(model, data, q, flange, pin.LOCAL)
    pin.framesForwardKinematics(model, data, q)  # the Jacobian does not update poses in the base frame
    place, tip = data.oMf[flange], data.oMf[contact.arm.model.tip_frame].translation
    about = tip if contact.at_tip else place.translation
    force = -np.concatenate([contact.normal, np.cross(tip - about, contact.normal)])
    to_point = pin.SE3(place.rotation, place.translation - about).toDualActionMatrix()
    moved: FloatArray = to_point @ find_tool(model, flange).matrix() @ of_flange
    return np.outer(force, contact.normal @ J[:3]), moved


def _servo_gradients(contact: ServoContact) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Return differences of the servo torques by q, dq, set-point and its velocity, shapes (nq, nq)."""
    zero = np.zeros_like(contact.q)
    at = (contact.q, zero, contact.q, zero)
    gradients = []
    for place in range(4):
        columns = []
        for unit in _STEP * np.eye(len(zero)):
            there, back = list(at), list(at)
            there[place], back[place] = at[place] + unit, at[place] - unit
            columns.append((contact.servo.torques(*there) - contact.servo.torques(*back)) / (2.0 * _STEP))
        gradients.append(np.column_stack(columns))
    return gradients[0], gradients[1], gradients[2], gradients[3]


def _arm(contact: ServoContact, J: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the map of the arm's state (q, dq) over a tick, from the state and from held torques.

    Returns:
        Shapes (2 nq, 2 nq) and (2 nq, nq).
    """
    model, q = contact.arm.model, contact.q
    n, h = model.nq, contact.step
    M = model.mass_matrix(q)
    weight = np.column_stack(
        [
            (model.gravity_torque(q + unit) - model.gravity_torque(q - unit)) / (2.0 * _STEP)
            for unit in _STEP * np.eye(n)
        ]
    )
    if not contact.implicit:
        A = np.block([[np.zeros((n, n)), np.eye(n)], [-np.linalg.solve(M, weight), np.zeros((n, n))]])
        return held_map(A, np.vstack([np.zeros((n, n)), np.linalg.inv(M)]), contact.steps * h)
    along = contact.normal @ J[:3]
    projector = np.outer(along, along)
    inverse = np.linalg.inv(M + h * (h * contact.stiffness + contact.damping) * projector)
    to_dq = np.hstack([-h * inverse @ (weight + contact.stiffness * projector), inverse @ M, h * inverse])
    whole = np.vstack([h * to_dq, to_dq, np.eye(n, 3 * n, 2 * n)])
    whole[:n, :n] += np.eye(n)
    whole = np.linalg.matrix_power(whole, contact.steps)
    return whole[: 2 * n, : 2 * n], whole[: 2 * n, 2 * n :]
