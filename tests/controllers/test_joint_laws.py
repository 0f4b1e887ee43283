"""The laws that follow a motion of the joints, against each other: a prototype's errors on the Macro."""

import numpy as np
import pytest

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
    "sliding_mode": ("controller.switching=1.3",),
    "adaptive": ("controller.scale=uniform", "controller.adaptation=0.5", "controller.friction=false"),
}
NOISE = ("noise.position=1e-4", "noise.distribution=gaussian")  # velocities are exact
WRONG = ("mismatch.mass=0.8", "plant.friction.viscous=0.2", "plant.friction.coulomb=0.5")


@pytest.fixture
def to_and_fro(tmp_path):
    """Return a file with (0, 0, 0) to (0.8, -0.5, 0.6) rad and back, a quintic of 1.5 s each way, for 12 s; and q_d."""
    t = 0.002 * np.arange(6001)
    u = 1.0 - np.abs(t % 3.0 / 1.5 - 1.0)
    u, way = np.clip(u, 0.0, 1.0), np.array([0.8, -0.5, 0.6])
    q_d = np.outer(10.0 * u**3 - 15.0 * u**4 + 6.0 * u**5, way)
    path = tmp_path / "to_and_fro.csv"
    np.savetxt(path, np.column_stack([t, q_d]), delimiter=",", header="t,q1,q2,q3", comments="", fmt="%.15g")
    return path, q_d


@pytest.mark.parametrize("law", PROTOTYPE)
@pytest.mark.parametrize(("column", "more"), [(0, ()), (1, WRONG), (2, (*WRONG, *NOISE))])
def test_errors_are_those_of_the_prototype(simulated, to_and_fro, law, column, more):
    path, q_d = to_and_fro
    trace = simulated("robot=macro", f"controller={law}", "controller.period=0.002", "plant=rk4",
                      "controller.natural_frequency=30", "duration=12", "trajectory=from_file",
                      f"trajectory.file={path}", *OPTIONS.get(law, ()), *more)  # fmt: skip
    error = np.linalg.norm(trace.q[-1500:] - q_d[-1500:], axis=1)
    rms, printed = 1e3 * np.sqrt(np.mean(error**2)), PROTOTYPE[law][column]
    if printed is None:
        assert rms < 0.01
    elif printed < 0.01:  # an exact model: one digit is printed, and what is left is of the sampling
        assert rms < 1.1 * printed
    else:
        assert rms == pytest.approx(printed, rel=0.1)
