"""Motions read from files: splines through their rows, and messages that name the line of what is wrong."""

import numpy as np
import pyarrow as pa
import pyarrow.parquet
import pytest
from support.grids import plan_sweep

from runner.assembly.validation import validate
from runner.base.errors import ConfigError
from runner.config.compose.compose import compose
from runner.robots.robot import end_points
from runner.store import run_hash
from runner.store.identity import simulated_part
from runner.sweeps.job import run

T = np.linspace(0.0, 2.0, 21)
POSTURE = 0.1 * np.outer(1.0 - np.cos(np.pi * T), [1.0, -0.5, 0.7])  # a swing and back, at rest at both ends
SPEED = 0.1 * np.pi * np.outer(np.sin(np.pi * T), [1.0, -0.5, 0.7])
PUSH = 0.1 * np.pi**2 * np.outer(np.cos(np.pi * T), [1.0, -0.5, 0.7])
JOINTS = [f"{stem}{joint}" for stem in ("q", "dq", "ddq") for joint in (1, 2, 3)]


@pytest.fixture(autouse=True)
def _in_an_empty_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


@pytest.fixture
def macro(checked_config):
    return checked_config("robot=macro").arm


@pytest.fixture
def written(tmp_path):
    """Write columns as CSV, or as Parquet where the name ends so, and return the file."""

    def write(names, values, name="motion.csv"):
        path = tmp_path / name
        table = np.column_stack([T[: len(values)], *np.atleast_2d(values.T)])
        if name.endswith("parquet"):
            pa.parquet.write_table(pa.table(dict(zip(["t", *names], table.T, strict=True))), path)
        else:
            lines = [",".join(["t", *names]), *(",".join(map(repr, row)) for row in table.tolist())]
            path.write_text("\n".join(lines) + "\n")
        return path

    return write


def checked(file, *more, robot="macro"):
    overrides = [f"robot={robot}", "trajectory=from_file", f"trajectory.file={file}", *more]
    return validate(compose(overrides))


def problems_of(file, *more):
    with pytest.raises(ConfigError) as raised:
        checked(file, *more)
    return raised.value.problems


def test_a_spline_passes_the_rows_from_rest_to_rest(written, macro):
    tip = end_points(macro, macro.home + POSTURE)[-1]
    path = checked(written("xyz", tip)).path
    motion = path.sample(T)
    np.testing.assert_allclose(motion[:, 0], tip, atol=1e-14)
    np.testing.assert_allclose(motion[[0, -1], 1], 0.0, atol=1e-14)
    assert path.duration == 2.0
    np.testing.assert_allclose(path.start, tip[0], atol=1e-14)
    np.testing.assert_allclose(path.sample(np.array([5.0]))[0], [path.goal, np.zeros(3), np.zeros(3)], atol=1e-14)
    assert path.distance_to_path(tip).max() < 1e-12


def test_velocity_and_acceleration_are_derivatives(written):
    h, t = 1e-5, np.random.default_rng(0).uniform(1e-3, 1.999, 50)
    for orders, kind in ((1, "spline"), (2, "hermite"), (3, "hermite")):
        file = written(JOINTS[: 3 * orders], np.hstack([POSTURE, SPEED, PUSH])[:, : 3 * orders], f"{orders}.csv")
        path = checked(file, f"trajectory.interpolation={kind}").path
        for sample in (path.sample, path.sample_joints):
            here, after, before = sample(t), sample(t + h), sample(t - h)
            np.testing.assert_allclose((after[:, 0] - before[:, 0]) / (2.0 * h), here[:, 1], atol=1e-7)


def test_what_the_file_says_of_speed_and_acceleration_holds_at_its_rows(written):
    names, values = JOINTS, np.hstack([POSTURE, SPEED, PUSH])
    path = checked(written(names, values), "trajectory.interpolation=hermite").path
    motion = path.sample_joints(T)
    for order, expected in enumerate((POSTURE, SPEED, PUSH)):
        np.testing.assert_allclose(motion[:, order], expected, atol=1e-12)


def test_between_rows_the_error_falls_with_the_order_of_the_interpolation(written):
    fine = np.linspace(0.0, 2.0, 501)
    true = 0.1 * np.outer(1.0 - np.cos(np.pi * fine), [1.0, -0.5, 0.7])
    errors = []
    for orders, kind in ((1, "spline"), (2, "hermite"), (3, "hermite")):
        file = written(JOINTS[: 3 * orders], np.hstack([POSTURE, SPEED, PUSH])[:, : 3 * orders], f"{orders}.csv")
        path = checked(file, f"trajectory.interpolation={kind}").path
        errors.append(np.abs(path.sample_joints(fine)[:, 0] - true).max())
    h = 0.1 * np.pi  # phase between rows
    assert errors[1] < 0.1 * h**4 / 384 * 1.01
    assert errors[2] < 0.1 * h**6 / 46080 * 1.01
    assert errors[0] < 5.0 * 0.1 * h**4 / 384


