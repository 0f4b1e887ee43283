"""Derivatives by keys of the config against runs composed again with other values of them."""

import json
from copy import deepcopy
from dataclasses import replace
from functools import reduce
from operator import getitem

import numpy as np
import pytest

from runner.analysis import differences
from runner.assembly.assemble import assemble_program
from runner.assembly.validation import validate
from runner.config.compose.compose import compose
from runner.metrics.summary import measure
from runner.simulation.batch import BatchSimulator, RunSpec
from runner.store import simulated_part

NULL_SPACE, BANDWIDTH = "controller.null_space_frequency", "disturbance_observer.bandwidth"
QUIET = ("plant=rk4", "duration=0.1")
SHORT = (*QUIET, "noise=thesis")
TIED = ("robot=macro", "controller=computed_torque", "disturbance_observer=momentum", "trajectory=quintic", *SHORT)
REDUNDANT = ("robot=xarm7", *TIED[1:])
BY_JOINT = ("torque_limits.max=[40,45,50]", "plant.friction.viscous=[0.2,0,0.1]", "robot.payload.mass=0.5")
RUBBING = (
    "plant.friction.coulomb=[1,0,1]",
    "plant.friction.static=[2,1,1]",
    "plant.friction.stribeck_speed=0.2",
    "plant.friction.asymmetry=[0.3,0,-0.2]",
    "plant.friction.sigmoid={level: 1, steepness: 8, shift: 0.03}",
)
CASES = (
    (*TIED, *BY_JOINT),
    (*TIED, *RUBBING),
    (*REDUNDANT, "mismatch.mass=1.1", "controller.integral_gain=500", "torque_limits=thesis"),
    ("robot=combined", "controller=macro_mini", "disturbance_observer=momentum", "trajectory=quintic", *SHORT),
    ("robot=combined", "controller=whole_body", "trajectory=quintic", *SHORT),
    ("robot=macro", "controller=adaptive", "trajectory=circle", "plant.friction.coulomb=0.1", *QUIET),
    ("robot=macro", "controller=sliding_mode", "trajectory=circle", "mismatch.payload=0.2", *SHORT),
    ("robot=macro", "controller=passivity", "trajectory=circle", "noise.velocity=luenberger", *SHORT),
    ("robot=planar", "controller=joint_pid", "trajectory=joint_sinusoids", "notch=torques", "noise.bias=1e-4", *SHORT),
    ("robot=planar", "controller=joint_pd", "trajectory=joint_quintic", "noise.velocity=low_pass", *SHORT),
    ("robot=ur5e", "controller=operational_space", "trajectory=line", "robot.armature=[0.5,0.4,0.3,0,0.1,0]", *SHORT),
)  # fmt: skip


class Again:
    """A run whose keys are changed on its command line."""

    def __init__(self, overrides, resolved):
        self.overrides, self.resolved = overrides, resolved

    def at(self, parameter, value):
        name, *places = parameter.name.replace("]", "").split("[")
        *first, last = (0, *map(int, places))
        held = [deepcopy(reduce(getitem, name.split("."), self.resolved))]
        reduce(getitem, first, held)[last] = value
        return self.changed(name, held[0])

    def changed(self, name, value):
        config = validate(compose([*self.overrides, f"{name}={json.dumps(value)}"]))
        return RunSpec(config, 0, *assemble_program(config))


def of_keys(found, overrides):
    """Return an analysis of the parameters that are keys, whose runs are composed again."""
    resolved = found.scene.config.resolved
    kept = [place for place, one in enumerate(found.parameters) if one.name.partition(".")[0] in resolved]
    return replace(
        found,
        scene=Again(overrides, resolved),
        parameters=[found.parameters[place] for place in kept],
        derivatives={name: values[kept] for name, values in found.derivatives.items()},
        moves=found.moves[kept],
    )


