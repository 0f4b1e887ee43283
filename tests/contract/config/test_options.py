"""Options of groups against the files in conf/ and in a folder of the user."""

from runner.config.compose.files import described_files, group_options, groups


def test_the_groups_are_the_folders_of_conf():
    known = {"controller", "experiment", "noise", "plant", "preset", "robot", "torque_limits", "trajectory"}
    assert known <= set(groups())
    assert groups() == sorted(groups())


def test_every_option_has_a_description():
    for group in groups():
        for name, description in group_options(group).items():
            assert len(description) > 10, f"{group}={name}"
            assert not description.startswith(("@package", "runner ")), f"{group}={name}"


def test_options_in_folders_carry_the_folder():
    assert "thesis/figure_3_5" in group_options("experiment")


def test_own_options_stand_among_ours_and_replace_their_namesakes(tmp_path):
    (tmp_path / "noise").mkdir()
    (tmp_path / "noise" / "strong.yaml").write_text(
        "# @package _global_\n# runner noise=strong\n# Tenfold\nposition: 1\n"
    )
    (tmp_path / "noise" / "none.yaml").write_text("position: 0.0\n# Mine\n")
    assert group_options("noise", [tmp_path]) == {
        "none": "Mine",
        "strong": "Tenfold",
        "thesis": group_options("noise")["thesis"],
    }


def test_own_groups_are_named(tmp_path):
    (tmp_path / "weather").mkdir()
    assert set(groups([tmp_path])) - set(groups()) == {"weather"}


def test_files_without_comment_or_no_text_at_all_are_listed(tmp_path):
    (tmp_path / "bare.yaml").write_text("a: 1\n")
    (tmp_path / "binary.yaml").write_bytes(b"\xff\xfe\x00")
    (tmp_path / "gone.yaml").symlink_to(tmp_path / "nowhere")
    assert described_files(tmp_path) == {"bare": "", "binary": ""}


def test_a_folder_that_does_not_exist_has_no_files(tmp_path):
    assert described_files(tmp_path / "nowhere") == {}
