"""Read-only arrays: writing is refused and reaches nothing."""

from dataclasses import FrozenInstanceError, dataclass

import numpy as np
import pytest

from runner.plugins.guard import read_only


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
    for array in (handed.values, handed.inner.values):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 2.0
    with pytest.raises(FrozenInstanceError):
        handed.name = "b"
    assert handed.inner.values.tolist() == [1.0, 1.0]
    assert handed.name == "a"
