"""Machine of a result: its parts, records of earlier versions, and what is equal up to rounding."""

import json
import os
import subprocess
import sys
from collections import Counter

import pytest

from runner.base.machine import (
    _LEVELS,
    Machine,
    _level,
    describe_mixture,
    equal_up_to_rounding,
    parts_apart,
    read_machine,
    this_machine,
)

ALPHA = Machine("Alpha CPU", "Linux x86_64", "x86-64-v4", "2.36", "X86_V3 X86_V4", "SkylakeX")
BETA = Machine("Alpha CPU", "Linux x86_64", "x86-64-v4", "2.36", "X86_V3", "Haswell")
FORMER = "Alpha CPU, Linux x86_64"  # as an earlier version stored it


def test_a_machine_is_one_line_without_unknown_parts():
    assert ALPHA.text == ("Alpha CPU (x86-64-v4, glibc 2.36, NumPy X86_V3 X86_V4, OpenBLAS SkylakeX), Linux x86_64")
    assert read_machine(FORMER).text == FORMER


def test_records_are_read_again_whatever_they_hold():
    assert read_machine(json.loads(json.dumps(ALPHA.record()))) == ALPHA
    assert read_machine(FORMER) == Machine("Alpha CPU", "Linux x86_64")
    assert read_machine("Alpha") == Machine("Alpha")
    assert read_machine({"processor": 3, "glibc": "2.36", "other": "x"}) == Machine(glibc="2.36")
    assert read_machine(None) == read_machine([]) == Machine()


def test_levels_are_those_whose_flags_and_the_lower_ones_are_there():
    flags: set[str] = set()
    assert _level(flags) == ""
    for level, added in _LEVELS.items():
        assert _level(flags | added) == level
        assert all(_level((flags | added) - {flag}) < level for flag in added)
        flags |= added
    assert _level(_LEVELS["x86-64-v4"]) == ""


def test_parts_apart_are_known_on_both_sides():
    assert parts_apart([ALPHA, BETA]) == ["numpy", "openblas"]
    assert parts_apart([ALPHA, read_machine(FORMER)]) == []
    assert parts_apart([ALPHA, read_machine("Beta CPU, Linux x86_64")]) == ["processor"]


def test_a_mixture_is_described_by_the_parts_that_differ():
    assert describe_mixture(Counter({ALPHA: 3})) == describe_mixture({}) == ""
    assert describe_mixture(Counter({ALPHA: 3, Machine(): 1, read_machine(FORMER): 1})) == ""
    assert describe_mixture(Counter({ALPHA: 3, BETA: 1})) == (
        "made on 2 machines, which may round differently: 3 runs on NumPy X86_V3 X86_V4, OpenBLAS SkylakeX; "
        "1 run on NumPy X86_V3, OpenBLAS Haswell"
    )
    assert "1 run on an unknown machine" in describe_mixture(Counter({ALPHA: 3, BETA: 1, Machine(): 1}))


@pytest.mark.parametrize(
    ("a", "b", "equal"),
    [
        (1.0, 1.0 + 0.9e-6, True),
        (1.0, 1.0 + 1.1e-6, False),
        (0.0, 1e-12, True),
        (0.0, 1.1e-12, False),
        (None, None, True),
        (None, 0.0, False),
        (0.0, None, False),
    ],
)
def test_two_values_are_equal_up_to_rounding(a, b, equal):
    assert equal_up_to_rounding(a, b) is equal


MASKED = {
    "OPENBLAS_CORETYPE": "Nehalem",
    "GLIBC_TUNABLES": "glibc.malloc.check=1:glibc.cpu.hwcaps=-AVX2",
}


@pytest.mark.skipif(not this_machine().level, reason="no x86-64")
def test_what_masks_the_processor_is_part_of_the_machine():
    script = "import json; from runner.base.machine import this_machine; print(json.dumps(this_machine().record()))"
    ran = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, check=True, env=os.environ | MASKED
    )
    found, here = read_machine(json.loads(ran.stdout)), this_machine()
    assert (found.processor, found.level, found.numpy) == (here.processor, here.level, here.numpy)
    assert found.glibc == f"{here.glibc} glibc.cpu.hwcaps=-AVX2"
    assert found.openblas == "Nehalem"
