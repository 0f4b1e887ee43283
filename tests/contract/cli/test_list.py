"""`runner list`: every topic, own options, unknown names."""

from runner.cli.list import TOPICS
from runner.config.compose.files import group_options
from runner.plugins.metric_units import units


def test_an_overview_of_all_topics(cli):
    ending = cli("list")
    assert ending.code == 0
    heads = [line.split()[0] for line in ending.out.splitlines() if line and not line.startswith((" ", "`"))]
    assert heads == list(TOPICS)
    assert ", ".join(group_options("robot")) in " ".join(ending.out.split())


def test_every_topic_has_entries_with_descriptions(cli, tmp_path):
    wrong = []
    for topic in TOPICS:
        ending = cli("list", topic)
        lines = ending.out.splitlines()
        if (ending.code, ending.err) != (0, "") or not lines or any(len(line.split()) < 2 for line in lines):
            wrong.append((topic, ending))
    assert wrong == []
    assert list(tmp_path.iterdir()) == []


def test_metrics_carry_unit_and_meaning(cli):
    lines = {line.split()[0]: line for line in cli("list", "metrics").out.splitlines()}
    assert set(lines) == set(units())
    assert lines["settling_time"].split(maxsplit=1)[1] == (
        "[s] first tick after the last one with any axis error beyond the band"
    )
    assert lines["control_effort"].split(maxsplit=1)[1] == "[N^2 m^2 s] integral of sum tau^2"


def test_claims_carry_printed_value_and_place(cli):
    lines = cli("list", "claims").out.splitlines()
    assert "thesis 1   Macro, goal position, settles: 1.4 s (section 3.3.1, conclusion)" in lines
    thesis = [line for line in lines if line.startswith("thesis ")]
    assert thesis[-2].endswith("as the Mini stretches to its limit (section 5.3.4, conclusion)")  # a string, no number
    assert any(line.startswith("xarm7 1    Three joints, X stays constant: 0.643 m (section") for line in lines)


def test_studies_that_are_not_made_with_all_say_so(cli):
    lines = {line.split()[0]: line for line in cli("list", "studies").out.splitlines()}
    apart = [name for name, line in lines.items() if line.endswith("(not made by `runner reproduce all`)")]
    assert (apart, sorted(lines)) == (
        ["benchmark", "engines", "precision"],
        ["benchmark", "engines", "meca500", "precision", "thesis", "thesis_beyond", "xarm7"],
    )


def test_own_options_are_listed(cli, tmp_path):
    (tmp_path / "own" / "robot").mkdir(parents=True)
    (tmp_path / "own" / "robot" / "mine.yaml").write_text("# @package _global_\n# My arm\n")
    lines = cli("list", "robots", "--config-dir", tmp_path / "own").out.splitlines()
    assert ["mine", "My arm"] in [line.split(maxsplit=1) for line in lines]
    names = ", ".join(sorted({*group_options("robot"), "mine"}))
    assert names in " ".join(cli("list", f"--config-dir={tmp_path}/own").out.split())


def test_an_own_folder_that_does_not_exist_is_named(cli):
    ending = cli("list", "robots", "--config-dir", "nowhere")
    assert (ending.code, ending.err) == (2, "runner: --config-dir: no such folder ('nowhere').\n")


def test_an_unknown_topic_names_the_nearest(cli):
    ending = cli("list", "robot")
    assert ending.code == 2
    assert ending.err == f"runner: list: unknown topic 'robot'. Allowed: {', '.join(TOPICS)}. Did you mean 'robots'?\n"


def test_unknown_arguments_show_the_usage(cli):
    ending = cli("list", "robots", "--all")
    assert ending.code == 2
    assert ending.err.startswith("runner: unrecognized arguments: --all. Usage: runner list [--config-dir DIR]")
