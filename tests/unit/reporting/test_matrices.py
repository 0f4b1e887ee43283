"""Elements of equations gathered into matrices."""

import pytest

from runner.papers.expressions.parser import parse
from runner.papers.expressions.tree import Call, Name, parts
from runner.papers.reporting.audit_forms import gather_elements


def elements(*names):
    return {name: parse(str(place)).root for place, name in enumerate(names)}


def shapes(*names):
    return [
        (left.name, (len(right.arguments), len(parts(right.arguments[0]))) if isinstance(right, Call) else None)
        for left, right in gather_elements(elements(*names))
    ]


def grid(name, rows, columns, first=1):
    return [f"{name}_{i}{j}" for i in range(first, first + rows) for j in range(first, first + columns)]


@pytest.mark.parametrize(
    ("names", "expected"),
    [
        (grid("T", 4, 4), [("T", (4, 4))]),
        (grid("T", 3, 4, first=0), [("T", (3, 4))]),
        (grid("J_we", 3, 3), [("J_we", (3, 3))]),
        (["P_x", "P_y", "P_z"], [("P", (3, 1))]),
        ([*grid("M", 2, 2), "G_1", "G_2"], [("M", (2, 2)), ("G_1", None), ("G_2", None)]),
        (grid("T", 3, 3)[:-1], [(name, None) for name in grid("T", 3, 3)[:-1]]),
        (["J_12"], [("J_12", None)]),
        (["M_gx"], [("M_gx", None)]),
    ],
)
def test_elements_that_fill_rows_and_columns_are_a_matrix(names, expected):
    assert shapes(*names) == expected


def test_elements_stand_in_their_rows_whatever_their_order():
    ((_, matrix),) = gather_elements(
        {"T_21": Name("c", 0), "T_12": Name("b", 0), "T_22": Name("d", 0), "T_11": Name("a", 0)}
    )
    assert [[node.name for node in parts(row)] for row in parts(matrix)] == [["a", "b"], ["c", "d"]]
