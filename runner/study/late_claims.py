"""Claims changed after the result was known, with the previous values."""

from collections.abc import Mapping
from pathlib import Path

from runner.reporting.claims import CLAIMS, load_claims, simulated_by
from runner.statistics.spec.history import merge_histories, set_after, today
from runner.store import Run
from runner.store.atomic import write_atomically
from runner.store.seal import read_json, sealed_json
from runner.study.claims import run_name
from runner.study.work import Work

_JUDGED_BY = {"printed", "metric", "extents", "fails", "bound", "like"}


def late_claims(outputs: Path, work: Work, runs: Mapping[str, Run], date: str = "") -> list[str]:
    """Return for each claim that was changed since these runs were first judged when that was, and what stood before.

    What claims are judged by is kept in `claims/NAME.json` of the outputs folder, on this date, or where it is empty
    today; a claim whose run is missing is not judged.

    Raises:
        StoreError: if the file is damaged, or the disk does not take it.
    """
    path, late = outputs / "claims" / f"{work.name}.json", []
    known = read_json(path, "remove it to forget what claims were judged by").get("claims", {}) if path.exists() else {}
    for claim in load_claims(work.folder) if (work.folder / CLAIMS).is_file() else ():
        names = [run_name(simulated_by(claim)[0], preset) for preset in work.about.presets or ("",)]
        if all(name in runs for name in names):
            value = claim.model_dump(mode="json", include=_JUDGED_BY)
            key = " ".join([str(claim.number), *(runs[name].hash for name in names)])
            known = merge_histories(known, {key: [[date or today(), value]]})
            when, before = set_after(known[key], value)
            changed = {name: old for name, old in (before[-1] if before else {}).items() if old != value[name]}
            told = ", ".join(f"{name}: {old}" for name, old in changed.items())
            late += (
                [f"claim {claim.number} was set after the result was known ({when}; before: {told})"] if when else []
            )
    if known:
        write_atomically(path, sealed_json({"claims": known}))
    return late
