"""Direct-current motors of an MJCF: stall torque and no-load speed at their joints."""

import xml.etree.ElementTree as ET
from collections.abc import Iterable
from typing import Any, NamedTuple

import mujoco

from runner.robots.elements import numbers


class MotorLimits(NamedTuple):
    """Limits of a motor at its joint; None if the file does not give its voltage.

    Attributes:
        stall_torque: Torque at standstill, in N m; N for prismatic joints.
        no_load_speed: Speed at which the back-EMF equals the voltage, in rad/s; m/s for prismatic joints.
    """

    stall_torque: float | None
    no_load_speed: float | None


def motor_limits(model: Any, roots: Iterable[ET.Element]) -> dict[int, MotorLimits]:
    r"""Return the limits of each `<dcmotor>` by index of the actuator.

    Its torque on the joint is :math:`\tau = n K (u - K n \dot q) / R` with gear ratio n, motor constant K, resistance R
    and voltage u, at most that of `ctrlrange`, or else that of `nominal`.

    Args:
        model: MuJoCo's compiled model.
        roots: Root elements of the file and its included files.
    """
    voltages = {
        motor.get("name"): values[0]
        for root in roots
        for motor in root.iter("dcmotor")
        if (values := numbers(motor.get("nominal", "")))
    }
    found = {}
    for actuator in range(model.nactuator):
        if model.actuator_dyntype[actuator] == mujoco.mjtDyn.mjDYN_DCMOTOR:
            resistance, constant = model.actuator_gainprm[actuator, :2]
            gear = abs(float(model.actuator_gear[actuator, 0]))
            limited = bool(model.actuator_ctrllimited[actuator])
            name = model.actuator(actuator).name
            voltage = min(abs(model.actuator_ctrlrange[actuator])) if limited else voltages.get(name)
            found[actuator] = MotorLimits(None, None)
            if voltage and gear:
                stall, speed = gear * constant * voltage / resistance, voltage / (constant * gear)
                found[actuator] = MotorLimits(float(stall), float(speed))
    return found
