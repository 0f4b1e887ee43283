"""Which calibrations the Meca500 report needs: a name for each, and the overrides of `runner calibrate`."""

from collections.abc import Mapping

Calibrations = dict[str, tuple[str, ...]]
REPEATABILITIES = (0.0, 1e-6, 5e-6, 2e-5, 1e-4)  # m
DIRECTION_REPEATABILITIES = (0.0, 5e-6, 1e-4)  # m
POSES = (3, 4, 6, 10, 20)
DIRECTION_POSES = (4, 10)
SPREADS = (0.05, 0.1, 0.175, 0.35, 0.5236)  # rad
SHORTER = (0.005, 0.01, 0.025, 0.05)  # m, of the short tool
NOISES = (0.0, 0.25, 1.0, 4.0)  # times the Mini40's; 0 is an exact sensor on an exact arm
ORIENTATIONS = (4, 8, 16, 32)
CHOICES = ("best", "first")
WEIGHING_SPREADS = (0.4, 0.8, 1.6)  # rad
SAMPLES = (1, 10, 100)
# The value of each variation in the base case of each calibration, which is carried out once.
_BASE: Mapping[str, float] = {
    "tool_centre_point/repeatability": 5e-6,
    "tool_centre_point/poses": 4,
    "tool_centre_point/spread": 0.5236,
    "tool_direction/repeatability": 5e-6,
    "tool_direction/poses": 4,
    "tool_direction/shorter": 0.025,
    "gravity/noise": 1.0,
    "gravity/best": 16,
    "gravity/samples": 10,
}
# A posture with room for tilts all around, and 30 deg of them.
_TOUCHING = ("calibration.posture=[0,0.2,0.3,0,1.2,0]", f"calibration.spread={SPREADS[-1]}")
_NOISE = (0.0145, 0.0145, 0.029, 0.0005, 0.0005, 0.0005)  # N and N m, the Mini40's
_EXACT = (
    "calibration.repeatability=0",
    "wrist_sensor.noise=[0,0,0,0,0,0]",
    "wrist_sensor.resolution=[0,0,0,0,0,0]",
    "repetitions=1",
)


def name_of(variation: str, value: float) -> str:
    """Return the name of a calibration, such as "tool_centre_point/poses/6", or "tool_centre_point/base"."""
    return f"{variation.partition('/')[0]}/base" if value == _BASE.get(variation) else f"{variation}/{value:g}"


def calibration_jobs() -> Calibrations:
    """Return the overrides of every calibration by name."""
    return {**_tool_centre_point(), **_tool_direction(), **_gravity()}


def _tool_centre_point() -> Calibrations:
    jobs: Calibrations = {}
    for key, values in (("repeatability", REPEATABILITIES), ("poses", POSES), ("spread", SPREADS)):
        for value in values:
            jobs[name_of(f"tool_centre_point/{key}", value)] = (*_TOUCHING, f"calibration.{key}={value}")
    return jobs


def _tool_direction() -> Calibrations:
    jobs: Calibrations = {}
    keys = ("repeatability", DIRECTION_REPEATABILITIES), ("poses", DIRECTION_POSES), ("shorter", SHORTER)
    for key, values in keys:
        for value in values:
            own = ("calibration=tool_direction", *_TOUCHING, f"calibration.{key}={value}")
            jobs[name_of(f"tool_direction/{key}", value)] = own
    return jobs


def _gravity() -> Calibrations:
    base = "calibration=gravity"
    jobs: Calibrations = {}
    for factor in NOISES:
        noise = ",".join(f"{factor * value:g}" for value in _NOISE)
        own = (f"wrist_sensor.noise=[{noise}]",) if factor else _EXACT
        jobs[name_of("gravity/noise", factor)] = (base, *own)
    for choice in CHOICES:
        for count in ORIENTATIONS:
            own = (f"calibration.choice={choice}", f"calibration.orientations={count}")
            jobs[name_of(f"gravity/{choice}", count)] = (base, *own)
    for spread in WEIGHING_SPREADS:
        own = (f"calibration.spread={spread}", "calibration.candidates=4000")
        jobs[name_of("gravity/spread", spread)] = (base, *own)
    for samples in SAMPLES:
        jobs[name_of("gravity/samples", samples)] = (base, f"calibration.samples={samples}")
    return jobs
