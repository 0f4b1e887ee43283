"""The errors that `python -m bench mutants` puts into the physics are of lines that stand there."""

import ast
from pathlib import Path

import pytest

from bench.mutants_list import MUTANTS

ROOT = Path(__file__).resolve().parents[1]


@pytest.mark.parametrize("mutant", MUTANTS, ids=lambda mutant: f"{mutant.module}: {mutant.why}")
def test_it_makes_another_module_of_its_own(mutant):
    source = (ROOT / mutant.module).read_text()
    assert ast.dump(ast.parse(mutant.apply(source))) != ast.dump(ast.parse(source))
    assert (ROOT / mutant.test).is_file()


def test_what_stands_nowhere_is_said():
    with pytest.raises(ValueError, match=r"stands there 0 times, not once"):
        MUTANTS[0].apply("")
