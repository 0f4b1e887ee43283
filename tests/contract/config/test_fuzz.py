"""Bad input from a grammar, a little of it on every run of the tests; `python -m tools.fuzz` tries and times more."""

import pytest

from tools import fuzz
from tools.fuzz import configs, lines

SEED, CASES = 12, 60


@pytest.mark.costs(5)
def test_every_config_is_taken_or_refused_in_words(tmp_path):
    faults, refused, kinds = {}, 0, set()
    for number in range(CASES):
        given = configs.case(SEED, number)
        ended = configs.attempt(given, tmp_path)
        kinds.add(given.kind)
        refused += ended.refused
        if ended.faults:
            faults[number] = ended.faults
    assert faults == {}
    assert kinds == {"resolved", "overrides", "file"}
    assert CASES // 20 < refused < CASES - CASES // 20


@pytest.mark.slow
@pytest.mark.parametrize("target", fuzz.TARGETS)
def test_a_thousand_cases(target):
    assert fuzz.main([target])


def test_a_case_follows_from_seed_and_number_alone():
    assert repr(configs.case(SEED, 7)) == repr(configs.case(SEED, 7))
    assert repr(configs.case(SEED, 7)) != repr(configs.case(SEED + 1, 7))


@pytest.mark.parametrize(
    ("text", "count"), [("runner: one line\nand another", 0), ("x" * 10_001, 1), ("\x1b[2J", 1), ("a\rb", 1)]
)
def test_what_is_wrong_with_a_message(text, count):
    assert len(configs.judge(text)) == count


def test_what_is_wrong_with_how_a_command_line_ended():
    usual = lines.Measured(0, "outputs/runs/x\n", 2.0, 200.0)
    assert lines.judge(usual, usual) == []
    assert lines.judge(lines.Measured(2, "runner: no\n", 6.9, 690.0), usual) == []
    for code, printed, seconds, megabytes in (
        (-11, "", 1.0, 100.0),
        (None, "", 1.0, 100.0),
        (1, "Traceback (most recent call last)\nValueError: x", 1.0, 100.0),
        (0, "", 7.1, 100.0),
        (0, "", 1.0, 701.0),
        (2, "\x1b[2J", 1.0, 100.0),
    ):
        assert len(lines.judge(lines.Measured(code, printed, seconds, megabytes), usual)) == 1
