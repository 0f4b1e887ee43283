"""How often the repetitions of a run keep the bounds of a spec."""

from runner.statistics.spec.kept import Kept, Spec, bounds_of, judge, read_spec

__all__ = ["Kept", "Spec", "bounds_of", "judge", "read_spec"]
