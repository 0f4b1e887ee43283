"""Values of many repetitions in a Parquet file: numbers bit by bit, NaN as null, and files that are none."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from runner.store.parquet import open_parquet, read_column, values_parquet
from runner.store.seal import DamagedError

PATH = Path("values.parquet")
VALUES = {"a": np.array([0.1, np.nan, -2.5e-300]), "b": np.array([1.0, 2.0, 1.0 / 3.0])}


def test_columns_are_read_as_they_were_written():
    file = open_parquet(values_parquet(VALUES), PATH)
    for name, values in VALUES.items():
        np.testing.assert_array_equal(read_column(file, PATH, name), values)


def test_what_has_no_value_is_null():
    file = open_parquet(values_parquet(VALUES), PATH)
    assert file.read(["a"])["a"].null_count == 1


def test_a_column_that_is_not_there_is_damage():
    with pytest.raises(DamagedError, match=r"cannot read values.parquet: it has no column c; "):
        read_column(open_parquet(values_parquet(VALUES), PATH), PATH, "c")


@pytest.mark.parametrize("content", [b"", b"PAR1", values_parquet(VALUES)[:-20]])
def test_half_a_file_is_damage(content):
    with pytest.raises(DamagedError, match=r"cannot read values.parquet: "):
        open_parquet(content, PATH)


READING = """
import os, sys
from pathlib import Path
from runner.store.parquet import open_parquet, read_table

def threads():
    return len(os.listdir("/proc/self/task"))

path = Path(sys.argv[1])
file = open_parquet(path.read_bytes(), path)
before = threads()
read_table(file, path).to_pandas(use_threads=False)
print(threads() - before)
"""


@pytest.mark.skipif(not Path("/proc/self/task").is_dir(), reason="only Linux lists threads there")
def test_reading_starts_no_thread_that_could_outlive_python(tmp_path):
    path = tmp_path / "values.parquet"
    path.write_bytes(values_parquet(VALUES))
    ended = subprocess.run([sys.executable, "-c", READING, path], check=True, capture_output=True, text=True)
    assert ended.stdout == "0\n"
