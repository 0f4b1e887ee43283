"""Former names of commands, options, topics and files: one sentence with the new name, which exists."""

import pytest

from runner.base.former_names import COMMANDS as FORMER_COMMANDS
from runner.base.former_names import FILES, OPTIONS
from runner.base.former_names import TOPICS as FORMER_TOPICS
from runner.cli.commands import OVERRIDES, names
from runner.cli.list import TOPICS
from runner.cli.parser import build_parser


@pytest.mark.parametrize(("former", "new"), FORMER_COMMANDS.items())
def test_a_former_command_is_rejected_with_the_new_name(cli, former, new):
    ending = cli(former, "a", "b")
    assert (ending.code, ending.out, ending.err) == (2, "", f"runner: {former} is now called {new}.\n")
    assert new in names()
    assert former not in names()


@pytest.mark.parametrize(("former", "new"), [(former, new) for former, names in OPTIONS.items() for new in names])
@pytest.mark.parametrize("value", [" x", "=x", ""])
def test_a_former_option_is_rejected_with_the_new_name(cli, former, new, value):
    parsers = build_parser(set(names()) - set(OVERRIDES)).commands
    options = {command: parser._option_string_actions for command, parser in parsers.items()}
    taking = [command for command, own in options.items() if new.split()[0] in own and former not in own]
    assert taking or former == "--html"
    for command in taking:
        first = next(name for name in OPTIONS[former] if name.split()[0] in options[command])
        if first != new:
            continue
        ending = cli(command, *f"{former}{value}".split())
        assert (ending.code, ending.out, ending.err) == (2, "", f"runner: {former} is now called {new}.\n")


def test_a_former_option_of_an_action_of_a_command(cli):
    assert cli("study", "check", "thesis", "--outputs", "x").err == "runner: --outputs is now called --output.\n"


def test_an_option_that_a_command_never_had_is_unknown(cli):
    assert "unrecognized arguments: --learn" in cli("verify", "--learn").err
    assert "unrecognized arguments: --check" in cli("verify", "--check").err


@pytest.mark.parametrize(("former", "new"), FORMER_TOPICS.items())
def test_a_former_topic_is_rejected_with_the_new_name(cli, former, new):
    ending = cli("list", former)
    assert (ending.code, ending.out, ending.err) == (2, "", f"runner: {former} is now called {new}.\n")
    assert new in TOPICS
    assert former not in TOPICS


@pytest.mark.parametrize(("former", "new"), FILES.items())
@pytest.mark.parametrize("command", ["reproduce", "study check"])
def test_a_folder_with_a_former_file_is_rejected_with_the_new_name(cli, tmp_path, command, former, new):
    (tmp_path / "paper").mkdir()
    (tmp_path / "paper" / former).touch()
    ending = cli(*command.split(), "paper")
    assert (ending.code, ending.out, ending.err) == (2, "", f"runner: {former} is now called {new}.\n")
    (tmp_path / "paper" / new).touch()
    assert former not in cli(*command.split(), "paper").err
