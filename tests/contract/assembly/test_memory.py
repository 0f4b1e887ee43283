"""Memory of checked parts: one call for equal arguments, and no part is shared that differs."""

from dataclasses import replace

from runner.assembly.validation import validate
from runner.base.memory import Memory
from runner.config.compose.compose import compose


def test_a_function_is_called_once_for_the_same_arguments():
    calls = []

    def note(*parts):
        calls.append(parts)
        return len(calls)

    memory, group = Memory(100), {"a": 1}
    assert [memory.recall(note, group, 1.5, "x") for _ in range(3)] == [1, 1, 1]
    assert memory.recall(note, group, 1.5, "y") == 2
    assert memory.recall(note, dict(group), 1.5, "x") == 3  # equal, but another object
    assert [memory.recall(note, value) for value in (1, 1.0, True)] == [4, 5, 6]


def test_what_is_not_asked_for_is_forgotten_and_what_is_stays():
    doubled = []

    def double(number):
        doubled.append(number)
        return 2 * number

    memory = Memory(20)
    for number in range(200):
        assert memory.recall(double, number) == 2 * number
        assert memory.recall(double, 0) == 0
    assert len(memory._recent) + len(memory._older) <= 20
    assert doubled == list(range(200))
    assert memory.recall(double, 1) == 2
    assert doubled[-1] == 1  # forgotten


def test_what_follows_from_parts_is_made_once_for_the_same_parts():
    memory, path = Memory(100), object()
    found = [memory.known(("desired", path, count), object) for count in (5, 5, 6)]
    assert found[0] is found[1] is not found[2]
    assert memory.known(("home", path, 5), object) is not found[0]


def test_what_groups_give_is_shared_by_configs_that_share_them():
    composed = compose(["robot=macro"])
    resolved = composed.resolved
    one, two = (validate(replace(composed, resolved={**resolved, "seed": seed})) for seed in (1, 2))
    assert (one.settings.seed, two.settings.seed) == (1, 2)
    assert one.robot is two.robot
    assert one.loops is two.loops
    assert one.path is two.path
    other = validate(replace(composed, resolved={**resolved, "noise": {**resolved["noise"], "position": 0.5}}))
    assert other.noise.position[0] == 0.5
    assert other.loops is one.loops
