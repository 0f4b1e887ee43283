"""Mutants drawn over the whole package: the same ones at another commit, where the code is the same."""

import hashlib
from pathlib import Path

from tools.mutants.mutant import Mutant
from tools.mutants.places import places
from tools.mutants.trees import modules


def all_places(tree: Path) -> list[Mutant]:
    """Return every place of the packages of a checkout."""
    return [mutant for path in modules(tree) for mutant in places(path, (tree / path).read_text())]


def draw(mutants: list[Mutant], sources: dict[str, str], sample: int, seed: int) -> list[Mutant]:
    """Return the first mutants in an order that only the seed and each one's own function decide."""
    drawn: list[Mutant] = []
    for mutant in sorted(mutants, key=lambda mutant: _rank(seed, mutant)):
        if len(drawn) == sample:
            break
        if mutant.changes(sources[mutant.path]):
            drawn.append(mutant)
    return drawn


def _rank(seed: int, mutant: Mutant) -> str:
    return hashlib.sha256(f"{seed} {mutant.identity}".encode()).hexdigest()
