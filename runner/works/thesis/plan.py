"""Which runs the thesis report needs, as runs.yaml has them, and the levels that its chapters go through."""

from runner.reporting.job import Jobs
from runner.works.grids import grids_of

_GRIDS = grids_of(__file__)
_DURATION = "trajectory.duration"  # t_f, in s

TRACKED = _GRIDS.levels("figures/durations", "figure", str)
DURATIONS = _GRIDS.levels("figures/durations", _DURATION, float)
ARMS = _GRIDS.levels("lag", "robot", str)
LAG_DURATIONS = _GRIDS.levels("lag", _DURATION, float)
TORQUE_DURATIONS = _GRIDS.levels("base_axis/durations", _DURATION, float)
STEPS = _GRIDS.levels("plants", "plant.step", float)  # s, of PyBullet
SAMPLING = _GRIDS.levels("sampling", "product", float)  # omega_n h on the Runge-Kutta plant

MOTIONS = _GRIDS.levels("coupling", "motion", str)
METHODS = _GRIDS.levels("coupling", "method", str)
DYNAMICS = _GRIDS.levels("coupling", "plant.dynamics", str)
VANISHING = _GRIDS.levels("vanishing", "mass", float)  # kg, each of the Mini's two point masses
MASSES = _GRIDS.levels("mass", "mass", float)  # kg, the whole Mini
NOMINAL_MASS = _GRIDS.value("mass", "nominal")  # kg, the thesis' Mini
PAYLOADS = _GRIDS.levels("mass", "controller.payload", str)
NOISY_MASSES = _GRIDS.levels("mass_noise", "mass", float)  # kg
MACRO_PERIODS = _GRIDS.levels("stage_sampling/macro", "controller.period.macro", float)  # s
MINI_PERIODS = _GRIDS.levels("stage_sampling/mini", "h", float)  # s
EULER_PERIODS = {  # s, by steps in a period
    int(_GRIDS.value(grid, "steps")): _GRIDS.levels(grid, "h", float)
    for grid in ("stage_sampling/euler1", "stage_sampling/euler4")
}
FOLDING = _GRIDS.levels("folding", "case", str)
TARGETS = _GRIDS.levels("folding", "controller.macro_target", str)
STRETCHING = _GRIDS.levels("stretch", "case", str)
NOISES = _GRIDS.levels("reference", "noise", str)
VELOCITIES = _GRIDS.levels("reference", "controller.mini_reference_velocity", str)
REFERENCE_DURATIONS = _GRIDS.levels("reference", _DURATION, float)
SCHEDULES = _GRIDS.levels("turns", "controller.schedule", str)
TURN_DURATIONS = _GRIDS.levels("turns/durations", _DURATION, float)
COMPARED_RATES = _GRIDS.levels("whole_body", "rate", str)
TIP_SPEEDS = _GRIDS.levels("whole_body/speed", "speed", float)  # m/s
SLOW_DURATION = _GRIDS.value("whole_body/slow", "duration")  # s, t_f, of whole-body control at 10 ms
BANDWIDTHS = _GRIDS.levels("bandwidth", "rate", float)  # rad/s, of the Mini; the first is that of the thesis
BIASED = _GRIDS.levels("bandwidth/bias", "rate", float)  # rad/s, of the Mini under a bias of the Macro's encoders
MACRO_BIAS = _GRIDS.value("bandwidth/bias", "bias")  # rad


def plan() -> Jobs:
    """Return every run by name."""
    return _GRIDS.jobs()
