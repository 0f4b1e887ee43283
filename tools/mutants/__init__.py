"""Small errors put into the package one at a time: each has to be found by the tests.

`python -m tools.mutants` tries those written by hand, by the test file that each one names. `make mutants SAMPLE=200
SEED=1` draws them over the whole package, and runs the tests that the map of `make coverage-map` gives.
"""

import argparse
import json
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Any

from tools.mutants.choosing import Choice, CoverageMap, test_files
from tools.mutants.drawing import all_places, draw
from tools.mutants.engine import failing, try_all
from tools.mutants.listed import MUTANTS
from tools.mutants.mutant import Mutant
from tools.mutants.recording import PLACE, record
from tools.mutants.results import KILLED, NOT_COVERED, TIMEOUT, again, table, written
from tools.mutants.trees import modules

_ROOT = Path(__file__).resolve().parents[2]


def main(arguments: Sequence[str] = ()) -> bool:
    """Try mutants and print what became of each; return True if all handwritten ones were found."""
    chosen = _parser().parse_args(arguments)
    tree = chosen.tree.resolve()
    drawn = chosen.sample is not None or chosen.only is not None
    if chosen.record or (drawn and not (tree / PLACE).is_file()):
        record(tree, chosen.workers, chosen.tests)
    if chosen.record:
        return True
    if chosen.results is None:
        chosen.results = tree / ".cache" / "mutants.jsonl"
        chosen.results.parent.mkdir(exist_ok=True)
        chosen.results.unlink(missing_ok=True)
    sources = {path: (tree / path).read_text() for path in modules(tree)}
    if not drawn:
        results = _tried(
            tree, [mutant.at(sources[mutant.module]) for mutant in MUTANTS], sources, CoverageMap(), chosen
        )
    else:
        places = all_places(tree)
        print(f"{len(places)} places in {len(sources)} modules")
        only = chosen.only
        mutants = again(only, places, sources) if only else draw(places, sources, chosen.sample, chosen.seed)
        results = _tried(tree, mutants, sources, CoverageMap.load(tree).of_passed(), chosen)
    print("\n".join(table(results)))
    return drawn or all(result["status"] in (KILLED, TIMEOUT) for result in results)


def _tried(
    tree: Path, mutants: list[Mutant], sources: dict[str, str], coverage: CoverageMap, chosen: argparse.Namespace
) -> list[dict[str, Any]]:
    """Try the mutants that have no result yet, and again those that were only found by a test that always fails."""
    files = test_files(tree)
    fit: set[str] = set()
    unfit: set[str] = set()
    while True:
        known = written(chosen.results)
        work: list[tuple[Mutant, Choice]] = []
        for mutant in mutants:
            if mutant.identity not in known or known[mutant.identity]["by"] in unfit:
                choice = coverage.choose(mutant, tree, chosen.limit, unfit)
                if choice is None:
                    _tell(chosen.results, sources, mutant, {"status": NOT_COVERED, "by": "", "ran": 0, "cpu": 0.0})
                else:
                    work.append((mutant, choice))
        if work:
            tell = partial(_tell, chosen.results, sources)
            try_all(tree, work, chosen.workers, chosen.limit, [*coverage.tests, *unfit], tell)
        known = written(chosen.results)
        results = [known[mutant.identity] for mutant in mutants]
        finders = {result["by"] for result in results if result["by"].partition("::")[0] in files} - fit - unfit
        wrong = (
            failing(tree, {test: files[test.partition("::")[0]] for test in finders}, chosen.limit)
            if finders
            else set()
        )
        for test in sorted(wrong):
            print(f"  {test} fails without a mutant")
        fit, unfit = fit | finders - wrong, unfit | wrong
        if not wrong:
            return results


def _tell(results: Path, sources: dict[str, str], mutant: Mutant, result: dict[str, Any]) -> None:
    """Print what became of a mutant, and add it to the file of results."""
    source = sources[mutant.path]
    was, now = mutant.change(source)
    line = {
        "mutant": mutant.identity,
        "path": mutant.path,
        "line": mutant.line(source),
        "owner": mutant.owner,
        "was": was,
        "now": now,
        **result,
    }
    with results.open("a") as file:
        file.write(json.dumps(line) + "\n")
    about = mutant.why or now.strip().partition("\n")[0]
    print(f"  {result['status']:11} {result['cpu']:6.1f} s  {mutant.path}:{line['line']}  {about}", flush=True)


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m tools.mutants", description="Try mutants of the package.")
    parser.add_argument("--sample", type=int, help="number of mutants to draw; without it those written by hand")
    parser.add_argument("--seed", type=int, default=0, help="of the draws; the same one draws the same mutants")
    parser.add_argument("--only", type=Path, help="file of results: try its mutants again")
    parser.add_argument("--record", action="store_true", help="record the coverage map, and nothing else")
    parser.add_argument("--tree", type=Path, default=_ROOT, help="checkout with its own .venv")
    parser.add_argument("--results", type=Path, help="file of JSON lines, which a later call continues")
    parser.add_argument("--workers", type=int, default=2, help="processes that run tests")
    parser.add_argument("--limit", type=float, default=60.0, help="CPU time of tests for a mutant [s]")
    parser.add_argument("tests", nargs="*", help="with --record: arguments of pytest behind --; without them all tests")
    return parser
