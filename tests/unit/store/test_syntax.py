"""The content of source text: changes that leave it unchanged, others, and one digest for all versions of Python."""

import ast
import hashlib
import sys

import pytest

from runner.store.syntax import _FIELDS, content

NEWER = {"TypeAlias", "TypeVar", "ParamSpec", "TypeVarTuple"}  # than the oldest Python that reads the sample
SAMPLE = r'''
"""Text."""
from __future__ import annotations
import os, sys as system
from numpy import *
from runner.laws import gain as k, law
async def f(a, /, b: int = 1, *c: "Q", d=2, e, **g) -> None:
    """Text."""
    global G, H
    async with k as q, law: await q
    async for i in b: yield i
    return [j async for j in b]
@law.made
class C(law.B, metaclass=M):
    x: float = -1.5e300
    __all__: list
def g(n):
    def h():
        nonlocal n
        n += 0x10
    del n[0], n.a[1:2:3, ...]
    for a, *b in n: break
    else:
        while not a and b or (c := 1_000): continue
    with n: pass
    if n: h()
    try: raise ValueError("x" f"{a!r:>{b}}") from e
    except (A, B) as e: raise
    else: assert a, "text"
    finally: z = yield from a
    try: n()
    except* OSError: pass
    match a:
        case {"a": 1, **rest} | [1, *_, 2] | C(1, k=None) | "s": return 1
        case (1 | -2 | 3+4j) as q if q > 1: return 2
        case _: return lambda *p, q=1: (p if q else {1, 2}, {**p, 'a': b"c\xff"}, {i: j for i, j in p}, {*p})
    f"{a}" "b" f"c{d=}{{}}{e!s:{f}.{g}}{'x' 'y'}" f""
    f"""{
       a = } \N{BULLET} é {a:%H:%M}"""
    return {i for i in p}, (i for i in p), [~a ** -b // c % d @ e << f >> g & h ^ i | j < k <= l > m >= n == o != p,
        p in q not in r is s is not t + u - v * w / x, 1e-3, 1e999, 1j, True, None, u'a', "é\U0001F600\ud800", +x]
'''
DIGEST = "f216fab1861f3934a7a5e628"
SEEN = ((3, 11), (3, 12), (3, 13), (3, 14))  # versions of Python that gave this digest
BEFORE = """
import numpy as np
from runner.plants import Plant, step


def force(x, k=2.0):
    return np.exp(-k * x) + step(x)
"""


def found(text):
    return content(ast.parse(text), lambda module, name: name or module)


def test_the_sample_has_all_syntax():
    own = {"Name", "Constant", "JoinedStr", "Raise"}
    kinds = {type(node).__name__ for node in ast.walk(ast.parse(SAMPLE))}
    assert kinds >= (set(_FIELDS) | own) - NEWER


def test_each_version_of_python_gives_one_digest():
    assert hashlib.sha256(found(SAMPLE).encode()).hexdigest()[:24] == DIGEST
    assert sys.version_info[:2] in SEEN


@pytest.mark.parametrize(
    "text",
    [
        '"""Text."""' + BEFORE,
        BEFORE.replace("return", '"""Return a force.\n\n    Args:\n        x: Depth, in m.\n    """\n    return'),
        BEFORE.replace("k=2.0):", "k=2.0):  # k in 1/m"),
        BEFORE.replace("np.exp(-k * x)", "(\n        np.exp((-k)*x,)\n    )"),
        BEFORE.replace("2.0", "2e0"),
        BEFORE.replace("runner.plants", "runner.arms.plants"),
        BEFORE.replace("Plant, step", "step"),
        BEFORE.replace("from runner.plants import Plant, step", "from runner.plants import step as advance").replace(
            "step(x)", "advance(x)"
        ),
        BEFORE.replace("import Plant, step", "import Plant").replace(
            "    return", "    from runner.plants import step\n\n    return"
        ),
        BEFORE.replace("import numpy as np\n", "").replace("step\n", "step\nimport numpy\n").replace("np.", "numpy."),
        BEFORE + '__all__ = ["force"]\n',
        "from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    from runner.simulation import Loop\n" + BEFORE,
    ],
)
def test_what_is_prose_or_place_leaves_no_trace(text):
    assert found(text) == found(BEFORE)


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("2.0", "2.1"),
        ("2.0", "2"),
        ("2.0", "-2.0"),
        ("2.0", '"2.0"'),
        ("-k", "+k"),
        ("k * x", "k / x"),
        ("k * x", "x * k"),
        (" + step", " - step"),
        ("x, k=2.0", "x, k"),
        ("x, k=2.0", "x, *, k=2.0"),
        ("x, k=2.0", "y, k=2.0"),
        ("force", "torque"),
        ("np.exp", "np.exp2"),
        ("import numpy as np", "import scipy as np"),
        ("Plant, step", "Plant, leap as step"),
        ("(x)", "(x, x)"),
        ("    return", "    x = 1\n    return"),
        ("    return", "    'text'.upper()\n    return"),
        ("return ", "yield "),
    ],
)
def test_what_computes_counts(old, new):
    assert old in BEFORE
    assert found(BEFORE.replace(old, new)) != found(BEFORE)


@pytest.mark.parametrize(
    ("before", "after", "same"),
    [
        ('raise Error("a")', 'raise Error(f"b {x}", x=1)', True),
        ('raise Error("a")', 'raise Error("a") from None', False),
        ('raise Error("a")', 'raise Other("a")', False),
        ("raise error", "raise other", False),
        ('assert x, "a"', 'assert x, "b"', True),
        ('assert x, "a"', 'assert y, "a"', False),
        ('yield "a"', 'yield "b"', False),
        ('f"{x}" "a"', 'f"{x}a"', True),
        ('f"{x}"', 'f"{x!r}"', False),
        ('f"{x}"', 'f"{x:.2f}"', False),
        ('f"{x}a"', 'f"{x}b"', False),
        ('"16"', "16", False),
        ("16", "0x10", True),
        ("16", "'0x10'", False),
        ("1", "True", False),
        ("1", "1.0", False),
        ('"a"', 'b"a"', False),
        ("{**a}", "{a}", False),
        ("x: int", "x: float", False),
        ("if a:\n    b\nc", "if a:\n    b\n    c", False),
        ("from a import *", "from b import *", False),
    ],
)
def test_pairs(before, after, same):
    assert (found(before) == found(after)) == same


def test_deep_source_is_read():
    assert found(" + ".join(["x"] * 2000)).count("Add") == 1999
