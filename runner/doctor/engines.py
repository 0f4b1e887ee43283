"""PyBullet and Pinocchio on the same arm."""

from pathlib import Path

import numpy as np

from runner.doctor.finding import Finding
from runner.errors import ConfigError
from runner.plants.bullet import Bullet
from runner.plants.bullet_reading import read_as_bullet
from runner.robots.model import RobotModel, joint_names_of

_SAMPLES = 1000
_STEP = 1e-4  # s
_AGREE = 1e-6  # of the largest entry: beyond it the engines simulate different arms
_DIFFERENT = 0.01  # of the largest moment


def compare_engines(urdf: str, model: RobotModel, generator: np.random.Generator) -> list[Finding]:
    """Return the largest disagreement of mass matrix and forward dynamics at random states within the joints' limits.

    PyBullet's accelerations are those of one step of its own; Pinocchio's are of its articulated-body algorithm.
    """
    lower, upper = model.usual_range
    middle, half = 0.5 * (lower + upper), 0.45 * (upper - lower)  # away from the stops, which PyBullet has
    try:
        plant = Bullet(urdf, model, _STEP, 1)
    except ConfigError as error:
        return [Finding("refused", "engines", problem.removeprefix("robot.urdf: ")) for problem in error.problems]
    largest = np.zeros(2)
    try:
        for _ in range(_SAMPLES):
            q = middle + half * generator.uniform(-1.0, 1.0, model.nq)
            dq, asked = generator.uniform(-1.0, 1.0, (2, model.nq))
            M = model.mass_matrix(q)
            tau = model.gravity_torque(q) + model.coriolis_torque(q, dq) + M @ asked
            plant.reset(q, dq)
            bullet_mass = plant.mass_matrix(q)
            plant.advance(tau)
            theirs = np.array([np.abs(bullet_mass - M).max() / np.abs(M).max(),
                               np.abs((plant.dq - dq) / _STEP - asked).max() / np.abs(asked).max()])  # fmt: skip
            largest = np.maximum(largest, theirs)
    finally:
        plant.close()
    text = (
        f"at {_SAMPLES} random states the mass matrices of PyBullet and Pinocchio differ by {largest[0]:.1e} of their "
        f"largest entry, the accelerations by {largest[1]:.1e}"
    )
    if np.all(largest < _AGREE):
        return [Finding("note", "engines", text)]
    return [Finding("finding", "engines", text, "look at the links above: both must read the same arm")]


def compare_readings(urdf: Path) -> list[Finding]:
    """Return where PyBullet, when nothing is said to it, reads a file otherwise than it is written, or than Pinocchio.

    That is the names and the order of the joints, and inertia that it makes from the links' shapes.
    """
    try:
        said, made = read_as_bullet(urdf, True), read_as_bullet(urdf, False)
        names = joint_names_of(urdf.read_text(encoding="utf-8"))
    except ConfigError as error:
        text = f"the file cannot be loaded as it is: {'; '.join(error.problems)}"
        return [Finding("finding", "loading", text, "mend what stands above; break lines of 1,000 characters", True)]
    findings = []
    if names != said.joints:
        text = f"PyBullet lists the joints as {', '.join(said.joints)}, Pinocchio as {', '.join(names)}"
        findings.append(Finding("note", "names", text, "the runner goes by name"))
    off = {
        name: max(abs(a - b) for a, b in zip(link.moments, made.links[name].moments, strict=True)) / link.moments[-1]
        for name, link in said.links.items()
        if link.mass and link.moments[-1] > 0.0
    }
    off = {name: ratio for name, ratio in off.items() if ratio > _DIFFERENT}
    if off:
        worst = max(off, key=lambda name: off[name])
        text = (
            f"PyBullet makes the inertia of {len(off)} links from their shapes unless it is told not to; that of "
            f"'{worst}' is then off by {100.0 * off[worst]:.0f} %"
        )
        findings.append(Finding("note", "inertia from shapes", text, "the runner tells it to take the file's"))
    findings += [Finding("note", "PyBullet", f"it prints while it loads the file: {line}") for line in said.said[:10]]
    text = "PyBullet damps bodies by 0.04 1/s of their speed unless it is told not to"
    return [*findings, Finding("note", "default damping", text, "the runner tells it")]
