"""The guard of a part: its proxy follows the table, and the read-only inputs cannot be changed."""

import copy
from dataclasses import FrozenInstanceError, dataclass

import numpy as np
import pytest

from runner.base.errors import ConfigError, SimulationError
from runner.plugins.guard import Attribute, Guard, Method, array, guarded_like, like, read_only, refuse, unguarded

GUARD = Guard(
    "part",
    twice=Method(like(0)),
    answer=Method(array(2)),
    size=Attribute(optional=True),
    extra=Method(optional=True),
    prepare=Method(fail=refuse),
)


class Part:
    size = 3

    def twice(self, values):
        return 2.0 * values

    def answer(self):
        return [1.0]

    def prepare(self):
        raise ConfigError(["part.size: too small"])


def test_a_proxy_has_the_names_of_its_table_and_of_these_only_what_the_part_has():
    guarded = GUARD(Part())
    assert guarded.twice(np.ones(3)).tolist() == [2.0] * 3
    assert guarded.size == 3
    guarded.part.size = 4
    assert guarded.size == 4
    assert not hasattr(guarded, "extra")
    assert not hasattr(GUARD(object()), "size")


def test_a_required_method_that_a_part_lacks_is_a_fault_when_it_is_asked():
    with pytest.raises(SimulationError, match="'object' object has no attribute 'answer'") as caught:
        GUARD(object()).answer()
    assert "t =" not in str(caught.value)
    with pytest.raises(ConfigError, match=r"part.kind: its prepare: AttributeError: .* has no attribute 'prepare'"):
        GUARD(object()).prepare()


def test_a_wrong_answer_names_the_method_and_an_error_of_ours_passes():
    with pytest.raises(SimulationError, match=r"Part.answer \(test_guard.py, line \d+\) gave an array of shape \(1,\)"):
        GUARD(Part()).answer()
    with pytest.raises(ConfigError, match=r"part.size: too small"):
        GUARD(Part()).prepare()


def test_a_method_that_a_part_replaces_later_is_asked():
    guarded = GUARD(Part())
    guarded.part.answer = lambda: (1.0, 2.0)
    assert guarded.answer().tolist() == [1.0, 2.0]


def test_a_guard_is_put_around_another_part_if_the_first_has_one():
    part, other = Part(), Part()
    assert unguarded(guarded_like(GUARD(part), other)) is other
    assert guarded_like(part, other) is other
    assert unguarded(part) is part
    guarded = GUARD(part)
    assert copy.deepcopy(guarded) is guarded


def test_an_array_is_copied_and_cannot_be_written_to():
    own = np.zeros(3)
    handed = read_only(own)
    with pytest.raises(ValueError, match="read-only"):
        handed[0] = 1.0


def test_a_copy_made_writable_again_reaches_nothing():
    own = np.zeros((2, 3))
    handed = read_only(own[0])
    handed.setflags(write=True)
    handed[0] = 1.0
    assert not own.any()


@dataclass(frozen=True)
class Record:
    values: np.ndarray
    inner: "Record | None" = None
    name: str = "a"


def test_arrays_of_a_dataclass_are_copied_and_cannot_be_written_to():
    own = Record(np.zeros(2), Record(np.ones(2)))
    handed = read_only(own)
    for values in (handed.values, handed.inner.values):
        with pytest.raises(ValueError, match="read-only"):
            values[0] = 2.0
    with pytest.raises(FrozenInstanceError):
        handed.name = "b"
    assert handed.inner.values.tolist() == [1.0, 1.0]
    assert handed.name == "a"
