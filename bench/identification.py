"""Fit of a seven-joint arm to a log: CPU seconds and memory, next to mujoco.sysid and figaroh if PEERS=1.

With PEERS=1 the peers are installed in a temporary folder first, 1 and 0.7 GB, and fit the same log in turn, each
in at most 10 min. One of them has GPL parts, so neither is a dependency. All fit masses, first moments, viscous and
Coulomb friction.
"""

import json
import os
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import pinocchio as pin
import yaml
from numpy.typing import NDArray

from runner.assembly.validation import validate
from runner.config.compose.compose import compose
from runner.identification.examination import examine_logs, read_question
from runner.identification.fit import fit_logs
from runner.identification.identify import identify
from runner.identification.log_rows import log_rows
from runner.identification.parameters import ParameterSum, base_sums
from runner.recordings.equations import motion_of
from runner.robots.model import RobotModel

_ROBOT, _ROWS, _PERIOD = "xarm7", 20_000, 1e-3
_PEER_ROWS = 8_000  # of the log that the peers fit: rollouts take minutes
_SECONDS, _MEMORY = 5.0, 600.0  # targets, in s and MB
_PEERS = {"figaroh": ("figaroh==1.0.2", 1.0 / 5.0), "sysid": ("mujoco[sysid]==4.0.0", 1.0 / 20.0)}
_LONGEST = 600.0  # s that a peer's fit may take
_ERROR = 1.05  # times the better peer's
FloatArray = NDArray[np.float64]


def main(rounds: int | None = None) -> bool:
    """Print the table; return whether each target is met."""
    arm = validate(compose([f"robot={_ROBOT}"])).arm
    with tempfile.TemporaryDirectory() as folder:
        met = _whole(arm.model, arm.urdf, Path(folder))
        if os.environ.get("PEERS"):
            met &= _against_peers(arm.model, arm.urdf, Path(folder))
    return met


def _log(model: RobotModel, rows: int, seed: int) -> tuple[FloatArray, ...]:
    """Return positions, speeds, accelerations and torques of an arm whose links differ from those of its file."""
    truth, nq = np.random.default_rng(7), model.nq
    changed = pin.Model(model.pin_model)
    for joint, scale in enumerate(truth.uniform(0.8, 1.2, nq)):
        own = model.pin_model.inertias[joint + 1]
        changed.inertias[joint + 1] = pin.Inertia(
            own.mass * scale, own.lever + truth.uniform(-0.01, 0.01, 3), own.inertia
        )
    viscous, coulomb = truth.uniform(0.3, 1.5, nq), truth.uniform(0.3, 1.5, nq)
    random, t = np.random.default_rng(seed), _PERIOD * np.arange(rows)
    swing, speeds, phases = (random.uniform(*ends, (3, nq)) for ends in ((0.1, 0.4), (0.8, 5.0), (0.0, 6.28)))
    angles = t[:, None, None] * speeds + phases
    waves = (np.sin(angles), speeds * np.cos(angles), -(speeds**2) * np.sin(angles))
    q, dq, ddq = (np.sum(swing * wave, axis=1) for wave in waves)
    data = changed.createData()
    rigid = np.array([pin.rnea(changed, data, *row) for row in zip(q, dq, ddq, strict=True)])
    return q, dq, ddq, rigid + viscous * dq + coulomb * np.sign(dq)


def _noisy(signals: FloatArray, size: float, seed: int) -> FloatArray:
    return signals + size * np.random.default_rng(seed).normal(size=signals.shape)


def _whole(model: RobotModel, urdf: str, folder: Path) -> bool:
    """Print the time of an identification from the file on, and the memory of the process."""
    q, _, _, tau = _log(model, _ROWS, 1)
    q, tau = _noisy(q, 1e-5, 2), _noisy(tau, 0.3, 3)
    names = [f"{kind}_{joint}" for kind in ("q", "tau") for joint in model.joint_names]
    table = np.column_stack([_PERIOD * np.arange(_ROWS), q, tau])
    np.savetxt(folder / "log.csv", table, "%.7g", ",", header=",".join(["t", *names]), comments="")
    columns = {f"q_{joint}": {"joint": joint, "unit": "rad"} for joint in model.joint_names}
    columns |= {f"tau_{joint}": {"torque": joint, "unit": "N m"} for joint in model.joint_names}
    said = {"time": {"column": "t", "unit": "s"}, "torque": "instant", "columns": columns}
    (folder / "map.yaml").write_text(yaml.safe_dump(said))
    begun = time.process_time()
    question = read_question(_ROBOT, model, urdf, [folder / "log.csv"], [folder / "map.yaml"])
    identify(examine_logs(question), folder, "bench")
    seconds = time.process_time() - begun
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e3
    met = seconds <= _SECONDS and memory <= _MEMORY
    print(
        f"{_ROWS:,} rows of {model.nq} joints, all kinds and cut-offs: {seconds:.1f} s CPU, {memory:.0f} MB (target"
        f" {_SECONDS:g} s, {_MEMORY:g} MB): {'met' if met else 'MISSED'}"
    )
    return met


