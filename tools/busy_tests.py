"""The tests next to other work: in random order, next to busy loops, with a home folder that is empty and read-only.

`python -m tools.busy_tests [SEED]` prints the seed of the order; the same seed gives the same order.
"""

import contextlib
import os
import random
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

_LOOPS = 4
_LOOP = "import os\nparent = os.getppid()\nwhile os.getppid() == parent:\n    pass"  # ends with what started it


def main(arguments: list[str]) -> int:
    """Run the tests; return pytest's exit code."""
    seed = int(arguments[0]) if arguments else random.SystemRandom().randrange(2**31)
    print(f"order of the tests: seed {seed}", flush=True)
    order = ["-p", "randomly", f"--randomly-seed={seed}"]
    with _busy_loops(), _read_only_home() as home:
        return subprocess.run(
            [sys.executable, "-m", "pytest", *order, "-n", "2"],
            env={**os.environ, "HOME": str(home)},
            check=False,
        ).returncode


@contextlib.contextmanager
def _busy_loops() -> Iterator[None]:
    loops = [subprocess.Popen([sys.executable, "-S", "-c", _LOOP]) for _ in range(_LOOPS)]
    try:
        yield
    finally:
        for loop in loops:
            loop.kill()
            loop.wait()


@contextlib.contextmanager
def _read_only_home() -> Iterator[Path]:
    with tempfile.TemporaryDirectory() as folder:
        home = Path(folder)
        home.chmod(0o555)
        try:
            yield home
        finally:
            home.chmod(0o755)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
