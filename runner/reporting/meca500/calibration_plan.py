"""Which calibrations the Meca500 report needs: a name for each, and the overrides of `runner calibrate` that make it."""

Calibrations = dict[str, tuple[str, ...]]
REPEATABILITIES = (0.0, 1e-6, 5e-6, 2e-5, 1e-4)  # m; the maker's is the third
POSES = (3, 4, 6, 10, 20)
SPREADS = (0.05, 0.1, 0.175, 0.35, 0.6)  # rad
SHORTER = (0.005, 0.01, 0.025, 0.05)  # m, of the short tool
DIRECTION_POSES = (4, 10, 20)
NOISE_FACTORS = (0.25, 1.0, 4.0)  # of the Mini40's
ORIENTATIONS = (4, 6, 8, 16, 32)
CHOICES = ("best", "first")
WEIGHING_SPREADS = (0.3, 0.6, 1.2)  # rad; any is the base case
SAMPLES = (1, 10, 100)
# A posture with room for tilts all around, and 30 deg of them.
_TOUCHING = ("calibration.posture=[0,0.2,0.3,0,1.2,0]", "calibration.spread=0.5236")
_NOISE = (0.0145, 0.0145, 0.029, 0.0005, 0.0005, 0.0005)  # N and N m, the Mini40's


def calibration_jobs() -> Calibrations:
    """Return the overrides of every calibration by name; some are the same calibration."""
    return {**_tool_centre_point(), **_tool_direction(), **_gravity()}


def _tool_centre_point() -> Calibrations:
    base = ("calibration=tool_centre_point", *_TOUCHING)
    return {
        **{f"tool_centre_point/repeatability/{v:g}": (*base, f"calibration.repeatability={v}") for v in REPEATABILITIES},
        **{f"tool_centre_point/poses/{count}": (*base, f"calibration.poses={count}") for count in POSES},
        **{f"tool_centre_point/spread/{v:g}": (*base, f"calibration.spread={v}") for v in SPREADS},
    }


def _tool_direction() -> Calibrations:
    base = ("calibration=tool_direction", *_TOUCHING)
    return {
        **{f"tool_direction/repeatability/{v:g}": (*base, f"calibration.repeatability={v}") for v in REPEATABILITIES},
        **{f"tool_direction/poses/{count}": (*base, f"calibration.poses={count}") for count in DIRECTION_POSES},
        **{f"tool_direction/shorter/{v:g}": (*base, f"calibration.shorter={v}") for v in SHORTER},
    }


def _gravity() -> Calibrations:
    base = ("calibration=gravity",)
    exact = (
        "calibration.repeatability=0",
        "wrist_sensor.noise=[0,0,0,0,0,0]",
        "wrist_sensor.resolution=[0,0,0,0,0,0]",
        "repetitions=1",
    )
    jobs: Calibrations = {"gravity/exact": (*base, *exact), "gravity/base": base}
    for factor in NOISE_FACTORS:
        noise = ",".join(f"{factor * value:g}" for value in _NOISE)
        jobs[f"gravity/noise/{factor:g}"] = (*base, f"wrist_sensor.noise=[{noise}]")
    for choice in CHOICES:
        for count in ORIENTATIONS:
            own = (f"calibration.choice={choice}", f"calibration.orientations={count}")
            jobs[f"gravity/{choice}/{count}"] = (*base, *own)
    for spread in WEIGHING_SPREADS:
        own = (f"calibration.spread={spread}", "calibration.candidates=4000")
        jobs[f"gravity/spread/{spread:g}"] = (*base, *own)
    for samples in SAMPLES:
        jobs[f"gravity/samples/{samples}"] = (*base, f"calibration.samples={samples}")
    return jobs
