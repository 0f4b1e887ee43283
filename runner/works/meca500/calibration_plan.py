"""Which calibrations the Meca500 report needs, as runs.yaml has them, and the levels that its chapters go through."""

from runner.works.meca500.plan import GRIDS

Calibrations = dict[str, tuple[str, ...]]
REPEATABILITIES = GRIDS.levels("tool_centre_point/repeatability", "calibration.repeatability", float)  # m
DIRECTION_REPEATABILITIES = GRIDS.levels("tool_direction/repeatability", "calibration.repeatability", float)  # m
POSES = GRIDS.levels("tool_centre_point/poses", "calibration.poses", int)
DIRECTION_POSES = GRIDS.levels("tool_direction/poses", "calibration.poses", int)
SPREADS = GRIDS.levels("tool_centre_point/spread", "calibration.spread", float)  # rad
SHORTER = GRIDS.levels("tool_direction/shorter", "calibration.shorter", float)  # m, of the short tool
NOISES = (0.0, *GRIDS.levels("gravity/noise", "noise", float))  # times the Mini40's; 0 is an exact sensor and arm
CHOICES = ("best", "first")
ORIENTATIONS = GRIDS.levels("gravity/best", "calibration.orientations", int)
WEIGHING_SPREADS = GRIDS.levels("gravity/spread", "calibration.spread", float)  # rad
SAMPLES = GRIDS.levels("gravity/samples", "calibration.samples", int)


def name_of(variation: str, value: float) -> str:
    """Return the name of a calibration, such as "tool_centre_point/poses/6", or "tool_centre_point/base"."""
    is_base = value == GRIDS.grid(variation).values.get("base")
    return f"{variation.partition('/')[0]}/base" if is_base else f"{variation}/{value:g}"


def calibration_jobs() -> Calibrations:
    """Return the overrides of every calibration by name; each draws from a seed of its own.

    With one seed for all they would be the same draws rescaled, and what is counted over them one test.
    """
    jobs = {name: overrides for name, overrides in GRIDS.calibrations.items() if not _stands_as_base(name)}
    return {name: (*overrides, f"seed={seed}") for seed, (name, overrides) in enumerate(jobs.items())}


def _stands_as_base(name: str) -> bool:
    variation, _, level = name.rpartition("/")
    return level != "base" and name_of(variation, float(level)) != name
