"""Files of the runner in which a command line runs a function: `python tools/walked_files.py [--list] ARGUMENTS`.

Counted are Python functions, generators and methods of the main process; bodies of classes and of modules, which run
on import, are left out, as are functions that Pydantic or dataclasses write.
"""

import os
import sys
import time
from pathlib import Path
from types import CodeType, FrameType

PACKAGE = Path(__file__).resolve().parent.parent
OURS = tuple(str(PACKAGE / name) + os.sep for name in ("runner", "hydra_plugins"))


def main() -> None:
    """Run a command line in this process, then print the number of executed files and functions and the CPU time."""
    sys.path.insert(0, str(PACKAGE))
    arguments = sys.argv[1:]
    listed = arguments[:1] == ["--list"]
    sys.argv = ["runner", *arguments[listed:]]
    seen: set[CodeType] = set()

    def watch(frame: FrameType, event: str, _: object) -> None:
        if event == "call":
            seen.add(frame.f_code)

    sys.setprofile(watch)
    try:
        from runner.cli.main import main as command

        command()
    finally:
        sys.setprofile(None)
        ours = [code for code in seen if code.co_filename.startswith(OURS) and not _is_body(code)]
        files = sorted({os.path.relpath(code.co_filename, PACKAGE) for code in ours})
        for file in files if listed else ():
            print(file, file=sys.stderr)
        cpu = time.process_time()
        print(f"{len(files)} files, {len(ours)} functions, {cpu:.2f} s of CPU time", file=sys.stderr)


def _is_body(code: CodeType) -> bool:
    """Return True if code is the body of a module or of a class: only functions have local variables."""
    return not code.co_flags & 0x2


if __name__ == "__main__":
    main()
