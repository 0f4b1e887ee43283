"""Matrices and vectors from elements such as T_11 to T_44."""

import re
from collections.abc import Mapping

from runner.base.expressions.tree import Name, Node
from runner.reporting.equation import Matrix

_ELEMENT = re.compile(r"(?P<name>\w+?)_(?P<place>\d\d|[xyz])")
_VECTOR = ("x", "y", "z")


def gather_elements(elements: Mapping[str, Node]) -> list[tuple[Node, Node | Matrix]]:
    """Return elements such as T_11 to T_44, or P_x, P_y and P_z, as one matrix, and the others as they are.

    A matrix is whole: it has an element in each row and column, from 0 or 1 on.
    """
    families: dict[str, dict[str, Node]] = {}
    for name, node in elements.items():
        match = _ELEMENT.fullmatch(name)
        family, place = (match["name"], match["place"]) if match else (name, "")
        families.setdefault(family, {})[place] = node
    found: list[tuple[Node, Node | Matrix]] = []
    for family, members in families.items():
        matrix = _matrix(members)
        if matrix is not None:
            found.append((Name(family, 0), matrix))
            continue
        found += [(Name(f"{family}_{place}" if place else family, 0), node) for place, node in members.items()]
    return found


def _matrix(members: Mapping[str, Node]) -> Matrix | None:
    if tuple(members) == _VECTOR:
        return Matrix([[node] for node in members.values()])
    if len(members) < 4 or not all(len(place) == 2 for place in members):
        return None
    rows, columns = (sorted({place[axis] for place in members}) for axis in (0, 1))
    whole = [f"{row}{column}" for row in rows for column in columns] == sorted(members)
    if not (whole and rows[0] == columns[0] and rows[0] in "01" and len(rows) > 1):
        return None
    return Matrix([[members[f"{row}{column}"] for column in columns] for row in rows])
