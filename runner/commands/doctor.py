"""`runner doctor FILE [--tip FRAME] [--name NAME] [--write DIR] [--html DIR]`: does it fit, and what to mend?

It prints one line for each thing found, with the mend: `refused` bars the robot, a `finding` should be mended, a `note`
is good to know. `--write` makes a config folder with a robot's YAML and a copy of the URDF, mended where that leaves no
choice; an MJCF is copied as it is, or becomes a URDF where something is to be mended. Exit codes: 0 it fits, 1
findings, 2 it cannot be taken so.
"""

import shlex
from collections.abc import Sequence
from pathlib import Path

from runner.commands.arguments import Parser
from runner.errors import RunnerError
from runner.quiet import quiet_environment
from runner.texts import one_line


def main(arguments: Sequence[str]) -> int:
    """Examine one file; print what was found, and the folders made as the last lines."""
    parser = Parser("doctor", __doc__)
    parser.add_argument("file", type=Path, metavar="FILE", help="a URDF or an MJCF")
    parser.add_argument("--tip", metavar="FRAME", help="link that is the tip; default: the last one")
    parser.add_argument("--name", metavar="NAME", help="name of the robot; default: that of the file or its folder")
    parser.add_argument("--write", type=Path, metavar="DIR", help="make a config folder to start from")
    parser.add_argument("--html", type=Path, metavar="DIR", help="write report.html there, with the robot drawn")
    options = parser.parse_args(arguments)
    if not options.file.is_file():
        raise RunnerError(f"no file {options.file}")
    quiet_environment()
    from runner.doctor.config_folder import write_folder
    from runner.doctor.examination import examine
    from runner.doctor.finding import exit_code

    found = examine(options.file, options.tip, options.name)
    joints = "no arm" if found.model is None else f"{found.model.nq} joints"
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
    return exit_code(found.findings)
