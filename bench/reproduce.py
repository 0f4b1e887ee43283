"""Wall time of `runner reproduce STUDY` in an empty folder: its runs, then its report."""

import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

TARGETS = {
    "thesis": 150.0,
    "thesis_beyond": 90.0,
    "xarm7": 40.0,
    "meca500": 60.0,
    "audit": 30.0,
    "engines": 120.0,
    "precision": 120.0,
    "benchmark": 480.0,
}  # s
_BORDER = b"writing the report"  # said on standard error when the last run is stored


def main(rounds: int | None = None) -> bool:
    """Measure and print; return whether every target is met.

    Args:
        rounds: With 1, only the study of the shortest target is made.
    """
    chosen = dict([min(TARGETS.items(), key=lambda item: item[1])]) if rounds == 1 else TARGETS
    met = [_measure(study, target) for study, target in chosen.items()]
    return all(met)


def _measure(study: str, target: float) -> bool:
    command = [str(Path(sys.executable).parent / "runner"), "reproduce", study]
    with tempfile.TemporaryDirectory() as folder:
        start = time.perf_counter()
        with subprocess.Popen(command, cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE) as process:
            assert process.stderr is not None
            said = b""
            while _BORDER not in said and (piece := os.read(process.stderr.fileno(), 4096)):
                said += piece
            simulated = time.perf_counter() - start
            process.stderr.read()
        whole = time.perf_counter() - start
        if process.returncode != 0:
            raise subprocess.CalledProcessError(process.returncode, command, stderr=said)
        runs = len(list(Path(folder, "outputs", "runs").glob("*/metrics.json")))
        sizes = {path.name: path.stat().st_size for path in Path(folder).glob(f"outputs/reports/{study}/*")}
    print(f"runner reproduce {study}, wall time in an empty folder")
    print(f"  {runs} runs simulated and stored  {simulated:5.1f} s")
    print(f"  figures and report         {whole - simulated:5.1f} s")
    print(f"  whole                      {whole:5.1f} s  target {target:g}: {'met' if whole <= target else 'MISSED'}")
    print("  " + ", ".join(f"{name} {size / 1e6:.1f} MB" for name, size in sorted(sizes.items())))
    return whole <= target
