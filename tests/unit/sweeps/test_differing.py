"""Keys that differ next to the swept ones, against configs that differ by known keys."""

import numpy as np
import pytest

from runner.store.axes import Axis
from runner.sweeps.differing import Resolved, UnsweptDifference, in_words

MACRO = {"name": "macro", "home": [0.0], "period": 0.01, "settling_band": 0.02}
XARM7 = {"name": "xarm7", "home": [0.1], "period": 0.002, "settling_band": 0.001}
LAW = {"kind": "computed_torque", "natural_frequency": 30.0, "period": 0.01}


def config(robot=MACRO, law=LAW, **more):
    return {"seed": 0, "outputs": "o", "robot": robot, "controller": law, "noise": {"position": 1e-3}, **more}


def find_differing(configs, axes):
    """Return the differences between configs of cells, one after the other."""
    resolved = Resolved()
    for each in configs:
        resolved.add(each)
    return resolved.differences(axes)


def axis(name, values, *level):
    return Axis(name, values, np.array(level))


def test_what_goes_with_a_swept_robot_is_found_and_its_own_parts_are_not():
    fast = {**LAW, "natural_frequency": 5.0, "period": 0.001}
    found = find_differing([config(), config(XARM7, fast)], [axis("robot", ["macro", "xarm7"], 0, 1)])
    assert found == [
        UnsweptDifference("robot.settling_band", ("robot",), [("macro", "0.02"), ("xarm7", "0.001")]),
        UnsweptDifference("controller.natural_frequency", ("robot",), [("macro", "30"), ("xarm7", "5")]),
        UnsweptDifference("controller.period", ("robot",), [("macro", "0.01"), ("xarm7", "0.001")]),
    ]


@pytest.mark.parametrize("key", ["noise.position", "noise"])
def test_what_is_swept_does_not_differ_beyond_itself(key):
    noises = [config(noise={"position": value}) for value in (1e-3, 1e-4)]
    names = [1e-4, 1e-3] if key == "noise.position" else ["{position: 1e-3}", "{position: 1e-4}"]
    found = find_differing(noises, [axis(key, names, 1, 0)])
    # A key of a swept group that both options have is reported: they may be compared by it.
    assert [difference.key for difference in found] == ([] if key == "noise.position" else ["noise.position"])


def test_what_only_one_law_has_is_what_it_is():
    other = {"kind": "other", "natural_frequency": 30.0, "period": 0.01, "gain": 2.0}
    laws = [axis("controller", ["computed_torque", "other"], 0, 1)]
    assert find_differing([config(), config(law=other)], laws) == []
    (found,) = find_differing([config(), config(law={**other, "period": 0.02})], laws)
    assert found == UnsweptDifference(
        "controller.period", ("controller",), [("computed_torque", "0.01"), ("other", "0.02")]
    )


def test_where_a_run_is_kept_is_no_difference_and_equal_numbers_are_equal():
    assert find_differing([config(duration=1), config(duration=1.0, outputs="p", sweep={"trace": "all"})], []) == []


def test_a_value_follows_as_few_axes_as_it_can():
    axes = [axis("robot", ["macro", "xarm7"], 0, 0, 1, 1), axis("seed", [0.0, 1.0], 0, 1, 0, 1)]
    cells = [config(step=step, seed=seed, gain=gain) for step, seed, gain in
             ((1, 0, "a"), (1, 1, "b"), (2, 0, "b"), (2, 1, "b"))]  # fmt: skip
    by_both, by_robot = find_differing(cells, axes)
    assert by_robot == UnsweptDifference("step", ("robot",), [("macro", "1"), ("xarm7", "2")])
    assert by_both.axes == ("robot", "seed")
    assert by_both.values == [("macro and 0", "a"), ("macro and 1, xarm7 and 0, xarm7 and 1", "b")]


def test_what_follows_no_axis_is_told_too():
    (found,) = find_differing([config(duration=1), config(duration=2)], [axis("seed", [0.0], 0, 0)])
    assert found == UnsweptDifference("duration", (), [("", "1"), ("", "2")])


def test_a_key_that_some_cells_lack_is_told():
    (found,) = find_differing([config(), config(duration=2)], [axis("preset", ["a", "b"], 0, 1)])
    assert found == UnsweptDifference("duration", ("preset",), [("a", "–"), ("b", "2")])


def test_what_overrides_give_takes_no_memory():
    resolved = Resolved()
    for seed in range(50):
        resolved.add(config(seed=seed, duration=seed // 25), [f"seed={seed}", "robot=macro"])
    assert "seed" not in resolved._texts
    (found,) = resolved.differences([axis("seed", np.arange(50.0), *range(50))])
    assert found.key == "duration"


def test_an_override_that_takes_another_keys_value_may_differ():
    resolved = Resolved()
    for step in (1.0, 2.0):
        resolved.add(config(step=step), ["step=${robot.period}"])
    assert [difference.key for difference in resolved.differences([])] == ["step"]


def test_in_a_line():
    found = [UnsweptDifference(key, ("robot",), []) for key in "abcdef"]
    assert in_words(found) == "6 config values differ beyond the swept axes with robot: a, b, c, d and 2 more"
    assert in_words([UnsweptDifference("a", (), [])]) == "1 config value differs beyond the swept axes: a"
    assert in_words([]) == ""
