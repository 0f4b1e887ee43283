"""Fits of a log by mujoco.sysid and by figaroh, run as a script in an environment of their own.

Usage: python identification_peers.py sysid|figaroh LOG.npz ROBOT.urdf RESULT.json

The parameters of both are masses, first moments, viscous and Coulomb friction. CPU seconds exclude imports.
"""

import json
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

_CHUNK = 0.2  # s, of a rollout: an open loop drifts away in longer ones
_CUTOFF = 10.0  # Hz
FloatArray = NDArray[np.float64]
Log = dict[str, Any]


def _smooth(signals: FloatArray, period: float) -> FloatArray:
    from scipy.signal import butter, sosfiltfilt

    return sosfiltfilt(butter(4, _CUTOFF, fs=1.0 / period, output="sos"), signals, axis=0)


def _derivatives(log: Log, name: str) -> tuple[FloatArray, FloatArray, FloatArray]:
    q = _smooth(log[f"{name}_q"], log["period"])
    dq = np.gradient(q, log["period"], axis=0)
    return q, dq, np.gradient(dq, log["period"], axis=0)


def fit_by_sysid(log: Log, urdf: str) -> tuple[float, FloatArray]:
    """Return CPU seconds and the predicted torques of the second log."""
    import mujoco
    from mujoco import sysid
    from mujoco.sysid._src.timeseries import SignalType

    period, joints = float(log["period"]), [str(name) for name in log["joints"]]
    spec = mujoco.MjSpec.from_file(str(urdf))
    spec.option.timestep, spec.option.integrator = period, mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    spec.option.disableflags = mujoco.mjtDisableBit.mjDSBL_CONTACT | mujoco.mjtDisableBit.mjDSBL_LIMIT
    for joint, armature in zip(joints, log["armature"], strict=True):
        spec.joint(joint).armature = armature
        spec.add_actuator(name=f"motor_{joint}", target=joint, trntype=mujoco.mjtTrn.mjTRN_JOINT)
    begun = time.process_time()
    q, dq, _ = _derivatives(log, "train")
    tau = log["train_tau"]
    model = spec.compile()
    steps, edge = round(_CHUNK / period), round(0.2 / period)
    signals = [(f"{name}_qpos", 1, SignalType.MjStateQPos) for name in joints]
    starts = range(edge, len(q) - edge - steps, steps)
    times = period * np.arange(steps + 1)
    sequences = sysid.ModelSequences(
        "arm", spec, [f"part{start}" for start in starts],
        [sysid.create_initial_state(model, q[start], dq[start]) for start in starts],
        [sysid.TimeSeries(times, tau[start : start + steps + 1]) for start in starts],
        [sysid.TimeSeries.from_custom_map(times, q[start : start + steps + 1], signals) for start in starts],
        allow_missing_sensors=True,
    )  # fmt: skip
    parameters = sysid.ParameterDict()

    def add(name: str, value: Any, low: Any, high: Any, change: Any) -> None:
        parameters.add(sysid.Parameter(name, nominal=value, min_value=low, max_value=high, modifier=change))

    for joint in joints:
        body = spec.joint(joint).parent.name

        def set_mass(s: Any, p: Any, body: str = body) -> None:
            s.body(body).mass = p.value[0]

        def set_centre(s: Any, p: Any, body: str = body) -> None:
            s.body(body).ipos = p.value

        def set_damping(s: Any, p: Any, joint: str = joint) -> None:
            damping = np.zeros(np.size(s.joint(joint).damping))  # a polynomial in speed, the linear term first
            damping[0] = p.value[0]
            s.joint(joint).damping = damping

        def set_friction(s: Any, p: Any, joint: str = joint) -> None:
            s.joint(joint).frictionloss = p.value[0]

        mass, centre = spec.body(body).mass, np.array(spec.body(body).ipos)
        add(f"mass {body}", mass, 0.2 * mass, 3.0 * mass, set_mass)
        add(f"centre {body}", centre, centre - 0.2, centre + 0.2, set_centre)
        add(f"damping {joint}", 0.5, 0.0, 10.0, set_damping)
        add(f"friction {joint}", 0.5, 0.0, 10.0, set_friction)
    found, _ = sysid.optimize(
        parameters, sysid.build_residual_fn(models_sequences=[sequences], n_threads=1), "mujoco", verbose=False
    )
    seconds = time.process_time() - begun
    sysid.apply_param_modifiers_spec(found, spec)
    model = spec.compile()
    data, predicted = mujoco.MjData(model), []
    for row in zip(*(log[f"test_{name}"] for name in ("q", "dq", "ddq")), strict=True):
        data.qpos[:], data.qvel[:], data.qacc[:] = row
        mujoco.mj_inverse(model, data)
        predicted.append(data.qfrc_inverse.copy())  # damping and friction are in it
    return seconds, np.array(predicted)


