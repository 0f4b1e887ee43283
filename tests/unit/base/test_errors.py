"""Errors for users: one and many problems, the nearest name, safe strings."""

import pickle

import pytest

from runner.base.errors import ConfigError, RunnerError, SimulationError, StoreError, nearest, unknown


def test_what_a_user_can_mend_is_a_runner_error():
    assert issubclass(ConfigError, RunnerError)
    assert issubclass(StoreError, RunnerError)
    assert not issubclass(SimulationError, RunnerError)


def test_one_problem_and_many():
    assert str(ConfigError(["a: wrong"])) == "1 problem in the config:\n  - a: wrong"
    assert str(ConfigError(iter("ab"), "look there")) == "2 problems in the config:\n  - a\n  - b\nlook there"


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("makro", " (did you mean macro?)"),
        ("macro", " (did you mean macro?)"),
        ("xyz", ""),
        ("", ""),
    ],
)
def test_the_nearest_name(name, text):
    assert nearest(name, iter(["macro", "mini"])) == text


@pytest.mark.parametrize(("joint", "text"), [("q1", "gone at t = 0.1235 s, q1"), (None, "gone at t = 0.1235 s")])
def test_a_simulation_error_says_when_and_where(joint, text):
    error = SimulationError("gone", 0.12345, joint)
    assert str(error) == text
    assert (error.reason, error.time, error.joint) == ("gone", 0.12345, joint)


def test_a_config_error_comes_out_of_a_worker_process_as_it_went_in():
    error = ConfigError(["a.b: must be above 0; found -1", "c: unknown key"], "  2 runs are stored already")
    again = pickle.loads(pickle.dumps(error))
    assert (again.problems, again.hint, str(again)) == (error.problems, error.hint, str(error))


def test_messages_are_safe_to_print_whatever_stands_in_them():
    assert str(RunnerError("no file \x1b[2J\nlook there")) == "no file \\x1b[2J\nlook there"
    assert str(ConfigError(["a: found 'x\ny'"])) == "1 problem in the config:\n  - a: found 'x\\ny'"
    assert len(str(StoreError("x" * 1_000_000))) == 2000


def test_of_many_problems_the_first_are_shown():
    error = ConfigError(f"key{number}: unknown key" for number in range(1000))
    assert len(error.problems) == 1000
    assert str(error).splitlines()[-2:] == ["  - key19: unknown key", "  and 980 more"]


def test_a_name_of_thousands_of_characters_has_no_nearest():
    assert nearest("m" * 100_000, ["m" * 99_999]) == ""


def test_an_unknown_name_is_told_with_the_allowed_ones_and_the_nearest():
    assert unknown("robot", "makro", ["macro"], "robot") == (
        "robot: unknown robot 'makro'. Allowed: macro. Did you mean 'macro'?"
    )
    assert unknown("axis", "x", []) == "unknown axis 'x'. Allowed: none."


def test_the_nearest_of_many_names_is_always_told():
    names = [f"metric_{number}" for number in range(1000)]
    text = str(RunnerError(unknown("metric", "metric_99x", names)))
    assert " more. Did you mean 'metric_99" in text