def test_parquet_holds_the_same_as_csv(written):
    csv, parquet = (checked(written(JOINTS[:3], POSTURE, name)) for name in ("a.csv", "a.parquet"))
    np.testing.assert_array_equal(csv.path.sample_joints(T), parquet.path.sample_joints(T))
    assert simulated_part(csv.resolved) == simulated_part(parquet.resolved)


def test_its_content_makes_the_run_and_not_its_name(written):
    one, same, other = written(JOINTS[:3], POSTURE), written(JOINTS[:3], POSTURE, "b.csv"), None
    other = written(JOINTS[:3], 1.001 * POSTURE, "c.csv")
    names = [run_hash(checked(file).resolved, "") for file in (one, same, other)]
    assert names[0] == names[1] != names[2]


def test_a_stored_run_needs_no_file(written, tmp_path):
    file = written(JOINTS[:3], POSTURE)
    made = run("robot=macro", "trajectory=from_file", f"trajectory.file={file}", "duration=0.1", f"outputs={tmp_path}")
    file.unlink()
    path = validate(made.composed).path
    np.testing.assert_allclose(path.sample_joints(T)[:, 0], POSTURE, atol=1e-14)


def test_a_changed_file_is_another_run_though_the_line_is_the_same(written, cli):
    folders = []
    for share in (1.0, 0.5):
        written(JOINTS[:3], share * POSTURE)
        ending = cli("robot=macro", "trajectory=from_file", "trajectory.file=motion.csv", "duration=0.1")
        assert ending.code == 0
        folders += ending.out.split()
    assert len(set(folders)) == 2


def test_a_sweep_over_files_is_one_of_their_contents(written):
    names = [written(JOINTS[:3], share * POSTURE, f"m{share}.csv").name for share in (1.0, 0.5)]
    plan = plan_sweep(["robot=macro", "trajectory=from_file", f"trajectory.file={','.join(names)}"])
    swept = [run_hash(validate(plan.composed(cell)).resolved, "") for cell in range(len(plan))]
    assert swept == [run_hash(checked(name).resolved, "") for name in names]
    assert swept[0] != swept[1]


def test_a_name_leads_to_the_working_folder(written):
    written(JOINTS[:3], POSTURE)
    assert checked("motion.csv").path.duration == 2.0
    (problem,) = problems_of("gone.csv")
    assert problem.startswith("trajectory.file: no file 'gone.csv'; looked in ")
    assert problems_of("../motion.csv")[0].endswith("leads out of its folder; give its whole path")
    assert problems_of("null") == (
        "trajectory.columns: missing; name a CSV or Parquet file, as in trajectory.file=motion.csv; found None",
    )


@pytest.mark.parametrize(
    ("text", "problem"),
    [
        ("time,x,y,z\n0,1,2,3\n", "has the columns 'time,x,y,z'; allowed: t,x,y,z or t,q1,q2,"),
        ("t,x,y\n", "has the columns 't,x,y'; allowed: "),
        ("t,q1,q3\n", "has the columns 't,q1,q3'; allowed: "),
        ("", "is empty. Allowed: rows of numbers."),
        ("t,q1,q2,q3\n0,0,0,0\n1,0,,0\n2,0,0,0\n", "line 3: q2 is missing; allowed: a finite number"),
        ("t,q1,q2,q3\n0,0,0,0\n1,0,nan,0\n2,0,0,0\n", "line 3: q2 is missing; allowed: a finite number"),
        ("t,q1,q2,q3\n0,0,0,0\n1,0,1e999,0\n2,0,0,0\n", "line 3: q2 is 'inf'; allowed: a finite number"),
        ("t,q1,q2,q3\n0,0,0,0\n\n2,0,0,0\n", "has 2 rows; a motion needs 3 or more"),
        ("t,q1\ns,deg\n0,0\n1,1\n2,0\n", "has a line of units; allowed: columns in s, m and rad without one"),
        ("t,q1\n0,0\n1,1\n2,0\n3", "the last line, 5, is cut off and left out"),
        ("t,q1,q2,q3\n0,0,0,0\n1,0,0\n2,0,0,0\n", "line 3: 3 cells for 4 columns"),
        ("t,q1,q2,q3\n0,0,0,0\n1,0,0,0\n0.9,0,0,0\n", "line 4: t is 0.9 s after 1 s; time must run forward"),
        ("t,q1,q2,q3\n0,0,0,0\n1,0,0,0\n1,0,0,0\n", "line 4: t is 1 s after 1 s; time must run forward"),
        ("t,q1,q2,q3\n1,0,0,0\n2,0,0,0\n3,0,0,0\n", "line 2: t is 1 s; the first must be 0"),
        ("t,q1,q2,q3\n0,0,0,0\n1,0,0,0\n", "has 2 rows; a motion needs 3 or more"),
    ],
)
def test_what_is_no_motion_is_told_with_its_line(tmp_path, text, problem):
    (tmp_path / "motion.csv").write_text(text)
    (told,) = problems_of("motion.csv")
    assert told.startswith(f"trajectory.file: motion.csv: {problem}")


