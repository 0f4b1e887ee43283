"""Every torque law on four arms, with an exact model and with a wrong one: a table of tip errors.

The joints go to and fro by quintics of 1.5 s for 12 s; what is printed is the rms of the tip's distance from where it
should be over the last 3 s, in mm, which laws of the tip and of the joints have in common. All laws have one bandwidth,
no limits but the arm's own efforts, exact encoders, and a period of 1 ms, on plant=rk4. The wrong model has 0.8 of the
true masses, and the arm friction that it does not know: dry friction at which joint PD would rest 1 mrad away,
c = 1e-3 omega_n^2 diag M at home, and as much viscous friction as comes to c at 2.5 rad/s. Light joints have assumed
armature; the KUKA's, of which nothing is published, 0.1 kg m^2 each.
"""

import tempfile
from importlib.util import find_spec
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from runner.assembly import assemble
from runner.config.compose import compose
from runner.config.validation import validate
from runner.doctor.config_folder import robot_name, write_folder
from runner.doctor.examination import examine
from runner.errors import ConfigError
from runner.loop.sensors import make_encoders
from runner.simulation import simulate

LAWS = {
    "operational space": ("controller=operational_space",),
    "joint PD": ("controller=joint_pd",),
    "joint PID": ("controller=joint_pid",),
    "computed torque": ("controller=computed_torque",),
    "computed torque, integral": ("controller=computed_torque", "controller.integral_gain={cubed:g}"),
    "passivity": ("controller=passivity",),
    "sliding mode": ("controller=sliding_mode",),
    "computed torque, observer": ("controller=computed_torque", "disturbance_observer=momentum"),
    "joint PD, observer": ("controller=joint_pd", "disturbance_observer=momentum"),
    "iterative learning": ("controller=iterative_learning", "controller.repeats_every=3"),
    "adaptive": ("controller=adaptive",),
}
ARMS = {
    "macro": ("robot=macro",),
    "xarm7": ("robot=xarm7", "robot.armature=assumed"),
    "meca500": ("robot=meca500", "robot.armature=assumed"),
    "kuka": ("robot.armature=0.1",),
}
OMEGA = 20.0
PERIOD, WAY, LASTS = 0.001, 1.5, 12.0
SWING = (0.4, -0.3, 0.3)
_KNOTS = 4  # a row of the motion's file in as many ticks; it is a spline in between
_KUKA = "kuka_iiwa/model.urdf"

FloatArray = NDArray[np.float64]


def main() -> bool:
    """Print the table."""
    found = find_spec("pybullet_data")
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        arms = dict(ARMS)
        if found is None or not found.submodule_search_locations:
            arms.pop("kuka")
        else:
            examination = examine(Path(found.submodule_search_locations[0]) / _KUKA, None)
            write_folder(examination, folder)
            arms["kuka"] = (f"robot={robot_name(examination)}", *ARMS["kuka"])
        print(f"{'law':28}" + "".join(f"{name + ', exact':>18}{'wrong':>10}" for name in arms))
        for law in LAWS:
            cells = [_cells(law, arm, folder) for arm in arms.values()]
            print(f"{law:28}" + "".join(f"{exact:>18}{wrong:>10}" for exact, wrong in cells))
    return True


def _cells(law: str, arm: tuple[str, ...], folder: Path) -> tuple[str, str]:
    """Return the errors of a law on an arm, with an exact model and with a wrong one."""
    try:
        plain = validate(compose([*arm, "controller=joint_pd"], [folder]).resolved, [folder])
    except ConfigError as error:
        return str(error)[:16], ""
    model, home = plain.arm.model, plain.arm.home
    t = PERIOD * np.arange(round(LASTS / PERIOD) + 1)
    u = np.clip(1.0 - np.abs(t % (2.0 * WAY) / WAY - 1.0), 0.0, 1.0)
    swing = np.array([SWING[joint % 3] for joint in range(model.nq)])
    q_d = home + np.outer(10.0 * u**3 - 15.0 * u**4 + 6.0 * u**5, swing)
    path = folder / "to_and_fro.csv"
    names = ",".join(["t", *(f"q{joint + 1}" for joint in range(model.nq))])
    np.savetxt(path, np.column_stack([t, q_d])[::_KNOTS], delimiter=",", header=names, comments="", fmt="%.15g")
    dry = (1e-3 * OMEGA**2 * model.mass_matrix(home).diagonal()).tolist()
    wrong = ("mismatch.mass=0.8", f"plant.friction.coulomb={dry}", f"plant.friction.viscous={[c / 2.5 for c in dry]}")
    given = [text.format(cubed=OMEGA**3 / 8.0) for text in LAWS[law]]
    timing = (f"controller.period={PERIOD}", f"controller.natural_frequency={OMEGA}", f"duration={LASTS}", "plant=rk4")
    motion = ("trajectory=from_file", f"trajectory.file={path}")
    lines = [[*arm, *given, *timing, *motion, *more] for more in ((), wrong)]
    return _error(lines[0], folder, q_d), _error(lines[1], folder, q_d)


def _error(overrides: list[str], folder: Path, q_d: FloatArray) -> str:
    """Return the rms of the tip's error over a run's last period, in mm; or how it failed."""
    try:
        config = validate(compose(overrides, [folder]).resolved, [folder])
    except ConfigError as error:
        return str(error)
    closed = assemble(config)
    try:
        trace = simulate(closed, make_encoders(closed, config.noise, config.settings.seed, 0))
    finally:
        closed.close()
    if trace.failure is not None:
        return "diverged"
    last = round(2.0 * WAY / PERIOD)
    error = np.linalg.norm(trace.end_points[-1][-last:] - config.arm.model.tip_positions(q_d[-last:]), axis=1)
    return f"{1e3 * np.sqrt(np.mean(error**2)):.3g}"


if __name__ == "__main__":
    main()