def _against_peers(model: RobotModel, urdf: str, folder: Path) -> bool:
    """Print CPU seconds and errors on a second log of our fit and of the peers."""
    train, test = _log(model, _PEER_ROWS, 1), _log(model, _PEER_ROWS // 2, 4)
    q, tau = _noisy(train[0], 1e-5, 2), _noisy(train[3], 0.3, 3)
    log = {f"test_{name}": values for name, values in zip(("q", "dq", "ddq", "tau"), test, strict=True)}
    log |= {"train_q": q, "train_tau": tau, "joints": np.array(model.joint_names), "armature": model.armature}
    np.savez(folder / "log.npz", period=np.array(_PERIOD), **log)  # type: ignore[arg-type]
    (folder / "robot.urdf").write_text(urdf)
    begun = time.process_time()
    sums = base_sums(model, False)
    fit = fit_logs([log_rows(motion_of(model, q, tau, _PERIOD, 10.0), sums, False, "log")], "coulomb")
    own = time.process_time() - begun
    error = _error(model, fit.state.values, sums, test)
    print(f"own      {own:8.2f} s CPU, error on a second log {error:.3%}")
    found = {name: _peer(name, package, folder) for name, (package, _) in _PEERS.items()}
    met = True
    for name, (seconds, peer_error) in found.items():
        fast = own <= _PEERS[name][1] * seconds
        met &= fast
        ended = f"error on a second log {peer_error:.3%}" if peer_error < np.inf else "stopped before its end"
        print(f"{name:8} {seconds:8.2f} s CPU, {ended}: {'met' if fast else 'MISSED'}")
    good = error <= _ERROR * min(peer_error for _, peer_error in found.values())
    print(f"error at most {_ERROR:g} times the better peer's: {'met' if good else 'MISSED'}")
    return met and good


def _error(model: RobotModel, values: FloatArray, sums: list[ParameterSum], test: tuple[FloatArray, ...]) -> float:
    q, dq, ddq, tau = test
    pin_model, data = model.pin_model, model.pin_model.createData()
    columns = [each.column for each in sums]
    friction = values[len(sums) : -1].reshape(model.nq, -1)
    predicted = np.array(
        [
            np.reshape(pin.computeJointTorqueRegressor(pin_model, data, *row), (model.nq, -1))[:, columns]
            @ values[: len(sums)]
            for row in zip(q, dq, ddq, strict=True)
        ]
    )
    predicted += friction[:, 0] * dq + friction[:, 1] * np.sign(dq) + friction[:, 2]
    moving = np.abs(dq) > 0.05 * np.abs(dq).max(axis=0)
    return float(np.linalg.norm((predicted - tau)[moving]) / np.linalg.norm(tau[moving]))


def _peer(name: str, package: str, folder: Path) -> tuple[float, float]:
    """Return CPU seconds and error of a peer, installed in a folder; an infinite error if it does not end in time."""
    place, result = folder / name, folder / f"{name}.json"
    python = place / "bin" / "python"
    subprocess.run([sys.executable, "-m", "venv", str(place)], check=True)
    subprocess.run([str(python), "-m", "pip", "install", "-q", package], check=True)
    script = Path(__file__).with_name("identification_peers.py")
    words = [str(python), str(script), name, str(folder / "log.npz"), str(folder / "robot.urdf"), str(result)]
    begun = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    try:
        subprocess.run(words, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, timeout=_LONGEST)
    except subprocess.TimeoutExpired:
        return resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - begun, np.inf
    found = json.loads(result.read_text())
    return float(found["seconds"]), float(found["error"])
