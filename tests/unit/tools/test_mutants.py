"""Mutants written by hand: each has a line that is in its module, and a test file that exists."""

from pathlib import Path

import pytest

from tools.mutants.listed import MUTANTS

ROOT = Path(__file__).resolve().parents[3]


@pytest.mark.parametrize("listed", MUTANTS, ids=lambda listed: f"{listed.module}: {listed.why}")
def test_it_makes_another_module_of_its_own(listed):
    source = (ROOT / listed.module).read_text()
    assert listed.at(source).changes(source)
    assert len(list((ROOT / "tests").rglob(Path(listed.test).name))) == 1


def test_what_stands_nowhere_is_said():
    with pytest.raises(ValueError, match=r"occurs 0 times, not once"):
        MUTANTS[0].at("")
