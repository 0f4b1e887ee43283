"""Places of mutants in small modules: which operators are replaced by what, and what is left out."""

from textwrap import dedent

import pytest

from tools.mutants.places import places

BARE = "def f(a, b, c):\n    "


def changed(source):
    """Return the lines that mutants put instead of a module's own, those left out that change nothing."""
    return [mutant.change(source)[1].strip() for mutant in places("runner/m.py", source) if mutant.changes(source)]


def of(statement):
    return changed(f"{BARE}{statement}\n")


@pytest.mark.parametrize(
    ("statement", "wrong"),
    [
        ("return a < b", ["return a <= b"]),
        ("return a <= b", ["return a < b"]),
        ("return a > b", ["return a >= b"]),
        ("return a >= b", ["return a > b"]),
        ("return a == b", ["return a != b"]),
        ("return a != b", ["return a == b"]),
        ("return a is b", ["return a is not b"]),
        ("return a is not b", ["return a is b"]),
        ("return a in b", ["return a not in b"]),
        ("return a not in b", ["return a in b"]),
        ("return a < b < c", ["return a <= b < c", "return a < b <= c"]),
        ("return a + b", ["return a - b"]),
        ("return a - b", ["return a + b"]),
        ("return a * b", ["return a / b"]),
        ("return a / b", ["return a * b"]),
        ("return a**b", ["return a*b"]),
        ("return a // b", ["return a / b"]),
        ("return (a) * (b)", ["return (a) / (b)"]),
        ("return a @ b", []),
        ("return -a", ["return a"]),
        ("return not a", ["return  a"]),
        ("return a and b", ["return a or b"]),
        ("return a or b or c", ["return a and b or c", "return a or b and c"]),
        ("return True", ["return False"]),
        ("return None", []),
        ("return min(a)", ["return max(a)"]),
        ("return max(a)", ["return min(a)"]),
        ("return sum(a)", ["return max(a)"]),
        ("return any(a)", ["return all(a)"]),
        ("return a.min()", ["return a.max()"]),
        ("return a[b:]", ["return a[(b) + 1:]"]),
        ("return a[:b]", ["return a[:(b) - 1]"]),
        ("a.append(b)", ["pass"]),
        ("a.b = c", ["pass"]),
        ("a = b", ["pass"]),
        ("a += b", ["a -= b", "pass"]),
        ("new = b", []),
    ],
    ids=str,
)
def test_what_is_replaced(statement, wrong):
    assert of(statement) == wrong


def test_a_number_becomes_another_one():
    source = BARE + "return [" + ", ".join(str(number) for number in range(40)) + "]\n"
    found = [line.removeprefix("return [")[:-1].split(", ") for line in changed(source)]
    moves = [(place, int(numbers[place])) for place, numbers in enumerate(found)]
    assert len(moves) == 40
    assert all(new in (old + 1, 2 * old, 0) and new != old for old, new in moves)
    for kind in (lambda old: old + 1, lambda old: 2 * old, lambda _: 0):
        assert any(new == kind(old) for old, new in moves[2:])


@pytest.mark.parametrize(
    "source",
    [
        '"""a < 1."""\n',
        "import numpy as np\nfrom a import b\n",
        '__all__ = ["f", "g"][:2]\n',
        "from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    X = 1\n",
        "if __name__ == '__main__':\n    main()\n",
        BARE + "raise ValueError(f'{a + 1} is below {b * 2}')\n",
        BARE + "assert a < 1\n",
        BARE + "return f'{a + 1}'\n",
        BARE + "print(a + 1)\n",
        "def f(a: Literal[1, 2] = None) -> Array[3]:\n    return a\n",
        "class A:\n    x: Annotated[int, 3]\n",
        "@lru_cache(maxsize=3)\ndef f():\n    return None\n",
        BARE + "return 'a' + b\n",
    ],
    ids=str,
)
def test_what_is_left_out(source):
    assert changed(source) == []


def test_names_at_import_and_blocks_of_functions_are_told():
    source = dedent("""\
        LIMIT = 3

        class A:
            most: int = 4

            def f(self, a, b=5):
                if a:
                    return a + b
                return a - b
    """)
    found = [(mutant.owner, mutant.block, mutant.name) for mutant in places("runner/m.py", source)]
    assert found == [("", None, "LIMIT"), ("", None, "most"), ("", None, "f"), ("A.f", 1, None), ("A.f", 2, None)]


def test_positions_are_those_of_characters_of_any_width():
    source = f"{BARE}α = 'é'\n    return a < b\n"
    assert changed(source)[-1] == "return a <= b"


def test_what_does_not_parse_or_changes_nothing_is_told():
    (mutant,) = places("runner/m.py", f"{BARE}return a < b\n")
    source = f"{BARE}return a < b\n"
    assert mutant.changes(source)
    for text in ("< <", "<  "):
        assert not type(mutant)(**{**vars(mutant), "new": text}).changes(source)
