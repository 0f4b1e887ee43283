"""Runs of studies that were made once and are kept in tests/recorded, so that `make test` needs no simulation of them.

`PYTHONPATH=tests .venv/bin/python -m support.recorded_runs [STUDY...]` records them again. Metrics have six digits,
and a trace has a few of its rows. `make test-slow` repeats the runs and compares their metrics.
"""

import json
import lzma
import sys
import tempfile
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from support.study_plans import RECORDED, recorded_jobs
from support.thin_plans import make_runs

from runner.papers.study.study import load_study
from runner.store import Run

FOLDER = Path(__file__).parents[1] / "recorded"
OUTPUTS = "outputs"
ROWS, MORE_ROWS = 12, 41  # of a trace, and of one of LONG s
LONG = 5.0
DIGITS, EXACT = 6, 11  # EXACT where small differences between traces are read


@dataclass(frozen=True, eq=False)
class RecordedRun(Run):
    """A run whose files are kept elsewhere than in its folder.

    Attributes:
        signals: Unit and values of each column of the trace.
    """

    signals: Mapping[str, tuple[str, list[float]]] = None  # type: ignore[assignment]

    @cached_property
    def _table(self) -> Any:
        import pyarrow

        fields = [pyarrow.field(name, pyarrow.float64(), metadata={"unit": u}) for name, (u, _) in self.signals.items()]
        columns = [np.array(values, dtype=float) for _, values in self.signals.values()]
        return pyarrow.Table.from_arrays([pyarrow.array(c) for c in columns], schema=pyarrow.schema(fields))


def recorded(study: str, outputs: Path) -> dict[str, Run]:
    """Return the recorded runs of a study by name, as though they lay in a folder of outputs."""
    content = json.loads(lzma.decompress((FOLDER / f"{study}.json.xz").read_bytes()))
    return {
        name: RecordedRun(outputs / "runs" / each["hash"], each["config"], each["record"],
                          text=content["urdfs"][each["urdf"]], signals=each["trace"])
        for name, each in content["runs"].items()
    }  # fmt: skip


def record(study: str, runs: Mapping[str, Run]) -> int:
    """Keep runs of a study in its file; return the size of the file, in bytes."""
    urdfs = list(dict.fromkeys(run.urdf for run in runs.values()))
    kept = {
        name: {
            "hash": run.hash,
            "config": {**run.config, "outputs": OUTPUTS},
            "record": rounded(_told(run)),
            "urdf": urdfs.index(run.urdf),
            "trace": _trace(run, EXACT if study == "engines" or run.config["duration"] == LONG else DIGITS),
        }
        for name, run in runs.items()
    }
    text = json.dumps({"urdfs": urdfs, "runs": kept}, separators=(",", ":"))
    FOLDER.mkdir(exist_ok=True)
    return (FOLDER / f"{study}.json.xz").write_bytes(lzma.compress(text.encode(), preset=9 | lzma.PRESET_EXTREME))


def _told(run: Run) -> dict[str, Any]:
    """Return a run's record without digests of files that are not kept, and without this machine's folders."""
    told = {key: value for key, value in run.record.items() if key not in ("files", "digest", "caveat_rules")}
    command = " ".join(word for word in str(run.provenance["command"]).split(" ") if not word.startswith("outputs="))
    return {**told, "provenance": {**run.provenance, "command": command}}


def _trace(run: Run, digits: int) -> dict[str, tuple[str, list[float | None]]]:
    frame, units = run.trace(), run.units
    long = (run.config["duration"] or 0.0) >= LONG
    rows = np.unique(np.linspace(0, len(frame) - 1, MORE_ROWS if long else ROWS).round().astype(int))
    return {name: (units[name], rounded(frame[name].to_numpy()[rows].tolist(), digits)) for name in frame}


def rounded(value: Any, digits: int = DIGITS) -> Any:
    """Return numbers, in any groups and lists, with fewer digits; None for what is not finite."""
    if isinstance(value, float):
        return float(f"{value:.{digits}g}") if np.isfinite(value) else None
    if isinstance(value, Mapping):
        return {name: rounded(own, digits) for name, own in value.items()}
    return [rounded(own, digits) for own in value] if isinstance(value, list | tuple) else value


def _main(studies: Iterable[str]) -> None:
    for study in studies:
        with tempfile.TemporaryDirectory() as folder:
            runs = make_runs(Path(folder), recorded_jobs(study), None, load_study(study).config_dirs)
            print(f"{study}: {len(runs)} runs, {record(study, runs):,} bytes")


if __name__ == "__main__":
    _main(sys.argv[1:] or RECORDED)
