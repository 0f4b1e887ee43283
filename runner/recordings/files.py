"""Tables of logs by content: text, JSON, Parquet, NumPy's arrays, LeRobot folders, mecademicpy's zip, ROS bags."""

import io
import zipfile
import zlib
from collections.abc import Sequence
from pathlib import Path

from runner.base.errors import RunnerError
from runner.base.limits import LOG_FILES, RECORDING, ExcessError
from runner.base.tables import NumericTable, read_table, read_text_table
from runner.recordings.arrays import read_arrays
from runner.recordings.bags import bag_files, read_bag
from runner.recordings.json_logs import is_json, read_json
from runner.recordings.lerobot import EPISODE, INFO, one_episode, read_lerobot

_FOLDERS = "a bag of ROS 2 (.mcap or .db3 files), or a LeRobot data set (meta/info.json)"


def is_log_folder(path: Path) -> bool:
    """Return whether a folder holds a log: a bag, or a LeRobot data set."""
    return path.is_dir() and ((path / INFO).is_file() or (path / "metadata.yaml").is_file() or bool(bag_files(path)))


def read_log(
    path: Path, wanted: Sequence[str] | None = None, topic: str | None = None, episode: int | None = None
) -> NumericTable:
    """Return the columns of a log.

    Args:
        path: The log, a file or a folder.
        wanted: The columns to read, each of whose cells holds a number or nothing; None for all that hold numbers.
        topic: Of a ROS bag: the topic of the joint states; None if it has only one.
        episode: Of a LeRobot data set: the episode; None for its longest.

    Raises:
        RunnerError: if it is not a known log, cannot be read, or lacks a column; names the line.
    """
    try:
        table = _read(path, wanted, topic, episode)
    except (OSError, ExcessError, UnicodeError, zipfile.BadZipFile, zlib.error) as error:
        raise RunnerError(f"cannot read {path}: {error}") from error
    if wanted is not None:
        table.require(wanted)
    return table


def _read(path: Path, wanted: Sequence[str] | None, topic: str | None, episode: int | None) -> NumericTable:
    if path.is_dir():
        return _read_folder(path, topic, episode)
    if path.is_fifo() or path.is_char_device():
        raise ExcessError("it is a pipe or a device; allowed: files")
    if bag_files(path):
        return read_bag(path, topic)
    if topic is not None:
        raise RunnerError(f"{path}: topic: is for ROS bags. Allowed: null for other logs.")
    if excess := RECORDING.excess(path.stat().st_size):
        raise ExcessError(f"it {excess}")
    if zipfile.is_zipfile(path):
        return _read_zip(path, wanted)
    if is_json(path):
        return _of_episode(path, read_json(path), episode)

    def choose(names: Sequence[str]) -> list[str]:
        return [*(wanted or ()), *([EPISODE] if EPISODE in names else [])]

    return _of_episode(path, read_table(path, None if wanted is None else choose), episode)


def _of_episode(path: Path, table: NumericTable, episode: int | None) -> NumericTable:
    if EPISODE in table.columns:
        return one_episode(table, episode)
    if episode is not None:
        raise RunnerError(f"{path}: episode: is for logs with the column {EPISODE}. Allowed: null for other logs.")
    return table


def _read_folder(path: Path, topic: str | None, episode: int | None) -> NumericTable:
    if (path / INFO).is_file():
        return read_lerobot(path, episode)
    count = 0
    for count, _ in enumerate(path.iterdir(), start=1):
        if count > LOG_FILES.most:
            break
    if count <= LOG_FILES.most and bag_files(path):
        return read_bag(path, topic)
    many = f"more than {LOG_FILES.most:,}" if count > LOG_FILES.most else f"{count:,}"
    raise RunnerError(f"{path}: a folder of {many} files is not a log. Allowed: one file, {_FOLDERS}.")


def _read_zip(path: Path, wanted: Sequence[str] | None) -> NumericTable:
    """Return NumPy's arrays, or the largest CSV file, which mecademicpy writes together with a description."""
    with zipfile.ZipFile(path) as archive:
        if any(item.filename.endswith(".npy") for item in archive.infolist()):
            return read_arrays(path, archive)
        texts = [item for item in archive.infolist() if item.filename.lower().endswith(".csv")]
        if not texts:
            raise RunnerError(f"{path}: has no CSV file in it. Allowed: a zip of mecademicpy, and .npz of NumPy.")
        largest = max(texts, key=lambda item: item.file_size)
        if excess := RECORDING.excess(largest.file_size):
            raise ExcessError(f"it {excess}, unpacked")
        with archive.open(largest) as file, io.TextIOWrapper(file, encoding="utf-8-sig", newline="") as text:
            return read_text_table(path, text, wanted, f"{largest.filename} in a zip file")
