"""The user's settings of how and where runs are simulated: what they hold, what wins over them, and what is refused."""

import pytest
from support.pages import ROOT

from runner.config.compose.files import KEYS

LINE = ("robot=macro", "plant=rk4", "duration=0.05")


@pytest.fixture
def settings(tmp_path, monkeypatch):
    """Write the user's settings."""
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "settings"))

    def write(text):
        path = tmp_path / "settings/arm-control-runner/config.yaml"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
        return path

    return write


def test_runs_go_to_the_folder_of_the_settings_and_are_found_there(cli, settings, tmp_path):
    settings(f"outputs: {tmp_path}/kept\n")
    made = cli(*LINE)
    assert made.folder.parent == tmp_path / "kept/runs"
    assert cli(*LINE).folder == made.folder
    assert cli("verify").code == 0
    assert "kept" in cli("figures", "thesis").err
    assert not (tmp_path / "outputs").exists()


@pytest.mark.parametrize("text", ["", "# outputs: kept\n"])
def test_settings_may_hold_nothing(cli, settings, tmp_path, text):
    settings(text)
    assert cli(*LINE).folder.parent == tmp_path / "outputs/runs"


def test_what_is_typed_wins(cli, settings, tmp_path):
    settings("outputs: kept\nhydra.sweeper.workers: 3\n")
    assert cli(*LINE, "outputs=typed").folder.parent == tmp_path / "typed/runs"
    assert cli("-m", *LINE, "seed=1,2", "outputs=typed", "hydra.sweeper.workers=0").code == 0
    assert not (tmp_path / "kept").exists()


def test_a_run_goes_elsewhere_when_the_settings_change(cli, settings, tmp_path, monkeypatch):
    assert cli(*LINE).folder.parent == tmp_path / "outputs/runs"
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "other"))
    path = settings("outputs: kept\n")
    (tmp_path / "other").symlink_to(path.parent.parent)
    assert cli(*LINE).folder.parent == tmp_path / "kept/runs"


def test_a_scheduler_of_the_settings_is_asked(cli, settings):
    settings("hydra.sweeper.address: tcp://127.0.0.1:9\n")
    ending = cli("-m", *LINE, "seed=1,2")
    assert ending.code == 2
    assert "tcp://127.0.0.1:9" in ending.err


def test_workers_of_the_settings_are_used(cli, settings):
    settings("hydra.sweeper.workers: -1\n")
    ending = cli("-m", *LINE, "seed=1,2")
    assert ending.code == 2
    assert "hydra.sweeper.workers: must be a whole number, 0 or more; found -1" in ending.err


@pytest.mark.parametrize(
    ("text", "line", "found"),
    [
        ("outputs: a\noutput: b\n", ", line 2", "{'output': 'b'} is not a setting (did you mean outputs?)"),
        ("hydra:\n  sweeper: {workers: 1}\n", ", line 1", "{'hydra': {'sweeper': {'workers': 1}}} is not a setting"),
        ("outputs: [a]\n", ", line 1", "{'outputs': ['a']} is not a setting"),
        ("plugin: a=b\n", ", line 1", "{'plugin': 'a=b'} is not a setting"),
        ("outputs: ${oc.env:HOME}\n", ", line 1", "'${oc.env:HOME}' calls a function"),
        ("outputs: a\noutputs: b\n", ", line 2", "the key 'outputs' stands twice"),
        ("outputs: !!python/name:os.mkdir\n", ", line 1", "the tag"),
        ("3\n", ", line 1", "is not a setting"),
        ("[outputs]\n", "", "is not a setting"),
    ],
)
def test_bad_settings_are_told_with_their_line(cli, settings, text, line, found):
    path = settings(text)
    ending = cli(*LINE)
    assert (ending.code, ending.out) == (2, "")
    assert f"{path}{line}: " in ending.err
    assert found in ending.err
    assert "no setting" not in found or ", ".join(KEYS) in ending.err


def test_settings_that_cannot_be_read_are_told(cli, settings):
    path = settings("")
    path.write_bytes(b"\xff\xfe")
    assert f"cannot read {path}: 'utf-8' codec" in cli(*LINE).err
    path.unlink()
    path.mkdir()
    assert cli("-m", *LINE).code == 2


def test_the_page_on_sweeps_tells_the_settings():
    page = (ROOT / "docs/sweeps.md").read_text()
    assert "~/.config/arm-control-runner/config.yaml" in page
    assert all(f"\n    {key}: " in page for key in KEYS)
