"""Recordings of real arms: reading, time alignment, comparison with stored runs, and friction identification."""

from pathlib import Path

BAGS = (".bag", ".mcap", ".db3")
"""Suffixes of ROS bags in one file."""


def is_bag(path: Path) -> bool:
    """Return whether a recording is a ROS bag, one file or a folder of ROS 2; others are CSV files."""
    return path.suffix.lower() in BAGS or (path / "metadata.yaml").is_file()


def files_of(path: Path) -> list[Path]:
    """Return the files of a recording."""
    return sorted(file for file in path.iterdir() if file.is_file()) if path.is_dir() else [path]
