"""Rows of text tables with lists of numbers in a cell, or with one joint each, as rows of one number in each column."""

import re
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from runner.base.arrays import FloatArray
from runner.base.errors import TableError
from runner.base.sanitize import quoted

Row = tuple[int, list[str]]
"""The number of a line, and its cells."""

_COMMAS = re.compile(r"\[[^\]]*\]|\([^)]*\)|,")  # a list, or a comma outside of one
_WIDEST = 1000  # numbers in a cell
_LIST = re.compile(r"(?:array)?\(?\[([^\[\]()]*)\](?:, *dtype=\w+)?\)?|\(([^\[\]()]*)\)")
_JOINT = re.compile(
    r"(joint|motor|axis|actuator|servo|dof|achse|gelenk)s?_?(name|id|index|number|nr|no)?|name|variable|signal|id"
)
_ALIKE = 0.9  # of the first cells, from which on another one is an error
_MOST_JOINTS = 100
_FILLED = 0.6  # of the pairs of time and joint
_FORWARD = 0.9  # of a joint's times that are after the one before


def with_points(line: str) -> str:
    """Return a line with decimal points for decimal commas; those in lists stay."""
    return _COMMAS.sub(lambda match: "." if match[0] == "," else match[0], line)


def numbers_of(cell: str) -> list[str] | None:
    """Return the texts of the numbers in a cell such as [0.1, 0.2], [0.1 0.2] or (0.1, 0.2); None for another cell."""
    match = _LIST.fullmatch(cell.strip())
    if match is None:
        return None
    texts = (match[1] if match[1] is not None else match[2]).replace(",", " ").split()
    try:
        return texts if all(float(text) is not None for text in texts) else None
    except ValueError:
        return None


def list_widths(sample: Sequence[Row], names: Sequence[str]) -> dict[int, int]:
    """Return the number of numbers in each cell of the columns that have lists, by the column's index."""
    widths: dict[int, int] = {}
    for place in range(len(names)):
        texts = [cells[place] for _, cells in sample if place < len(cells) and cells[place].strip()]
        lengths = Counter(len(found) for text in texts if (found := numbers_of(text)) is not None)
        (width, count), *_ = lengths.most_common(1) or [(0, 0)]
        if 0 < width <= _WIDEST and count >= _ALIKE * len(texts):
            widths[place] = width
    return widths


def flat_names(names: Sequence[str], widths: Mapping[int, int]) -> list[str]:
    """Return the names of columns, NAME.0, NAME.1 and so on for those with lists."""
    return [
        label
        for place, name in enumerate(names)
        for label in ([f"{name}.{part}" for part in range(widths[place])] if place in widths else [name])
    ]


def flat_rows(path: Path, rows: Iterable[Row], names: Sequence[str], widths: Mapping[int, int]) -> Iterator[Row]:
    """Yield rows with each number of a list in a separate cell.

    Raises:
        TableError: if a list has another number of numbers; names the line.
    """
    for line, cells in rows:
        if len(cells) not in (len(names), len(names) + 1):
            yield line, cells
            continue
        flat: list[str] = []
        for place, cell in enumerate(cells):
            width = widths.get(place)
            if width is None:
                flat.append(cell)
                continue
            found = numbers_of(cell) if cell.strip() else [""] * width
            if found is None:
                raise TableError(
                    path, f"line {line}: {names[place]} is {quoted(cell)}; allowed: a list of {width} numbers"
                )
            if len(found) != width:
                raise TableError(
                    path, f"line {line}: {names[place]} has a list of {len(found)} numbers; the first row has {width}"
                )
            flat += found
        yield line, flat


def joint_column(names: Sequence[str]) -> int | None:
    """Return the index of the column that may name the joint of a row, in a table of one row for each joint."""
    return next((place for place, name in enumerate(names) if _JOINT.fullmatch(name.strip().lower())), None)


def coded_rows(rows: Iterable[Row], place: int, codes: dict[str, int]) -> Iterator[Row]:
    """Yield rows with a number for each text of a column; codes receives the texts."""
    for line, cells in rows:
        if place < len(cells):
            cells[place] = str(codes.setdefault(cells[place].strip(), len(codes)))
        yield line, cells


def by_joint(
    path: Path, names: Sequence[str], numbers: FloatArray, lines: NDArray[np.int64], joint: int, labels: Sequence[str]
) -> tuple[dict[str, FloatArray], NDArray[np.int64]] | None:
    """Return a table of one row for each time and joint as columns; None if it is not such a table.

    Args:
        path: Its file.
        names: Names of its columns.
        numbers: Its numbers, shape (N, n).
        lines: Line of each row, shape (N,).
        joint: Index of the column of the joint, whose numbers are indices of labels.
        labels: Names of the joints.

    Returns:
        The columns JOINT.NAME, or JOINT if the only NAME is value, with NaN where a joint has no row at a time; and
        the first line of each time.

    Raises:
        TableError: if a joint has two rows at a time; names the line.
    """
    if not 2 <= len(labels) <= _MOST_JOINTS or not len(numbers):
        return None
    code = numbers[:, joint].astype(int)
    time = next((place for place in range(len(names)) if place != joint and _is_time(numbers[:, place], code)), None)
    if time is None:
        return None
    times, first, row = np.unique(numbers[:, time], return_index=True, return_inverse=True)
    pairs, counts = np.unique(row * len(labels) + code, return_counts=True)
    if (counts > 1).any():
        again = np.flatnonzero(row * len(labels) + code == pairs[np.argmax(counts > 1)])[1]
        raise TableError(
            path, f"line {lines[again]}: {labels[code[again]]} has a second row at {names[time]} {times[row[again]]:g}"
        )
    parts = [place for place in range(len(names)) if place not in (time, joint)]
    alone = [names[place].strip().lower() for place in parts] == ["value"]  # as pandas melts a table
    columns = {names[time]: times}
    for place in parts:
        wide = np.full((len(times), len(labels)), np.nan)
        wide[row, code] = numbers[:, place]
        for index, label in enumerate(labels):
            columns[label if alone else f"{label}.{names[place]}"] = wide[:, index]
    return columns, lines[first]


def _is_time(values: FloatArray, code: NDArray[np.intp]) -> bool:
    """Return whether a column has the same growing times for all joints."""
    if np.isnan(values).any():
        return False
    count = len(np.unique(values))
    joints = int(code.max()) + 1
    if count < 2 or not _FILLED * count * joints <= len(values):
        return False
    steps = np.diff(values[code == 0])
    return bool(len(steps)) and not (steps < 0.0).any() and float(np.mean(steps > 0.0)) > _FORWARD
