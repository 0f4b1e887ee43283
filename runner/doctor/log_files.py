"""Files of an examined log: its column map, with a line to fill in for each question, and the motion for a run."""

import shlex
from pathlib import Path

import yaml

from runner.base.atomic import write_atomically
from runner.base.errors import RunnerError, StoreError
from runner.base.sanitize import one_line
from runner.doctor.log import LogExamination
from runner.doctor.log_meanings import Meaning

MAP, MOTION = "columns.yaml", "motion.csv"


def write_log_files(
    found: LogExamination, folder: Path, given: Path | None, topic: str | None, episode: int | None
) -> None:
    """Write the column map, unless one was given, and the motion, if there is one.

    Raises:
        RunnerError: if a column map is there already, or a file cannot be written.
    """
    path = folder / MAP
    if path.exists() and (given is None or given.resolve() != path.resolve()):
        raise RunnerError(f"--output: {path} exists already; choose another folder, or take it by --columns {path}")
    try:
        if given is None:
            write_atomically(path, map_text(found, topic, episode).encode())
        elif given.resolve() != path.resolve():
            write_atomically(path, given.read_bytes())
        if found.motion is not None:
            write_atomically(folder / MOTION, found.motion.text.encode())
    except (OSError, StoreError) as error:
        raise RunnerError(f"--output: {error}") from error


def map_text(found: LogExamination, topic: str | None, episode: int | None) -> str:
    """Return the column map as YAML, each line with its reason."""
    lines = [f"# Columns of {one_line(found.table.path.name)}, by runner doctor"]
    lines += [f"topic: {_flow(topic)}"] if topic is not None else []
    lines += [f"episode: {episode}"] if episode is not None else []
    if found.time is None:
        lines.append("rate: null  # fill in: rows in a second, in Hz")
    else:
        keys = {"column": found.time.column, **{key: value or None for key, value in found.time.keys.items()}}
        lines.append(f"time: {_flow(keys)}{_comment(found.time)}")
    lines.append("columns:")
    for one in found.meanings:
        optional = "# " if one.asked and "torque" in one.keys else ""
        lines.append(f"  {optional}{_flow(one.column)}: {_flow(dict(one.keys))}{_comment(one)}")
    return "\n".join(lines) + "\n"


def _comment(one: Meaning) -> str:
    return f"  # {one_line(f'fill in: {one.asked}' if one.asked else one.reason, 300)}"


def _flow(value: object) -> str:
    text = yaml.safe_dump(value, default_flow_style=True, sort_keys=False, width=10**6, allow_unicode=True)
    return text.removesuffix("\n").removesuffix("\n...").strip()


def next_line(found: LogExamination, robot: str, folder: Path) -> str:
    """Return the line that runs the motion and compares the run with the log; or the line that follows the answers."""
    log, columns = shlex.quote(str(found.table.path)), shlex.quote(str(folder / MAP))
    if found.motion is None:
        return shlex.join(
            [
                "runner",
                "doctor",
                str(found.table.path),
                "--robot",
                robot,
                "--columns",
                str(folder / MAP),
                "-o",
                str(folder),
            ]
        )
    run = shlex.join(
        ["runner", f"robot={robot}", "controller=computed_torque", "trajectory=from_file",
         f"trajectory.file={folder / MOTION}", "plant=rk4"]
    )  # fmt: skip
    gaps = " --fill-gaps 100ms" if found.recording is not None and found.recording.filled else ""
    return f"{run} && runner compare latest {log} --columns {columns}{gaps}"
