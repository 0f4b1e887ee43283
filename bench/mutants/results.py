"""Results of mutants: a file of JSON lines, a table by package, and the mutants of a file found again in other code."""

import json
from collections import Counter, defaultdict
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from bench.mutants.mutant import Mutant

KILLED, TIMEOUT, SURVIVED, NOT_COVERED = "killed", "timeout", "survived", "not covered"
_COLUMNS = (KILLED, TIMEOUT, SURVIVED, NOT_COVERED)


def written(file: Path) -> dict[str, dict[str, Any]]:
    """Return the last result of each mutant in a file."""
    lines = file.read_text().splitlines() if file.is_file() else []
    return {result["mutant"]: result for result in map(json.loads, lines)}


def again(file: Path, places: list[Mutant], sources: dict[str, str]) -> list[Mutant]:
    """Return the mutants of a file of results.

    Where the function has changed since, it is the place whose lines are the same; what has none is printed.
    """
    by_name = {mutant.identity: mutant for mutant in places}
    by_path: defaultdict[str, list[Mutant]] = defaultdict(list)
    for mutant in places:
        by_path[mutant.path].append(mutant)
    found: dict[str, Mutant] = {}
    for name, result in written(file).items():
        mutant = by_name.get(name)
        if mutant is None:
            change = result["was"], result["now"]
            same = [each for each in by_path[result["path"]] if each.change(sources[each.path]) == change]
            mutant = same[0] if len(same) == 1 else None
        if mutant is None:
            print(f"  gone         {result['path']}:{result['line']}  {result['was'].strip()}")
        else:
            found[mutant.identity] = mutant
    return list(found.values())


def table(results: list[dict[str, Any]]) -> Iterator[str]:
    """Give the lines of a report: counts by package, then what no test found."""
    counts: defaultdict[str, Counter[str]] = defaultdict(Counter)
    for result in results:
        counts[_package(result["path"])][result["status"]] += 1
    yield f"{'package':24}" + "".join(f"{name:>13}" for name in _COLUMNS)
    for package, count in [*sorted(counts.items()), ("all", sum(counts.values(), Counter()))]:
        yield f"{package:24}" + "".join(f"{count[name]:13}" for name in _COLUMNS)
    for result in results:
        if result["status"] in (SURVIVED, NOT_COVERED):
            yield f"{result['status']}: {result['path']}:{result['line']} {result['owner']}"
            yield from (f"  - {line.strip()}" for line in result["was"].splitlines())
            yield from (f"  + {line.strip()}" for line in result["now"].splitlines())


def _package(path: str) -> str:
    parts = path.split("/")
    return "/".join(parts[: min(2, len(parts) - 1)])
