"""Evaluation of a spec: the fraction of a run's repetitions within its bounds."""

from runner.statistics.spec.kept import Kept, Spec, bounds_of, judge, read_spec

__all__ = ["Kept", "Spec", "bounds_of", "judge", "read_spec"]
