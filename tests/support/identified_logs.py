"""Logs of an arm with known masses, rotors, friction and delay, in memory and as files."""

import csv

import numpy as np
import pinocchio as pin
import yaml

from runner.assembly.validation import validate
from runner.config.compose.compose import compose
from runner.identification.log_rows import payload_torques
from runner.identification.parameters import base_sums
from runner.recordings.equations import motion_of

H = 0.004


def arm_of(robot):
    return validate(compose([f"robot={robot}"])).arm.model


class KnownArm:
    """An arm whose parameters differ from those of its file."""

    def __init__(self, robot, rotors=True, seed=1):
        self.model = arm_of(robot)
        random, nq = np.random.default_rng(seed), self.model.nq
        scale = np.exp(random.uniform(-0.3, 0.3, nq))
        self.links = self.model.inertial_parameters * np.repeat(scale, 10)
        self.rotors = random.uniform(0.1, 0.5, nq) if rotors else np.zeros(nq)
        self.viscous, self.coulomb = random.uniform(0.3, 1.0, nq), random.uniform(0.3, 1.0, nq)
        self.offset, self.by_load = random.uniform(-0.2, 0.2, nq), np.zeros(nq)
        self.carried = None
        self.sums = base_sums(self.model, rotors)
        self.base = np.array([each.factors @ np.concatenate([self.links, self.rotors]) for each in self.sums])
        self._speeds, self._phases = random.uniform(0.8, 5.0, (3, nq)), random.uniform(0.0, 6.0, (3, nq))
        self._swing = random.uniform(0.2, 0.5, (3, nq))
        self._data = self.model.pin_model.createData()

    def motion(self, t, moves=None):
        angles = t[:, None, None] * self._speeds + self._phases
        waves = (np.sin(angles), self._speeds * np.cos(angles), -(self._speeds**2) * np.sin(angles))
        swing = self._swing * (np.ones(self.model.nq) if moves is None else np.array(moves))
        return [np.sum(swing * wave, axis=1) for wave in waves]

    def torques(self, q, dq, ddq):
        pin_model, many = self.model.pin_model, self.model.nq
        rigid = self.rotors * ddq
        for place, row in zip(rigid, zip(q, dq, ddq, strict=True), strict=True):
            place += np.reshape(pin.computeJointTorqueRegressor(pin_model, self._data, *row), (many, -1)) @ self.links
        if self.carried is not None:
            rigid += payload_torques(self.rows((None, q, dq, ddq, rigid), exact=True), self.carried)
        return rigid + self.viscous * dq + (self.coulomb + self.by_load * np.abs(rigid)) * np.sign(dq) + self.offset

    def log(self, duration=12.0, delay=0.0, moves=None, first=0.0):
        """Return times, positions, speeds, accelerations and torques, the torques a delay late."""
        t = first + np.arange(0.0, duration, H)
        return (t, *self.motion(t, moves), self.torques(*self.motion(t - delay, moves)))

    def rows(self, log, frequency=10.0, exact=False):
        """Return the rows of a log for the fit; exact with recorded speeds and accelerations."""
        _, q, dq, ddq, tau = log
        more = (dq, ddq) if exact else ()
        return motion_of(self.model, q, tau, H, frequency, *more)


def write_log(folder, model, log, name="log.csv", side="motor", derivatives=False, **keys):
    """Write a log and its column map; return their paths."""
    t, q, dq, ddq, tau = log
    signals = {"joint": (q, "rad"), "torque": (tau, "N m")}
    if derivatives:
        signals |= {"velocity": (dq, "rad/s"), "acceleration": (ddq, "rad/s^2")}
    columns, values = {}, [t - t[0]]
    for key, (numbers, unit) in signals.items():
        for joint, each in zip(model.joint_names, numbers.T, strict=True):
            columns[f"{key}_{joint}"] = {key: joint, "unit": unit} | ({"side": side} if key == "torque" else {})
            values.append(each)
    with (folder / name).open("w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["t", *columns])
        writer.writerows(zip(*values, strict=True))
    said = {"time": {"column": "t", "unit": "s"}, "torque": "instant", "columns": columns, **keys}
    path = folder / f"{name}.yaml"
    path.write_text(yaml.safe_dump(said, sort_keys=False))
    return folder / name, path
