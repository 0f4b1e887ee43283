"""Modules that make the numbers of a run use no function of arrays that has other digits on another processor.

NumPy chooses its code for these functions by the processor, so that AVX-512 and AVX2 give other last digits.
`runner.base.portable` has those with the same bits; powers are written as products.
"""

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[3] / "runner"
PACKAGES = ("trajectories", "symbolic", "plants", "sensing", "controllers", "robots", "environments")
OF_PROCESSORS = {
    *("exp", "exp2", "expm1", "log", "log1p", "log2", "log10", "power", "float_power", "cbrt"),
    *("arcsin", "arccos", "arctan", "arctan2", "arcsinh", "arccosh", "arctanh", "sinh", "cosh", "tan"),
    *("dot", "vdot", "inner"),
}
EXCEPTIONS = {
    ("controllers/stability.py", "log10"): "the middle of a search for a stability limit, for doctor and caveats",
    ("trajectories/geometry.py", "arccos"): "an angle in a message",
    ("trajectories/shaped.py", "exp"): "a residual vibration for reports, no number of a run",
}


def uses(tree: ast.AST) -> Iterator[str]:
    """Yield each such function of NumPy, and each power of a constant above 2, as "power"."""
    for node in ast.walk(tree):
        match node:
            case ast.Attribute(value=ast.Name(id="np"), attr=name) if name in OF_PROCESSORS:
                yield name
            case ast.BinOp(left=base, op=ast.Pow(), right=ast.Constant(value=int(degree))) if degree > 2:
                if not isinstance(base, ast.Constant):
                    yield "power"


@pytest.mark.parametrize("package", PACKAGES)
def test_no_function_of_arrays_has_other_digits_on_another_processor(package):
    found = {
        (path.relative_to(ROOT).as_posix(), name)
        for path in (ROOT / package).rglob("*.py")
        for name in uses(ast.parse(path.read_text(encoding="utf-8")))
    }
    assert found == {each for each in EXCEPTIONS if each[0].startswith(f"{package}/")}


def test_the_rule_finds_what_it_names():
    assert sorted(uses(ast.parse("y = np.exp(x) + u**3 + 2**32 + v**2"))) == ["exp", "power"]
