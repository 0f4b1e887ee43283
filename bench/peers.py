"""MuJoCo in a Python loop, the peer of both plants.

- implicitfast, next to bullet: MuJoCo's own tip, Jacobian, its derivative, mass matrix and bias make the law. A plain
  loop, with NumPy's solve and clip and a call for every step, is the target. A trimmed one shows what is left to gain.
- RK4, one step in a tick, next to rk4: Pinocchio makes the law, in one pass over the arm, trimmed.

Trimmed is: LAPACK without checks, results written in place, one call for the further steps of a tick. All run the law
of bench/tip_loop.py with its limits and a log, and leave out what costs more: noise, the weighting of the null space by
the mass matrix, damping near singular configurations, guards, and a trace that metrics can read.
"""

import xml.etree.ElementTree as ET
from collections.abc import Callable
from typing import Any

import mujoco
import numpy as np
import pinocchio as pin
from scipy.linalg.lapack import dgesv

from bench.tip_loop import FloatArray, TipLoop

_EPSILON = "1e-9"  # kg and kg m^2 of links without mass, which MuJoCo does not take
_COMPILER = {
    "balanceinertia": "true",
    "boundmass": _EPSILON,
    "boundinertia": _EPSILON,
    "discardvisual": "true",
    "strippath": "true",
    "fusestatic": "false",
}


def mujoco_model(loop: TipLoop, step: float, integrator: str) -> Any:
    """Return MuJoCo's model of an arm, with nothing in its joints and nothing that it can touch, as the runner's.

    Args:
        loop: The closed loop.
        step: Integration step, in s.
        integrator: "implicitfast" or "RK4".
    """
    root = ET.fromstring(loop.urdf)  # noqa: S314 - our own text
    for link in root.iter("link"):
        for shape in [*link.findall("visual"), *link.findall("collision")]:
            link.remove(shape)
    ET.SubElement(ET.SubElement(root, "mujoco"), "compiler", _COMPILER)
    model = mujoco.MjModel.from_xml_string(ET.tostring(root, encoding="unicode"))
    model.opt.timestep = step
    model.opt.integrator = getattr(mujoco.mjtIntegrator, f"mjINT_{integrator.upper()}")
    model.opt.gravity[:] = 0.0, 0.0, -loop.gravity
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONSTRAINT
    model.dof_damping[:], model.dof_frictionloss[:] = 0.0, 0.0
    return model


def plain_loop(loop: TipLoop, substeps: int) -> tuple[Callable[[], None], FloatArray]:
    """Return a function that runs a plainly written closed loop by only MuJoCo, and the log that it fills.

    Args:
        loop: The closed loop; see TipLoop.log.
        substeps: Integration steps in a tick.
    """
    model = mujoco_model(loop, loop.tick / substeps, "implicitfast")
    data, tip, nq = mujoco.MjData(model), model.body(loop.tip).id, model.nv
    J, dJ, M, log = np.zeros((3, nq)), np.zeros((3, nq)), np.zeros((nq, nq)), loop.log()
    k_p, k_v, posture_p, posture_v = loop.law.tolist()

    def run() -> None:
        mujoco.mj_resetData(model, data)
        data.qpos[:] = loop.start
        for k, (x_d, dx_d, ddx_d) in enumerate(loop.desired):
            mujoco.mj_step1(model, data)
            q, dq, x = data.qpos, data.qvel, data.xpos[tip]
            mujoco.mj_jacBody(model, data, J, None, tip)
            mujoco.mj_jacDot(model, data, dJ, None, x, tip)
            mujoco.mj_fullM(model, data, M)
            F = ddx_d + k_v * (dx_d - J @ dq) + k_p * (x_d - x) - dJ @ dq
            if nq == 3:
                ddq = np.linalg.solve(J, F)
            else:
                a_0 = -posture_v * dq - posture_p * loop.held * (q - loop.rest)
                ddq = a_0 + J.T @ np.linalg.solve(J @ J.T, F - J @ a_0)
            tau = np.clip(M @ ddq + data.qfrc_bias, -loop.limits, loop.limits)
            log[k] = q, dq, tau
            data.qfrc_applied[:] = tau
            if k < loop.ticks:
                mujoco.mj_step2(model, data)
                for _ in range(substeps - 1):
                    mujoco.mj_step(model, data)

    return run, log


