"""`runner audit FILE`: own formulas against the model of a URDF."""

from runner.base.paths import robots_dir

RIGHT = "elements: {P_x: s1*(sin(q2 + q3) - c2), P_y: c1*(c2 - sin(q2 + q3)), P_z: cos(q2 + q3) + s2}"
GRAVITY = "elements: {G_1: 0, G_2: 19.62*c2 - 9.81*s2, G_3: -9.81*sin(q2 + q3)}"


def test_right_formulas_end_well(cli, tmp_path):
    (tmp_path / "own.yaml").write_text(RIGHT)
    ending = cli("audit", "macro.urdf", "--tip", "tip", "--position", "own.yaml")
    assert (ending.code, ending.out, ending.err) == (0, "position: 3 of 3 formulas agree\n", "")


def test_a_wrong_one_is_shown_with_its_place_and_the_exit_code_is_1(cli, tmp_path):
    (tmp_path / "own.yaml").write_text(RIGHT)
    (tmp_path / "gravity.yaml").write_text(GRAVITY)
    urdf = robots_dir() / "macro.urdf"
    ending = cli("audit", urdf, "--tip", "tip", "--position", "own.yaml", "--gravity", "gravity.yaml")
    assert ending.code == 1
    first, second, header, row = ending.out.splitlines()
    assert first == "position: 3 of 3 formulas agree"
    assert second == "gravity: 2 of 3 formulas agree"
    assert header.split() == ["element", "largest", "error", "typical", "formula", "gives", "true", "at", "q", "[rad]"]
    assert row.split()[0] == "G_2"


def test_fewer_samples_and_a_wide_tolerance(cli, tmp_path):
    (tmp_path / "gravity.yaml").write_text(GRAVITY)
    asked = ("audit", "macro.urdf", "--tip", "tip", "--gravity", "gravity.yaml")
    assert cli(*asked, "--samples", "5").code == 1
    assert cli(*asked, "--tolerance", "30").code == 0


def test_bad_input_ends_with_2_and_says_what_is_allowed(cli, tmp_path):
    (tmp_path / "own.yaml").write_text("elements: {P_x: s1*(c2}")
    for arguments, message in (
        (("--position", "own.yaml"), "'(' was never closed"),
        ((), "no formulas to compare. Add one of --position, --jacobian, --mass-matrix, --gravity"),
        (("--position", "own.yaml", "--samples", "0"), "--samples: out of range (0). Allowed: 1 to 100000."),
        (("--position", "own.yaml", "--tolerance", "-1"), "--tolerance: out of range (-1). Allowed: above 0."),
        (("--position", "none.yaml"), "cannot read none.yaml"),
    ):
        ending = cli("audit", "macro.urdf", "--tip", "tip", *arguments)
        assert (ending.code, ending.out) == (2, "")
        assert message in ending.err
        assert "Traceback" not in ending.err
    assert "no frame 'tp' (did you mean tip?)" in cli("audit", "macro.urdf", "--tip", "tp", "--gravity", "x").err
    assert (
        "no file 'makro.urdf' (did you mean macro.urdf?)"
        in cli("audit", "makro.urdf", "--tip", "t", "--gravity", "x").err
    )
    assert "--tip" in cli("audit", "macro.urdf", "--position", "own.yaml").err
