"""Size limits of external input, checked before memory is allocated."""

import contextlib
import functools
import os
import resource
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple


class Limit(NamedTuple):
    """Upper limit with its unit, such as `Limit(40_000, "numbers")`."""

    most: int
    of: str

    def excess(self, found: float) -> str:
        """Return a message, "has 50,000 numbers; allowed: up to 40,000"; empty if `found` is within the limit."""
        return f"has {found:,.0f} {self.of}; allowed: up to {self.most:,}" if found > self.most else ""


class ExcessError(ValueError):
    """External input that exceeds a limit; the message is that of the limit."""


# At least ten times the known needs; input within all limits takes less than 300 MB and a few seconds.
XML = Limit(5_000_000, "bytes")  # a URDF or MJCF with its included files; a humanoid has 100 kB
XML_ELEMENTS = Limit(20_000, "elements")  # of a URDF
XML_ATTRIBUTES = Limit(200, "attributes in an element")  # engines compare them in pairs
MJCF_ELEMENTS = Limit(2500, "elements")  # an MJCF with its included files; MuJoCo takes up to 50 kB for one element
ARM_PARTS = Limit(2000, "links and joints")
MESH = Limit(20_000_000, "bytes")  # a visual mesh has 10 MB, a collision mesh 1 MB
FACES = Limit(200_000, "faces")  # of an OBJ; PyBullet takes at least 1 kB for one
HEIGHTS = Limit(1_000_000, "heights")  # of a height field, 4 bytes each in every copy
SAMPLES = Limit(500_000, "samples")  # of a motion of the joints, 500 bytes each
READINGS = Limit(1_000_000, "readings")  # of a sensor in a calibration; 1 s of Python
CELLS = Limit(10_000_000, "cells")  # of a sweep, 40 bytes each
TRIALS = Limit(100_000, "trials")  # of a tuning; the sampler takes longer with each
GRID = Limit(10_000, "runs")  # of a grid of a study, each with its strings
CHAPTER = Limit(1_000_000, "bytes")  # a chapter of a study; built-in ones have 20 kB
TABLE = Limit(5_000_000, "bytes")  # the data file of a trajectory
TABLE_NUMBERS = Limit(40_000, "numbers")  # of a data file, which become part of the config
RECORDING = Limit(400_000_000, "bytes")  # of a text or Parquet file
RECORDING_NUMBERS = Limit(24_000_000, "numbers")  # 8 bytes each: 200,000 rows of 120 columns
RECORDING_ROWS = Limit(1_000_000, "rows")  # 15 minutes at 1 kHz; 8 bytes for each column read
RECORDING_ROW = Limit(100_000, "characters in a row")  # 10^4 columns
BAG = Limit(50_000_000_000, "bytes")  # of a ROS bag, which is streamed
BAG_MEMORY = Limit(500_000_000, "bytes")  # of memory for one part of a ROS bag
LOG_FILES = Limit(1000, "files")  # of a log in a folder
RECORD = Limit(50_000_000, "bytes")  # JSON written by the runner; 10^5 listed runs have 20 MB
RECORD_VALUES = Limit(2_000_000, "values")  # of a record, 100 bytes each


def read_text(path: Path, limit: Limit) -> str:
    """Return the content of a text file.

    Raises:
        OSError: if the file cannot be read.
        ValueError: ExcessError if the file is too large or endless; UnicodeDecodeError if it is not UTF-8.
    """
    if path.is_fifo() or path.is_char_device():
        raise ExcessError("is a pipe or a device; allowed: files")
    if excess := limit.excess(path.stat().st_size):
        raise ExcessError(excess)
    return path.read_text(encoding="utf-8")


@contextlib.contextmanager
def bounded_memory(limit: Limit) -> Iterator[None]:
    """Limit additional memory and file size of the process; beyond it, MemoryError or OSError is raised."""
    held = int(Path("/proc/self/statm").read_text().split()[0]) * os.sysconf("SC_PAGE_SIZE")
    with contextlib.ExitStack() as stack:
        for kind, most in ((resource.RLIMIT_AS, held + limit.most), (resource.RLIMIT_FSIZE, limit.most)):
            soft, hard = resource.getrlimit(kind)
            lower = [own for own in (soft, hard) if own != resource.RLIM_INFINITY]
            resource.setrlimit(kind, (min([most, *lower]), hard))
            stack.callback(resource.setrlimit, kind, (soft, hard))
        yield


@functools.cache
def half_of_memory() -> float:
    """Return half of the memory available to the process on this machine or in its control group, in bytes."""
    whole = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    for place in ("memory.max", "memory/memory.limit_in_bytes"):  # cgroup version 2, version 1
        with contextlib.suppress(OSError, ValueError):
            whole = min(whole, int(Path("/sys/fs/cgroup", place).read_text()))
    return whole / 2.0


def open_parquet(source: Any, limit: Limit | None = None) -> Any:
    """Return a pyarrow.parquet.ParquetFile; `limit` is for its unpacked bytes, None is half of the machine's memory.

    Its columns must be read with `use_threads=False`: a thread of Arrow that still releases its buffer while Python
    ends aborts the process (pyarrow 26.0.1, apache/arrow#34314).

    Raises:
        ExcessError: if the unpacked size in its metadata exceeds the limit.
        OSError: if the file cannot be read; pyarrow also raises its own exceptions.
    """
    import pyarrow.parquet

    file = pyarrow.parquet.ParquetFile(source)
    groups = map(file.metadata.row_group, range(file.metadata.num_row_groups))
    allowed = limit or Limit(int(half_of_memory()), "bytes")
    if excess := allowed.excess(sum(group.total_byte_size for group in groups)):
        raise ExcessError(f"it {excess}, unpacked")
    return file
