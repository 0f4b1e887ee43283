"""Check if your robot or log fits; --output writes its config, or its map and motion. `refused` and `ask` bar it.

Example: runner doctor arm.urdf --output mine
"""

import os
import shlex
from argparse import Namespace
from pathlib import Path

from runner.base.errors import RunnerError
from runner.base.sanitize import one_line
from runner.cli.arguments import Parser

_FORMATS = ("config", "html")
_ROBOTS = (".urdf", ".xml", ".mjcf", ".xacro")


def add_arguments(parser: Parser) -> None:
    """Add the arguments."""
    parser.add_argument(
        "files", type=Path, nargs="+", metavar="FILE", help="a URDF or an MJCF, or logs: files or folders"
    )
    parser.add_argument("--tip", metavar="FRAME", help="link that is the tip (default: where the arm ends)")
    parser.add_argument("--name", metavar="NAME", help="name of the robot (default: that of the file)")
    parser.add_argument(
        "--package-path", action="append", default=[], type=Path, metavar="DIR",
        help="folder with its ROS packages; repeatable",
    )  # fmt: skip
    parser.add_argument("--robot", metavar="ROBOT", help="log: the robot, as in `runner robot=ROBOT`")
    parser.add_argument("--topic", metavar="TOPIC", help="log: topic of the joint states")
    parser.add_argument("--episode", type=int, metavar="N", help="log: episode (default: the longest)")
    parser.add_argument("--columns", type=Path, metavar="FILE", help="log: your column map")
    parser.add_shared("config_dir", output="folder to write (default: nothing is written)")
    parser.add_formats(_FORMATS, "config (default), html: a report")


def run(options: Namespace) -> int:
    """Examine a robot file or logs; print the findings, and the folders made as the last lines."""
    if options.format and options.output is None:
        options.parser.error("--format needs --output DIR")
    robots = [path for path in options.files if _is_robot(path)]
    for path in options.files:
        if not path.exists():
            raise RunnerError(f"{path}: no such file. Allowed: a URDF or an MJCF, or a log.")
    if not robots:
        return _examine_logs(options)
    if len(options.files) > 1:
        raise RunnerError(
            f"{robots[0]}: a robot file among {len(options.files)} files. Allowed: one robot file, or logs."
        )
    for option in ("robot", "topic", "episode", "columns"):
        if getattr(options, option) is not None:
            raise RunnerError(f"--{option}: is for logs ({robots[0]} is a robot file). Leave it out.")
    return _examine_robot(options, robots[0])


def _is_robot(path: Path) -> bool:
    """Return whether a file is XML, as robot files are."""
    if not path.is_file() or path.suffix.lower() in _ROBOTS:
        return path.is_file()
    with path.open("rb") as file:
        return file.read(1000).removeprefix(b"\xef\xbb\xbf").lstrip().startswith(b"<")


def _examine_logs(options: Namespace) -> int:
    for option in ("tip", "name", "package_path", "format"):
        if getattr(options, option):
            raise RunnerError(
                f"--{option.replace('_', '-')}: is for robot files ({options.files[0]} is a log). Leave it out."
            )
    if options.output is not None and options.robot is None:
        raise RunnerError("--output: needs --robot ROBOT, whose joints the column map names.")
    if options.columns is not None and len(options.files) > 1:
        raise RunnerError("--columns: is for one log. Examine the logs one by one.")
    from runner.doctor.log import examine_log
    from runner.doctor.log_files import next_line, write_log_files
    from runner.doctor.log_words import log_lines
    from runner.sweeps.arm import arm_of

    model = arm_of(options.robot, options.config_dir).model if options.robot else None
    # All before the first is written.
    examined = [examine_log(path, model, options.topic, options.episode, options.columns) for path in options.files]
    asked = False
    for found in examined:
        for line in log_lines(found):
            print(line)
        asked |= model is not None and found.motion is None
        if options.output is not None:
            folder = options.output / (found.table.path.stem if len(examined) > 1 else "")
            write_log_files(found, folder, options.columns, options.topic, options.episode)
            print(next_line(found, options.robot, folder))
    if options.output is not None:
        print(options.output)
    return 1 if asked else 0


def _examine_robot(options: Namespace, path: Path) -> int:
    from runner.doctor.examination import examine

    packages = [*options.package_path, *filter(None, os.environ.get("ROS_PACKAGE_PATH", "").split(os.pathsep))]
    found = examine(path, options.tip, options.name, [Path(each) for each in packages])
    joints = "refused" if found.arm is None else f"{found.arm.model.nq} joints"
    print(one_line(f"{found.name}: {joints}, tip '{found.tip}'"))
    for finding in found.findings:
        print(one_line(str(finding)))
    folder, formats = options.output, options.format or ["config"]
    if folder is not None and "html" in formats:
        from runner.assembly.versions import versions
        from runner.reporting.doctor_report import doctor_document
        from runner.reporting.render import write_report

        write_report(doctor_document(found, versions()), folder, ("html",))
    if folder is not None and "config" in formats:
        from runner.doctor.config_folder import write_folder  # imports the models of all config groups

        write_folder(found, folder)
        print(shlex.join(["runner", "--config-dir", str(folder), f"robot={found.name}"]))
    if folder is not None:
        print(folder)
    return 2 if found.arm is None else 0
