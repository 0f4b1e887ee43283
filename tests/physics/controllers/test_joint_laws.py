"""Laws that follow a motion of the joints: their errors on the Macro against a prototype's."""

import numpy as np
import pytest
from support.arms import checked
from support.motions import to_and_fro, write_joints

from runner.assembly.assemble import assemble
from runner.plants.rk4 import Rk4

# rms of the norm of the joint errors in mrad: of an exact model, of masses 0.8 of the true ones with friction, and with
# noise of the encoders, too. No K of the sliding law is printed; 1.3 phi omega_n diag M gives its error.
PROTOTYPE = {
    "joint_pd": (1.78, 2.98, 2.98),
    "joint_pid": (1.23, 1.64, 1.64),
    "computed_torque": (0.008, 3.74, 3.74),
    "passivity": (0.007, 1.99, 2.00),
    "sliding_mode": (0.004, 0.87, 0.87),
    "adaptive": (None, 0.84, 0.84),
}
OPTIONS = {
    "sliding_mode": ("controller.switching_gain=1.3",),
    "adaptive": ("controller.scale=uniform", "controller.adaptation_gain=0.5", "controller.friction=false"),
}
NOISE = ("noise.position=1e-4", "noise.distribution=gaussian")  # velocities are exact
WRONG = ("mismatch.mass=0.8", "plant.friction.viscous=0.2", "plant.friction.coulomb=0.5")


@pytest.fixture(scope="module")
def prototype(tmp_path_factory):
    """Return a file with the motion of the prototype, for 12 s, and its joints q_d."""
    q_d = to_and_fro([0.8, -0.5, 0.6], 0.002, 12.0)[:, 0]
    return write_joints(tmp_path_factory.mktemp("motion") / "to_and_fro.csv", q_d, 0.002), q_d


@pytest.mark.parametrize("law", PROTOTYPE)
@pytest.mark.parametrize(("column", "more"), [(0, ()), (1, WRONG), (2, (*WRONG, *NOISE))])
def test_errors_are_those_of_the_prototype(simulated, prototype, law, column, more):
    path, q_d = prototype
    lasts = 12 if law in ("adaptive", "joint_pid") else 6  # s; those two settle over several periods of 3 s
    trace = simulated("robot=macro", f"controller={law}", "controller.period=0.002", "plant=rk4",
                      "controller.natural_frequency=30", f"duration={lasts}", "trajectory=from_file",
                      f"trajectory.file={path}", *OPTIONS.get(law, ()), *more)  # fmt: skip
    error = np.linalg.norm(trace.q[-1500:] - q_d[-1500:], axis=1)
    rms, printed = 1e3 * np.sqrt(np.mean(error**2)), PROTOTYPE[law][column]
    if printed is None:
        assert rms < 0.01
    elif printed < 0.01:  # an exact model: one digit is printed, and what is left is of the sampling
        assert rms < 1.1 * printed
    else:
        assert rms == pytest.approx(printed, rel=0.1)


INTEGRATING = {
    "controller.integral_gain=27000": (0.005, 0.39),  # omega_n^3
    "disturbance_observer.bandwidth=60": (0.008, 0.099),
}


@pytest.mark.parametrize("more", INTEGRATING)
def test_what_integrates_has_the_errors_of_the_prototype_whose_dry_friction_is_smooth(prototype, more):
    """c tanh(v / (0.01 rad/s)): at a standstill less than dry friction, which these laws would have to break away."""
    path, q_d = prototype
    line = ("robot=macro", "controller=computed_torque", "controller.period=0.002", "controller.natural_frequency=30",
            "trajectory=from_file", f"trajectory.file={path}", more)  # fmt: skip
    for wrong, printed in zip(((), WRONG[:1]), INTEGRATING[more], strict=True):
        closed = assemble(checked(*line, *wrong))
        closed.close()
        law, plant, parts, errors = closed.loops[0].controller, Rk4(closed.robot.model, 0.0005, 1), 4, []
        plant.reset(q_d[0], np.zeros(3))
        law.reset()
        for tick, reference in enumerate(closed.trajectory.sample_joints(0.002 * np.arange(6000))):
            errors.append(np.linalg.norm(reference[0] - plant.q))
            torque = law.torque(0.002 * tick, plant.q.copy(), plant.dq.copy(), reference)
            for _ in range(parts):
                friction = 0.5 * np.tanh(plant.dq / 0.01) + 0.2 * plant.dq
                plant.advance(torque - friction if wrong else torque)
        rms = 1e3 * np.sqrt(np.mean(np.array(errors[-1500:]) ** 2))
        assert rms == pytest.approx(printed, rel=0.1) if wrong else rms < 0.01


def test_an_observer_takes_a_twentieth_or_less_of_the_error_of_computed_torque(simulated, prototype):
    path, q_d = prototype
    rms = []
    for more in ((), ("disturbance_observer.bandwidth=60",)):
        trace = simulated("robot=macro", "controller=computed_torque", "controller.period=0.002", "plant=rk4",
                          "controller.natural_frequency=30", "duration=12", "trajectory=from_file",
                          f"trajectory.file={path}", *WRONG, *more)  # fmt: skip
        rms.append(np.sqrt(np.mean(np.sum((trace.q[-1500:] - q_d[-1500:]) ** 2, axis=1))))
    assert rms[1] < rms[0] / 20.0
