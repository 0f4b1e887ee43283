"""Results of mutants: a file of JSON lines, a table by package, and the mutants of a file found again in other code."""

import json
from collections import Counter, defaultdict
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

from tools.mutants.mutant import Mutant

KILLED, TIMEOUT, SURVIVED, NOT_COVERED = "killed", "timeout", "survived", "not covered"
_COLUMNS = (KILLED, TIMEOUT, SURVIVED, NOT_COVERED)


def written(file: Path) -> dict[str, dict[str, Any]]:
    """Return the last result of each mutant in a file."""
    lines = file.read_text().splitlines() if file.is_file() else []
    return {result["mutant"]: result for result in map(json.loads, lines)}


def again(file: Path, places: list[Mutant], sources: dict[str, str]) -> list[Mutant]:
    """Return the mutants of a file of results; those whose lines do not occur exactly once any more are printed.

    If the function has changed since, the lines decide.
    """
    by_name = {mutant.identity: mutant for mutant in places}
    by_path: defaultdict[str, list[Mutant]] = defaultdict(list)
    for mutant in places:
        by_path[mutant.path].append(mutant)
    found: list[Mutant] = []
    for name, result in written(file).items():
        path = result["path"]
        mutant = by_name.get(name) or _by_lines(result["was"], result["now"], by_path[path], sources.get(path, ""))
        if mutant is None:
            print(f"  gone         {path}:{result['line']}  {result['was'].strip()}")
        else:
            found.append(mutant)
    return found


def _by_lines(was: str, now: str, places: list[Mutant], source: str) -> Mutant | None:
    """Return the mutant that replaces lines which are in a module once."""
    text, lines = f"\n{source}".encode(), f"\n{was}\n".encode()
    if text.count(lines) != 1:
        return None
    start = text.index(lines)
    end = start + len(was.encode())
    beside = next((place for place in places if start <= place.start < end), None)
    return None if beside is None else replace(beside, start=start, end=end, new=now)


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
