"""Check if your robot fits.

Each finding is one line. `refused` bars the robot. `fixed` was changed in the copy that --output writes; the line has
the old and the new value. A `note` needs no change. The config folder holds the robot's YAML and a copy of its file; an
MJCF becomes a URDF if something is fixed. A robot whose links have no mass gets joint position commands. Exit code 2:
no config can be written.

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


def add_arguments(parser: Parser) -> None:
    """Add the arguments."""
    parser.add_argument("file", type=Path, metavar="FILE", help="a URDF or an MJCF")
    parser.add_argument("--tip", metavar="FRAME", help="link that is the tip (default: where the arm ends)")
    parser.add_argument("--name", metavar="NAME", help="name of the robot (default: from the file or its folder)")
    parser.add_argument(
        "--package-path", action="append", default=[], type=Path, metavar="DIR",
        help="folder with the ROS packages of its meshes; repeat for more",
    )  # fmt: skip
    parser.add_shared(output="folder to write (default: nothing is written)")
    parser.add_formats(_FORMATS, "config: a config folder; html: report.html with a drawing (default: config)")


def run(options: Namespace) -> int:
    """Examine one file; print the findings, and the folders made as the last lines."""
    if options.format and options.output is None:
        options.parser.error("--format needs --output DIR")
    if not options.file.is_file():
        raise RunnerError(f"{options.file}: no such file. Allowed: a URDF or an MJCF.")
    from runner.doctor.examination import examine

    packages = [*options.package_path, *filter(None, os.environ.get("ROS_PACKAGE_PATH", "").split(os.pathsep))]
    found = examine(options.file, options.tip, options.name, [Path(each) for each in packages])
    joints = "refused" if found.arm is None else f"{found.arm.model.nq} joints"
    print(one_line(f"{found.name}: {joints}, tip '{found.tip}'"))
    for finding in found.findings:
        print(one_line(str(finding)))
    folder, formats = options.output, options.format or ["config"]
    if folder is not None and "html" in formats:
        from runner.reporting.doctor_report import doctor_document
        from runner.reporting.render import write_report

        write_report(doctor_document(found), folder, ("html",))
    if folder is not None and "config" in formats:
        from runner.doctor.config_folder import write_folder  # imports the models of all config groups

        write_folder(found, folder)
        print(shlex.join(["runner", "--config-dir", str(folder), f"robot={found.name}"]))
    if folder is not None:
        print(folder)
    return 2 if found.arm is None else 0
