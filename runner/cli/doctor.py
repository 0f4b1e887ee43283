"""`runner doctor FILE [--tip FRAME] [--name NAME] [--write DIR] [--html DIR]`: does a robot of yours fit?

It prints one line for each thing found: `refused` bars the robot, `fixed` was changed in the copy that --write makes,
with what it was and is, a `note` is good to know. `--write` makes a config folder with a robot's YAML and a copy of the
URDF; an MJCF is copied as it is, or becomes a URDF where something is fixed. A robot whose links have no mass gets a
config whose joints go where they are told. Exit codes: 0 it fits, 2 nothing can be written of it.
"""

import os
import shlex
from collections.abc import Sequence
from pathlib import Path

from runner.base.errors import RunnerError
from runner.base.quiet import quiet_environment
from runner.base.texts import one_line
from runner.cli.arguments import Parser


def main(arguments: Sequence[str]) -> int:
    """Examine one file; print what was found, and the folders made as the last lines."""
    parser = Parser("doctor", __doc__)
    parser.add_argument("file", type=Path, metavar="FILE", help="a URDF or an MJCF")
    parser.add_argument("--tip", metavar="FRAME", help="link that is the tip; default: where the arm ends")
    parser.add_argument("--name", metavar="NAME", help="name of the robot; default: that of the file or its folder")
    parser.add_argument(
        "--package-path", action="append", default=[], type=Path, metavar="DIR",
        help="folder with the ROS packages of its meshes; again for more",
    )  # fmt: skip
    parser.add_argument("--write", type=Path, metavar="DIR", help="make a config folder to start from")
    parser.add_argument("--html", type=Path, metavar="DIR", help="write report.html there, with the robot drawn")
    options = parser.parse_args(arguments)
    if not options.file.is_file():
        raise RunnerError(f"no file {options.file}")
    quiet_environment()
    from runner.doctor.config_folder import write_folder
    from runner.doctor.examination import examine

    packages = [*options.package_path, *filter(None, os.environ.get("ROS_PACKAGE_PATH", "").split(os.pathsep))]
    found = examine(options.file, options.tip, options.name, [Path(each) for each in packages])
    joints = "refused" if found.arm is None else f"{found.arm.model.nq} joints"
    print(one_line(f"{found.name}: {joints}, tip '{found.tip}'"))
    for finding in found.findings:
        print(one_line(str(finding)))
    if options.html is not None:
        from runner.reporting.doctor_report import doctor_document
        from runner.reporting.render import write_report

        write_report(doctor_document(found), options.html, ("html",))
        print(options.html)
    if options.write is not None:
        write_folder(found, options.write)
        print(shlex.join(["runner", "--config-dir", str(options.write), f"robot={found.name}"]))
        print(options.write)
    return 2 if found.arm is None else 0
