"""Replay of a log: the run in which the log's commands drive the model of the arm."""

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from runner.assembly.long_motion import with_long_motion
from runner.assembly.validation import validate
from runner.base.atomic import write_atomically
from runner.base.errors import RunnerError
from runner.config.compose.compose import compose
from runner.doctor.log import examine_log, map_of
from runner.doctor.log_files import MAP, MOTION, map_text
from runner.recordings.columns_map import ColumnsMap, read_map
from runner.recordings.recording import Recording, check_gaps, to_recording
from runner.store import Run
from runner.sweeps import job
from runner.sweeps.arm import arm_of

FOLDER = "logs"
"""Folder in the outputs folder of the maps and motions of logs."""


@dataclass(frozen=True)
class Replay:
    """The run of a log.

    Attributes:
        run: The run.
        columns: The column map that was used.
        commanded: Whether the run follows commanded positions; otherwise it follows the measured ones.
        notes: What was done to make the motion, and the error that it makes.
        recording: The signals of the log.
    """

    run: Run
    columns: Path
    commanded: bool
    notes: tuple[str, ...]
    recording: Recording | None


def replay(
    log: Path,
    robot: str,
    outputs: Path,
    controller: str = "computed_torque",
    columns: Path | None = None,
    config_dirs: Sequence[Path] = (),
    fill_gaps: float = 0.0,
) -> Replay:
    """Simulate the motion of a log with a model of the arm, in closed loop, or find the stored run.

    Args:
        log: The log, a file or a folder.
        robot: Name of the robot, as in `robot=ROBOT`.
        outputs: Outputs folder.
        controller: Name of the controller, as in `controller=NAME`.
        columns: Column map; None for the one that the doctor proposes.
        config_dirs: Config folders of the user.
        fill_gaps: Longest gap of the log that is filled, in s; 0 for none.

    Raises:
        RunnerError: if the log cannot be read, has longer gaps, a jump or open questions; names them.
        ConfigError: if the robot or controller does not exist, or the run cannot be made.
    """
    check_gaps(fill_gaps)
    model = arm_of(robot, config_dirs).model
    found = examine_log(log, model, given=columns)
    recording = found.recording
    if found.motion is None:
        asked = (
            "; ".join(f"{one.place}: {one.text.rstrip('.')}" for one in found.questions)
            or "no position of each joint is known"
        )
        given = "" if columns is None else f" --columns {columns}"
        hint = f". `runner doctor {log} --robot {robot}{given} -o FOLDER` writes a map to complete for --columns"
        of_rows = bool(found.questions) and all(one.place == "log" for one in found.questions)
        raise RunnerError(f"{log}: {asked}{'.' if of_rows else hint}")
    said = None if columns is None else read_map(columns, model.joint_names, model.joint_units)[0]
    if recording is not None and recording.filled:  # by the doctor, without asking
        own = ColumnsMap.model_validate(map_of(found, None, None)) if said is None else said
        to_recording(found.table, own, recording.units, fill_gaps)
    if not (found.motion.commanded or (recording is not None and recording.of_kind("torque"))):
        raise RunnerError(f"{log}: has neither commanded positions nor torques, so that a replay says nothing.")
    texts = {MOTION: found.motion.text} | ({MAP: map_text(found, None, None)} if columns is None else {})
    digest = hashlib.sha256("\0".join((robot, *texts.values())).encode()).hexdigest()[:24]
    folder = outputs / FOLDER / digest
    for name, text in texts.items():
        write_atomically(folder / name, text.encode())
    carried = said.payload.overrides if said is not None and said.payload is not None else ()
    overrides = (
        f"robot={robot}",
        f"controller={controller}",
        "trajectory=from_file",
        f"trajectory.file={folder / MOTION}",
        "plant=rk4",
        f"outputs={outputs}",
        *carried,
    )
    run, _ = job.perform(job.RunJob(with_long_motion(validate(compose(overrides, config_dirs)))))
    return Replay(run, columns or folder / MAP, found.motion.commanded, found.motion.notes, recording)