def check_derivatives(found, overrides):
    keys = of_keys(found, overrides)
    sure, largest = np.zeros((2, len(keys.parameters)))
    for name, by in differences(keys, list(keys.metrics)).items():
        gaps, size = np.abs(by.derivatives - keys.derivatives[name]), np.abs(keys.derivatives[name])
        judged = by.doubts <= 1e-7 * size  # a doubt of 1e-6 cannot show agreement to 1e-6
        assert np.all(gaps[judged] <= 1e-6 * size[judged]), name
        assert np.all(gaps <= 1e-6 * size + 10.0 * by.doubts), name
        sure += by.doubts <= 1e-6 * size
        if keys.metrics[name]:
            largest = np.maximum(largest, np.abs(keys.elasticities(name)))
    assert np.all((sure > 0) | (largest < 1e-12))
    assert sure.sum() >= 0.4 * sure.size * len(keys.metrics)


def numeric_keys(node, path=""):
    for name, value in node.items():
        if isinstance(value, dict):
            yield from numeric_keys(value, f"{path}{name}.")
        elif any(type(entry) in (int, float) for entry in np.ravel(np.array(value, dtype=object))):
            yield f"{path}{name}", value


def changed(value):
    if isinstance(value, list):
        return [changed(entry) for entry in value]
    return (value * (1.0 + 1e-3) or 1e-3) if type(value) in (int, float) else value


def check_completeness(found, overrides):
    """Change each number that is neither in the tables nor left out: nothing else may change."""
    told = {one.name.partition("[")[0] for one in found.parameters}
    told |= {name.partition("[")[0] for names in found.left_out.values() for name in names}
    again = Again(overrides, found.scene.config.resolved)
    rest = [(name, value) for name, value in numeric_keys(simulated_part(again.resolved)) if name not in told]
    runs = [found.scene, *(again.changed(name, changed(value)) for name, value in rest)]
    for part in BatchSimulator().simulate(runs):
        measured = measure(part.traces, part.context)
        for name, value in found.metrics.items():
            assert np.all(measured[name] == value), (name, [rest[place - 1][0] for place in part.places])
    assert len(rest) > 5


@pytest.mark.costs(3)
def test_derivatives_by_gains_are_those_of_runs_composed_again(analysed):
    check_derivatives(analysed(*TIED, groups=("gains",)), TIED)


def test_a_key_moves_the_keys_that_take_its_value(analysed):
    """The effect of all keys together is the sum of the effects of single keys."""
    tied = analysed(*TIED, groups=("gains",))
    alone = analysed(*TIED, f"{NULL_SPACE}=30", f"{BANDWIDTH}=30", groups=("gains",))
    names = [one.name for one in tied.parameters]
    assert names == [one.name for one in alone.parameters]
    own, bandwidth, null_space = (names.index(name) for name in ("controller.natural_frequency", BANDWIDTH, NULL_SPACE))
    assert sorted(tied.parameters[own].followers) == [NULL_SPACE, BANDWIDTH]
    assert not alone.parameters[own].followers
    for name, derivatives in tied.derivatives.items():
        parts = alone.derivatives[name]
        assert derivatives[own] == pytest.approx(parts[[own, bandwidth, null_space]].sum(), rel=1e-9), name
        assert np.delete(derivatives, own) == pytest.approx(np.delete(parts, own), rel=1e-9, abs=1e-15), name
    assert abs(alone.derivatives["rms_tracking_error"][bandwidth]) > 1e-9


@pytest.mark.costs(3)
def test_every_number_that_acts_is_told(analysed):
    found = analysed(*TIED)
    check_completeness(found, TIED)
    reasons = {name: reason for reason, names in found.left_out.items() for name in names}
    assert reasons["robot.natural_frequency"] == "it has the same effect as controller.natural_frequency"
    assert reasons["robot.masses.link2"] == "it has the same effect as mass.q2"
    assert reasons["trajectory.goal"] == "it changes the desired motion, which is held"
    assert reasons["controller.period"] == "it changes the ticks or steps of the run, which are held"
    assert reasons["noise.bias"] == "its value is 0 (a small value shows its effect)"
    assert reasons["repetitions"] == "values near its own are refused: must be a whole number"


@pytest.mark.slow
@pytest.mark.parametrize("overrides", CASES)
def test_configs_agree_with_runs_composed_again(analysed, overrides):
    found = analysed(*overrides)
    check_derivatives(found, overrides)
    check_completeness(found, overrides)