def trimmed_loop(loop: TipLoop, substeps: int) -> tuple[Callable[[], None], FloatArray]:
    """Return a function that runs a trimmed closed loop by only MuJoCo, and its log; see plain_loop."""
    model = mujoco_model(loop, loop.tick / substeps, "implicitfast")
    data, tip, nq = mujoco.MjData(model), model.body(loop.tip).id, model.nv
    J, dJ, weighed, log = np.zeros((3, nq)), np.zeros((3, nq)), np.zeros(nq), loop.log()
    q, dq, x, bias, applied = data.qpos, data.qvel, data.xpos[tip], data.qfrc_bias, data.qfrc_applied
    limits, lowest, law = loop.limits, -loop.limits, _law(loop)

    def run() -> None:
        mujoco.mj_resetData(model, data)
        q[:] = loop.start
        for k, reference in enumerate(loop.desired):
            mujoco.mj_step1(model, data)
            mujoco.mj_jacBody(model, data, J, None, tip)
            mujoco.mj_jacDot(model, data, dJ, None, x, tip)
            mujoco.mj_mulM(model, data, weighed, law(reference, q, dq, x, J, dJ.dot(dq)))
            tau = weighed + bias
            np.minimum(tau, limits, out=tau)
            np.maximum(tau, lowest, out=tau)
            row = log[k]
            row[0], row[1], row[2] = q, dq, tau
            applied[:] = tau
            if k < loop.ticks:
                mujoco.mj_step2(model, data)
                if substeps > 1:
                    mujoco.mj_step(model, data, substeps - 1)

    return run, log


def rk4_loop(loop: TipLoop) -> tuple[Callable[[], None], FloatArray]:
    """Return a function that runs MuJoCo's Runge-Kutta step with a law through Pinocchio, and its log."""
    model, arm = mujoco_model(loop, loop.tick, "RK4"), pin.buildModelFromXML(loop.urdf)
    arm.gravity.linear = np.array([0.0, 0.0, -loop.gravity])
    data, known, log = mujoco.MjData(model), arm.createData(), loop.log()
    q, dq, applied, rest, tip = data.qpos, data.qvel, data.qfrc_applied, np.zeros(arm.nv), arm.getFrameId(loop.tip)
    limits, lowest, law, world = loop.limits, -loop.limits, _law(loop), pin.LOCAL_WORLD_ALIGNED
    x = known.oMf[tip].translation  # a view

    def run() -> None:
        mujoco.mj_resetData(model, data)
        q[:] = loop.start
        for k, reference in enumerate(loop.desired):
            pin.forwardKinematics(arm, known, q, dq, rest)
            pin.computeJointJacobians(arm, known)
            pin.updateFramePlacement(arm, known, tip)
            J = pin.getFrameJacobian(arm, known, tip, world)[:3]
            drift = pin.getFrameClassicalAcceleration(arm, known, tip, world).linear
            tau = pin.rnea(arm, known, q, dq, law(reference, q, dq, x, J, drift))
            np.minimum(tau, limits, out=tau)
            np.maximum(tau, lowest, out=tau)
            row = log[k]
            row[0], row[1], row[2] = q, dq, tau
            applied[:] = tau
            if k < loop.ticks:
                mujoco.mj_step(model, data)

    return run, log


def _law(loop: TipLoop) -> Callable[..., FloatArray]:
    """Return the law as an acceleration of the joints, of a reference, q, dq, x, J and dJ/dt dq."""
    k_p, k_v, posture_p, posture_v = loop.law.tolist()
    weights, gains = np.array([k_p, k_v, 1.0]), np.full(3, k_p)
    damping, pull, rest = np.full(3, k_v), posture_p * loop.held, loop.rest

    def square(reference: Any, q: Any, dq: Any, x: Any, J: Any, drift: Any) -> FloatArray:
        F = weights.dot(reference) - gains * x - damping * J.dot(dq) - drift
        return np.asarray(dgesv(J, F)[2])

    def redundant(reference: Any, q: Any, dq: Any, x: Any, J: Any, drift: Any) -> FloatArray:
        a_0 = pull * (rest - q) - posture_v * dq
        F = weights.dot(reference) - gains * x - damping * J.dot(dq) - drift - J.dot(a_0)
        return np.asarray(a_0 + J.T.dot(dgesv(J.dot(J.T), F)[2]))

    return square if len(rest) == 3 else redundant
