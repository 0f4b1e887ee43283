"""Limits of what comes from outside: at the limit, beyond it, and what claims to be small."""

import os

import pyarrow as pa
import pyarrow.parquet
import pytest

from runner.base.limits import ExcessError, Limit, half_of_memory, open_parquet, read_text


@pytest.mark.parametrize(
    ("found", "told"),
    [
        (0, ""),
        (1000, ""),
        (1001, "has 1,001 rows; allowed: up to 1,000"),
        (1e9, "has 1,000,000,000 rows; allowed: up to 1,000"),
    ],
)
def test_what_is_beyond_is_told_with_both_numbers(found, told):
    assert Limit(1000, "rows").excess(found) == told


def test_a_text_is_read_up_to_the_limit(tmp_path):
    path = tmp_path / "a"
    path.write_text("äb")
    assert read_text(path, Limit(3, "bytes")) == "äb"
    with pytest.raises(ExcessError, match="has 3 bytes; allowed: up to 2"):
        read_text(path, Limit(2, "bytes"))


def test_a_file_of_three_terabytes_is_not_read(tmp_path):
    with (tmp_path / "a").open("wb") as file:
        file.truncate(3 * 10**12)
    with pytest.raises(ExcessError, match="has 3,000,000,000,000 bytes; allowed: up to 5"):
        read_text(tmp_path / "a", Limit(5, "bytes"))


def test_pipes_and_devices_are_not_read(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "device").symlink_to("/dev/zero")
    for name in ("pipe", "device"):
        with pytest.raises(ExcessError, match="is a pipe or a device; allowed: files"):
            read_text(tmp_path / name, Limit(5, "bytes"))


def test_parquet_is_measured_by_what_it_unpacks_to(tmp_path):
    path = tmp_path / "zeros.parquet"
    pa.parquet.write_table(pa.table({"a": [b"\0" * 1_000_000]}), path, compression="zstd", use_dictionary=False)
    assert path.stat().st_size < 10_000
    size = open_parquet(path).metadata.row_group(0).total_byte_size
    assert size >= 1_000_000
    assert open_parquet(path, Limit(size, "bytes")).metadata.num_rows == 1
    with pytest.raises(ExcessError, match=rf"it has {size:,} bytes; allowed: up to {size - 1:,}, unpacked"):
        open_parquet(path, Limit(size - 1, "bytes"))


def test_half_of_the_memory_is_that_of_the_machine_or_of_the_control_group():
    assert 1e8 < half_of_memory() <= os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") / 2