def test_a_motion_begins_and_ends_at_rest(written):
    speed = SPEED + 0.1
    told = problems_of(written(JOINTS[:6], np.hstack([POSTURE, speed])), "trajectory.interpolation=hermite")
    assert told[0] == ("trajectory.file: motion.csv: line 2: dq1 is 0.1; the motion must start and end at rest, with 0")


def test_problems_beyond_the_fifth_are_counted(tmp_path):
    (tmp_path / "motion.csv").write_text("t,q1,q2,q3\n" + "0,a,b,c\n" * 3)
    told = problems_of("motion.csv")
    assert len(told) == 6
    assert told[5] == "trajectory.file: motion.csv: 4 more problems like these"


def test_interpolations_that_do_not_fit_are_refused(written):
    still, fast = written(JOINTS[:3], POSTURE), written(JOINTS[:6], np.hstack([POSTURE, 0.0 * SPEED]), "fast.csv")
    assert "allowed: spline, hermite" in problems_of(still, "trajectory.interpolation=linear")[0]
    assert "an acceleration without bound" in problems_of(still, "trajectory.interpolation=linear")[0]
    assert (
        "has no velocities, which interpolation=hermite needs"
        in problems_of(still, "trajectory.interpolation=hermite")[0]
    )
    assert "has velocities, which interpolation=spline would not take" in problems_of(fast)[0]
    assert "the file lasts 2 s; allowed: null" in problems_of(still, "trajectory.duration=3")[0]


def test_limits_of_joints_and_reach_are_checked(written, macro):
    assert "3 joints, q1 to q3; the robot has 7: joint1" in problems_of(written(JOINTS[:3], POSTURE), "robot=xarm7")[0]
    far = np.outer(np.linspace(0.0, 1.0, 21), [100.0, 0.0, 0.0]) + end_points(macro, macro.home[None])[-1, 0]
    assert "the path lies" in problems_of(written("xyz", far))[0]
    wild = problems_of(
        written([f"q{n}" for n in range(1, 8)], np.outer(np.sin(np.pi * T) ** 2, 7.0 * np.ones(7))), "robot=xarm7"
    )
    assert any("beyond its limits, -6.283 to 6.283 rad" in problem for problem in wild)


@pytest.mark.parametrize("content", [b"PAR1 nothing", b"\xff\xfe\x00"])
def test_what_cannot_be_read_is_told(tmp_path, content):
    for name in ("bad.parquet", "bad.csv"):
        (tmp_path / name).write_bytes(content)
        assert problems_of(name)[0].startswith(f"trajectory.file: {name}: ")


def test_gaps_in_parquet_are_told(tmp_path):
    pa.parquet.write_table(pa.table({"t": [0.0, 1.0, None], "q1": [0.0, float("nan"), 0.0]}), tmp_path / "a.parquet")
    assert problems_of("a.parquet") == (
        "trajectory.file: a.parquet: row 3: t is missing; allowed: a finite number",
        "trajectory.file: a.parquet: row 2: q1 is missing; allowed: a finite number",
    )


@pytest.mark.parametrize("controller", ["computed_torque", "operational_space", "differential_inverse_kinematics"])
def test_every_law_runs_along_it(written, macro, tmp_path, controller):
    tip = end_points(macro, macro.home + POSTURE)[-1]
    for file in (written("xyz", tip), written(JOINTS[:3], POSTURE, "joints.csv")):
        overrides = ("robot=macro", f"controller={controller}", "trajectory=from_file", f"trajectory.file={file}")
        made = run(*overrides, f"outputs={tmp_path}")
        assert made.metrics["max_tracking_error"].median < 0.02


def test_a_small_parquet_of_huge_cells_is_refused(tmp_path):
    path = tmp_path / "motion.parquet"
    pa.parquet.write_table(pa.table({"t": [b"0" * 6_000_000]}), path, compression="zstd", use_dictionary=False)
    with pytest.raises(ConfigError, match=r"bytes; allowed: up to 5,000,000, unpacked"):
        compose(["robot=macro", "trajectory=from_file", f"trajectory.file={path}"])
