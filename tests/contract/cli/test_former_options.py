"""Former names of commands and options: one sentence with the new name, which exists."""

import pytest

from runner.base.former_names import COMMANDS as FORMER_COMMANDS
from runner.base.former_names import OPTIONS
from runner.cli.completion.arguments import parser_of
from runner.cli.main import COMMANDS


@pytest.mark.parametrize(("former", "new"), FORMER_COMMANDS.items())
def test_a_former_command_is_rejected_with_the_new_name(cli, former, new):
    ending = cli(former, "a", "b")
    assert (ending.code, ending.out, ending.err) == (2, "", f"runner: {former} is now called {new}.\n")
    assert new in COMMANDS
    assert former not in COMMANDS


@pytest.mark.parametrize(("former", "new"), OPTIONS.items())
@pytest.mark.parametrize("value", [" x", "=x", ""])
def test_a_former_option_is_rejected_with_the_new_name(cli, former, new, value):
    options = {command: parser_of(command)._option_string_actions for command in COMMANDS}
    taking = [command for command, own in options.items() if new in own and former not in own]
    assert taking
    for command in taking:
        ending = cli(command, *f"{former}{value}".split())
        assert (ending.code, ending.out, ending.err) == (2, "", f"runner: {former} is now called {new}.\n")


def test_a_former_option_of_an_action_of_a_command(cli):
    assert cli("work", "check", "thesis", "--outputs", "x").err == "runner: --outputs is now called --output.\n"


def test_an_option_that_a_command_never_had_is_unknown(cli):
    assert "unrecognized arguments: --learn" in cli("verify", "--learn").err
    assert "unrecognized arguments: --check" in cli("verify", "--check").err