def fit_by_figaroh(log: Log, urdf: str) -> tuple[float, FloatArray]:
    """Return CPU seconds and the predicted torques of the second log."""
    import tempfile

    import yaml
    from figaroh.identification.base_identification import BaseIdentification
    from figaroh.tools.regressor import build_regressor_basic
    from figaroh.tools.robot import Robot

    robot = Robot(str(urdf), package_dirs=str(Path(urdf).parent))
    joints = [str(name) for name in log["joints"]]
    config = {
        "schema_version": 1,
        "robot": {"name": "arm"},
        "tasks": {
            "identification": {
                "enabled": True,
                "joints": {"active_joints": joints},
                "problem": {"has_friction": True, "is_joint_torques": True, "has_joint_offset": True},
                "signal_processing": {"sampling_frequency": 1.0 / float(log["period"]), "cutoff_frequency": _CUTOFF},
            }
        },
    }

    class Fit(BaseIdentification):
        def load_trajectory_data(self, data_source: Any = None) -> dict[str, FloatArray]:
            q, dq, ddq = _derivatives(log, "train")
            edge = slice(200, -200)
            times = float(log["period"]) * np.arange(len(q))
            tau = _smooth(log["train_tau"], float(log["period"]))
            return {
                "timestamps": times[edge], "positions": q[edge], "velocities": dq[edge], "accelerations": ddq[edge],
                "torques": tau[edge],
            }  # fmt: skip

        def filter_kinematics_data(self, filter_config: Any = None) -> None:
            self.processed_data = {key: self.raw_data[key] for key in self.raw_data if key != "torques"}

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "arm.yaml"
        path.write_text(yaml.safe_dump(config))
        fit = Fit(robot, str(path))
    nq = len(joints)
    fit.identif_config.update(act_idxq=list(range(nq)), act_idxv=list(range(nq)), active_joints=joints)
    begun = time.process_time()
    fit.initialize()
    fit.solve(decimate=True, decimation_factor=50, plotting=False, wls=True)
    seconds = time.process_time() - begun
    W = build_regressor_basic(robot, log["test_q"], log["test_dq"], log["test_ddq"], fit.identif_config)
    W = np.delete(W, fit._idx_eliminated, axis=1)[:, fit._base_indices]
    predicted = (W @ fit.phi_base).reshape(nq, -1).T
    return seconds, predicted


def main() -> None:
    peer, log, urdf, result = sys.argv[1:]
    with np.load(log) as found:
        log = dict(found)
    seconds, predicted = {"sysid": fit_by_sysid, "figaroh": fit_by_figaroh}[peer](log, urdf)
    moving = np.abs(log["test_dq"]) > 0.05 * np.abs(log["test_dq"]).max(axis=0)
    error = np.linalg.norm((predicted - log["test_tau"])[moving]) / np.linalg.norm(log["test_tau"][moving])
    Path(result).write_text(json.dumps({"seconds": seconds, "error": error}))


if __name__ == "__main__":
    main()
