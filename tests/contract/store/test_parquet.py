"""Columns made from their buffers are those that pyarrow makes of the values."""

import subprocess
import sys

import numpy as np
import pyarrow
import pytest

from runner.store import parquet
from runner.store.parquet import list_column, numbers, plain_column, text_column
from runner.store.seal import DamagedError


@pytest.mark.parametrize("texts", [[], ["", "ä 中", "a" * 100]])
def test_plain_columns(texts):
    assert text_column(texts).equals(pyarrow.array(texts, pyarrow.string()))
    count = len(texts)
    numbers = np.linspace(-1.0, 1.0, count)
    for values in (numbers, numbers > 0.0, np.arange(count, dtype=np.int32)):
        assert plain_column(values).equals(pyarrow.array(values))


def test_every_second_number_of_an_array_is_a_column_of_its_own():
    assert plain_column(np.arange(6.0)[::2]).to_pylist() == [0.0, 2.0, 4.0]


def test_lists_lack_numbers_and_may_lack_themselves():
    sizes, present = np.array([2, 0, 1, 0]), np.array([True, False, True, True])
    found = list_column(np.array([1.0, np.nan, 3.0]), sizes, present)
    assert found.to_pylist() == [[1.0, None], None, [3.0], []]
    assert found.null_count == 1
    assert list_column(np.arange(3.0), sizes, np.full(4, True)).to_pylist() == [[0.0, 1.0], [], [2.0], []]
    found.validate(full=True)


@pytest.mark.parametrize("chunks", [[], [[]], [[0.5, None, -2.0]], [[1.0], [None, None], [], [3.0, 4.0]]])
def test_numbers_of_a_column_are_those_of_pyarrow(chunks):
    column = pyarrow.chunked_array(chunks, pyarrow.float64())
    np.testing.assert_array_equal(numbers(column), column.to_numpy())
    np.testing.assert_array_equal(numbers(column[1:]), column.to_numpy()[1:])


def test_numbers_of_another_type_are_converted_and_texts_are_refused():
    column = pyarrow.chunked_array([[1, None], [3]])
    np.testing.assert_array_equal(numbers(column), [1.0, np.nan, 3.0])
    np.testing.assert_array_equal(numbers(column.cast(pyarrow.float32())), [1.0, np.nan, 3.0])
    with pytest.raises(DamagedError, match="a column of type string has no numbers"):
        numbers(pyarrow.chunked_array([["a"]]))


def test_texts_beyond_what_a_column_addresses_are_refused(monkeypatch):
    monkeypatch.setattr(parquet, "_MOST_BYTES", 10)
    assert len(text_column(["12345"] * 2)) == 2
    with pytest.raises(ValueError, match="more than 2 GB"):
        text_column(["12345", "123456"])


def test_a_shard_is_written_without_pandas(tmp_path):
    script = f"""
import sys
from pathlib import Path
import numpy as np
from runner.store.shards import RunOutcome, ShardRow, read_outcomes, write_shard
row = ShardRow(RunOutcome("0" * 24, "", False), "{{}}", "", "{{}}", (("rms", "m"),), np.array([[1.0], [np.nan]]))
assert len(read_outcomes(write_shard(Path({str(tmp_path)!r}), "0-0", [row]))) == 1
print("pandas" in sys.modules)
"""
    ran = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert ran.stdout.strip() == "False"
