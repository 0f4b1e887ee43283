"""`runner check DIR [--reference FILE]`: does every metric of a run or sweep lie in its reference band?"""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from runner.commands.arguments import Parser
from runner.commands.table import aligned, number
from runner.config.compose import quiet_environment

if TYPE_CHECKING:
    from runner.references import Band, Finding, Reference
    from runner.store import Run


def main(arguments: Sequence[str]) -> int:
    """Check the medians of all runs; print one line if all hold, else a table of those that do not."""
    parser = Parser("check", __doc__)
    parser.add_argument("folder", type=Path, metavar="DIR", help="folder of a run or a sweep")
    parser.add_argument(
        "--reference", type=Path, metavar="FILE", help="reference file; default: the one for the run's experiment"
    )
    options = parser.parse_args(arguments)
    quiet_environment()
    from runner import store
    from runner.references import check_run, find_shipped, load_reference

    runs = store.open_runs(options.folder)
    given = load_reference(options.reference) if options.reference else None
    pairs = [(run, given or find_shipped(run)) for run in runs]
    results = [(run, reference, check_run(run, reference)) for run, reference in pairs]
    short = [result for result in results if not all(finding.good for finding in result[2])]
    if short:
        print("\n\n".join(_report(*result) for result in short))
        return 1
    names = ", ".join(dict.fromkeys(reference.name for _, reference in pairs))
    count = sum(len(findings) for _, _, findings in results)
    print(f"good: {count} metrics of {len(runs)} {'run' if len(runs) == 1 else 'runs'} lie in the bands of {names}")
    return 0


def _report(run: "Run", reference: "Reference", findings: "Sequence[Finding]") -> str:
    wrong = [finding for finding in findings if not finding.good]
    head = f"{run.folder}: {len(wrong)} of {len(findings)} metrics fall short of {reference.name}"
    rows = [[f.metric, number(f.value), _range(f.band), f.band.reason] for f in wrong]
    failure = [f"  {run.failure_text}"] if run.failure else []
    return "\n".join([head, *failure, aligned([["metric", "found", "band", "reason"], *rows])])


def _range(band: "Band") -> str:
    if band.min is None or band.max is None:
        return f"up to {number(band.max)}" if band.min is None else f"{number(band.min)} or more"
    return f"{number(band.min)} to {number(band.max)}"
