"""Which calibrations the Meca500 report needs: a name for each, and the overrides of `runner calibrate`."""

from collections.abc import Mapping

Calibrations = dict[str, tuple[str, ...]]
_Cases = Mapping[float, tuple[str, ...]]
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
    """Return the overrides of every calibration by name; each draws from a seed of its own.

    With one seed for all they would be the same draws rescaled, and what is counted over them one test.
    """
    jobs = {**_tool_centre_point(), **_tool_direction(), **_gravity()}
    return {name: (*overrides, f"seed={seed}") for seed, (name, overrides) in enumerate(jobs.items())}


def _tool_centre_point() -> Calibrations:
    base = ("calibration=tool_centre_point", *_TOUCHING)
    keys = {"repeatability": REPEATABILITIES, "poses": POSES, "spread": SPREADS}
    return _vary(base, {key: {value: (f"calibration.{key}={value}",) for value in keys[key]} for key in keys})


def _tool_direction() -> Calibrations:
    base = ("calibration=tool_direction", *_TOUCHING)
    keys = {"repeatability": DIRECTION_REPEATABILITIES, "poses": DIRECTION_POSES, "shorter": SHORTER}
    return _vary(base, {key: {value: (f"calibration.{key}={value}",) for value in keys[key]} for key in keys})


def _gravity() -> Calibrations:
    chosen: dict[str, _Cases] = {
        choice: {count: (f"calibration.choice={choice}", f"calibration.orientations={count}") for count in ORIENTATIONS}
        for choice in CHOICES
    }
    cases: dict[str, _Cases] = {
        "noise": {factor: (f"wrist_sensor.noise=[{_times(factor)}]",) if factor else _EXACT for factor in NOISES},
        **chosen,
        "spread": {x: (f"calibration.spread={x}", "calibration.candidates=4000") for x in WEIGHING_SPREADS},
        "samples": {count: (f"calibration.samples={count}",) for count in SAMPLES},
    }
    return _vary(("calibration=gravity",), cases)


def _times(factor: float) -> str:
    return ",".join(f"{factor * value:g}" for value in _NOISE)


def _vary(base: tuple[str, ...], variations: Mapping[str, _Cases]) -> Calibrations:
    """Return the base case and, by the name of each variation and its value, the base case with other overrides."""
    kind = base[0].removeprefix("calibration=")
    jobs = {f"{kind}/base": base}
    for variation, cases in variations.items():
        for value, overrides in cases.items():
            jobs.setdefault(name_of(f"{kind}/{variation}", value), (*base, *overrides))
    return jobs
