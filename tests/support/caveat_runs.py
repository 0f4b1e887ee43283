"""Runs made by hand, for the rules to look at."""

from dataclasses import replace

import numpy as np

from runner.caveats.monitor import Watch
from runner.caveats.setting import RunSignals, setting_of


def signals(q=None, tau=None, tip=None, desired=None, limits=(10.0, 10.0, 10.0), dq=None):
    """Signals of a run of three joints, at rest where nothing is said."""
    rows = next(
        (len(given) + extra for given, extra in ((q, 0), (tau, 1), (tip, 0), (dq, 0)) if given is not None), 101
    )
    q, tau = np.zeros((rows, 3)) if q is None else q, np.zeros((rows - 1, 3)) if tau is None else tau
    tip, dq = np.zeros((rows, 3)) if tip is None else tip, np.zeros((rows, 3)) if dq is None else dq
    saturation = (np.abs(tau) >= np.array(limits)).mean(axis=0)
    return RunSignals(q, dq, tau, tip, tip if desired is None else desired, saturation, np.array(limits))


def stacked(*runs):
    """Several runs as one, with an axis in front."""
    names = ("q", "dq", "tau", "tip", "desired", "saturation", "limits")
    return RunSignals(*(np.array([getattr(run, name) for run in runs]) for name in names))


def found(config, *runs, **changed):
    """The caveats of runs by their rule."""
    setting = replace(setting_of(config), repetitions=max(1, len(runs)), **changed)
    watch = Watch(setting, config.caveats)
    for run in runs:
        watch.look(run)
    return {caveat.rule: caveat for caveat in watch.found().caveats}
