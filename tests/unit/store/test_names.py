"""Names of runs as bytes: size, look-up and choice of the best entry."""

import numpy as np

from runner.store.names import Names, best_of_each, look_up

TEXTS = ["00" * 12, "ff" * 12, "0123456789abcdef01234567"]


def test_names_are_a_sequence_of_texts_and_are_stored_in_12_bytes_each():
    names = Names.of(TEXTS)
    assert list(names) == TEXTS
    assert (names[1], list(names[1:]), len(names)) == (TEXTS[1], TEXTS[1:], 3)
    assert names == TEXTS
    assert names != TEXTS[:2]
    assert len(names.packed()) == 36
    assert Names.unpacked(names.packed()) == names
    assert len(Names.of([])) == 0


def test_names_are_looked_up_in_ascending_ones():
    ordered = np.array([b"a", b"c", b"d"])
    assert look_up(np.array([b"d", b"b", b"a", b"e"]), ordered).tolist() == [2, -1, 0, -1]
    assert look_up(np.array([b"d"]), ordered[:0]).tolist() == [-1]


def test_the_best_entry_of_each_name_is_chosen():
    names = np.array([b"b", b"a", b"b", b"a"])
    assert best_of_each(names, np.array([1, 0, 0, 0]), np.array([0, 1, 0, 0])).tolist() == [3, 2]
