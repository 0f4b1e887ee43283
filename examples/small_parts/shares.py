"""Sections of reports: shares of a sweep's repetitions below each error, and of a run's time below each torque."""

import numpy as np

from runner.plugin import Curves, Panel, Section, Series


def show_shares(label, values_by_name):
    series = [Series(name, np.sort(own), np.linspace(0.0, 1.0, len(own))) for name, own in values_by_name.items()]
    return Section("Shares", (Curves("Share of the values below each value.", [Panel("", label, "share", series)]),))


def sweep_section(subject):
    if not subject.metrics:
        return None
    metric = subject.metrics[0]
    values = subject.measurements.values[metric]
    return show_shares(subject.label(metric), {"all cells": values[np.isfinite(values)]})


def run_section(subject):
    torques = abs(subject.run.joints("tau"))
    return show_shares("torque (N m)", {f"joint {j}": column for j, column in enumerate(torques.T, start=1)})
