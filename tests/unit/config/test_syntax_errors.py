"""Overrides that Hydra cannot parse: messages without any string of the parser."""

import pytest
from hydra.core.override_parser.overrides_parser import OverridesParser

from runner.config.compose.overrides import explain_parser, find_syntax_error

GOOD = (
    "robot=macro", "robot=macro,mini", "robot.home=[0,1,2]", "robot.name='a, b]'", 'robot.name="it\'s"', "robot.name=",
    "a={b:1,c:{d:[1,2]}}", "seed=range(0,10)", "a=tag(log,interval(1,2))", "a=[]", "a={}", r"a=x\,y", r"a=x\]",
    "a=${b.c}", "a=${oc.env:HOME,x}", "a=1e-3", "~robot", "+a=1", "++a.b=null", "a=x y", "a='='", "robot=glob(m*)",
    "a=10N m", "a=[[1,2],[3,4]]", "a=['x,',\"y\"]",
)  # fmt: skip
BAD = {
    "robot=macro,": "a value after the last comma is missing; remove the comma, or give one more value",
    "robot=,macro": "a value before a comma is missing; remove the comma, or give the value",
    "seed=0,1,,2": "a value before a comma is missing; remove the comma, or give the value",
    "a=[1,,2]": "a value before a comma is missing; remove the comma, or give the value",
    "a=[1,2,]": "a value between a comma and ']' is missing; remove the comma, or give one more value",
    "a=[0,1": "the bracket '[' is not closed by a ']'",
    "a={b:[1}": "the bracket '}' closes none that is open",
    "a=}": "the bracket '}' closes none that is open",
    "a={b": "the bracket '{' is not closed by a '}'",
    "seed=range(0,3": "the bracket '(' is not closed by a ')'",
    "robot.name='a": "the quote ' is not closed",
    'a=["x]': 'the quote " is not closed',
    "robot = macro": "remove the spaces around the '=', as in 'robot=macro'",
    "robot= macro": "remove the spaces around the '=', as in 'robot=macro'",
    "robot ": None,
    "=3": "the key before the '=' is missing",
    "robot==macro": "there are two '=' in a row; remove one",
}


@pytest.mark.parametrize("override", GOOD)
def test_what_hydra_takes_has_no_fault(override):
    OverridesParser.create().parse_override(override)
    assert find_syntax_error(override) is None


@pytest.mark.parametrize(("override", "fault"), BAD.items())
def test_a_fault_is_told_in_words(override, fault):
    assert find_syntax_error(override) == fault


@pytest.mark.parametrize("override", [*BAD, "robot", "a=b^c", "a=#", "a=x;y", "a=1&2", "a=(1)", "a=x:[1", "a b=1"])
@pytest.mark.parametrize("mode", [(), ("-m",)])
def test_no_text_of_the_parser_is_left(cli, tmp_path, mode, override):
    ending = cli(*mode, "robot=macro", override)
    assert (ending.code, ending.out) == (2, "")
    assert "is not a valid override: " in ending.err
    for word in ("EOF", "expecting", "viable", "ANTLR", "Lexer", "token", "mismatched", "extraneous", "parsing"):
        assert word not in ending.err
    assert list(tmp_path.iterdir()) == []


def test_what_hydra_says_of_values_stays():
    assert explain_parser("ValueError while evaluating 'range(1)'") == "ValueError while evaluating 'range(1)'"


def test_several_values_of_a_single_run(cli):
    ending = cli("robot=macro,mini")
    assert ending.code == 2
    assert "'robot=macro,mini' gives several values; `runner -m` sweeps over them" in ending.err
