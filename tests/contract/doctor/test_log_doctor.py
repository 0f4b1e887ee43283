"""`runner doctor LOG` on every known format, up to the column map and the motion, and on bad input."""

import json
import shutil

import numpy as np
import pandas as pd
import pytest
import yaml
from support import log_files as made

from runner.assembly.validation import validate
from runner.base.errors import RunnerError
from runner.base.paths import examples_dir
from runner.config.compose.compose import compose
from runner.doctor.log import examine_log
from runner.doctor.log_files import map_text
from runner.recordings.files import read_log


def csv(tmp_path, table, sep=",", name="log.csv", head="", decimal="."):
    path = tmp_path / name
    path.write_text(head + table.to_csv(index=False, sep=sep, decimal=decimal, float_format="%.6f"))
    return path


def savetxt(tmp_path, table):
    np.savetxt(tmp_path / "log.txt", table.to_numpy(), header=" ".join(table.columns))
    return tmp_path / "log.txt"


def plotjuggler(tmp_path, signals, joints, time):
    names = {k: f"/joint_states/{{}}/{v}" for k, v in (("q", "position"), ("tau", "effort"))}
    table = made.frame(signals, {"t": time, **names})
    table.columns = [c if c == time else c.replace(f"/{c.split('/')[2]}/", f"/{joints[int(c.split('/')[2])]}/")
                     for c in table.columns]  # fmt: skip
    other = pd.DataFrame({time: signals["t"][:-1] + 0.003, "/other/value": 1.0})
    return csv(tmp_path, pd.concat([table, other]).sort_values(time))


def by_joint_names(tmp_path, signals, joints):
    """A table with dates as times, and columns of the names of the joints, by their alphabet."""
    dates = pd.to_datetime(1_700_000_000_123_000_000 + (1e9 * signals["t"]).round().astype(int)).strftime("%FT%T.%f")
    columns = {name: signals["q"][:, joints.index(name)] for name in sorted(joints)}
    return csv(tmp_path, pd.DataFrame({"timestamp": dates, **columns}))


def rostopic(tmp_path, signals, joints):
    """A table as rostopic writes it; the driver of UR sorts the joints by their names."""
    stamps = 1_700_000_000_123_456_789 + (1e9 * signals["t"]).round().astype(int)
    order = sorted(range(len(joints)), key=lambda place: joints[place])
    columns = {"%time": stamps + 1_000_000, "field.header.stamp": stamps}
    columns |= {f"field.name{place}": joints[joint] for place, joint in enumerate(order)}
    for name, kind in (("position", "q"), ("velocity", "dq"), ("effort", "tau")):
        columns |= {f"field.{name}{place}": signals[kind][:, joint] for place, joint in enumerate(order)}
    return csv(tmp_path, pd.DataFrame(columns))


def axes(tmp_path, signals):
    frame = pd.DataFrame(np.degrees(signals["q"]), columns=[f"A{place + 1}" for place in range(6)])
    return csv(tmp_path, frame.assign(Zeit=signals["t"]), ";", decimal=",")


def npz(tmp_path, signals):
    np.savez(tmp_path / "log.npz", t=signals["t"], q=signals["q"], dq=signals["dq"].T, tau=signals["tau"])
    return tmp_path / "log.npz"


def panda_python(tmp_path, signals):
    """Save what `get_log` returns: lists of arrays, the time in ms as arrays of one."""
    lists = {"tau_J": signals["tau"], "q": signals["q"], "dq": signals["dq"], "time": 1e3 * signals["t"][:, None]}
    np.savez(tmp_path / "log.npz", **{name: list(rows) for name, rows in lists.items()})
    return tmp_path / "log.npz"


def plotjuggler_by_topic(tmp_path, signals, joints):
    """Write what PlotJuggler 3.17 exports into a file for each topic: names without it, twelve digits."""
    columns = {
        f"{joint}/{name}": signals[kind][:, k] for k, joint in enumerate(joints) for name, kind in SIGNALS.items()
    }
    table = pd.DataFrame({"time": [f"{1.7e9 + t:.6f}" for t in signals["t"]], **columns})
    table.to_csv(tmp_path / "log.csv", index=False, float_format="%.12g")
    return tmp_path / "log.csv"


def long(tmp_path, signals, joints):
    rows = [
        {"time": t, "joint": joint, **{name: signals[kind][row, place] for name, kind in SIGNALS.items()}}
        for row, t in enumerate(signals["t"])
        for place, joint in enumerate(joints)
    ]
    return csv(tmp_path, pd.DataFrame(rows))


SIGNALS = {"position": "q", "velocity": "dq", "effort": "tau"}


def lists(tmp_path, signals):
    table = pd.DataFrame({"t": signals["t"], **{kind: signals[kind].round(7).tolist() for kind in ("q", "tau")}})
    return csv(tmp_path, table)


def json_lines(tmp_path, signals, joints):
    """Write the messages of joint states as objects, by the alphabet of the joints."""
    order = np.argsort(joints)
    names = [joints[place] for place in order]
    with (tmp_path / "log.jsonl").open("w") as file:
        for row, t in enumerate(signals["t"]):
            values = {name: signals[kind][row, order].tolist() for name, kind in SIGNALS.items()}
            stamp = {"sec": 1_700_000_000 + int(t), "nanosec": round(1e9 * (t % 1.0))}
            file.write(json.dumps({"header": {"stamp": stamp}, "name": names, **values}) + "\n")
    return tmp_path / "log.jsonl"


def nested_json(tmp_path, signals):
    kinds = {"q": "q", "dq": "dq", "tau": "tau"}
    rows = [
        {"t": t, "state": {name: signals[kind][row].tolist() for name, kind in kinds.items()}, "mode": "run"}
        for row, t in enumerate(signals["t"].tolist())
    ]
    (tmp_path / "log.json").write_text(json.dumps(rows))
    return tmp_path / "log.json"


FORMATS = {
    "commas": lambda p, s, m: csv(p, made.frame(s, made.PLAIN, 1)),
    "semicolons": lambda p, s, m: csv(p, made.frame(s, made.PLAIN, 1), ";", "log.tsv", decimal=","),
    "tabs": lambda p, s, m: csv(p, made.frame(s, made.PLAIN, 1), "\t", "log.log"),
    "comments": lambda p, s, m: csv(p, made.frame(s, made.PLAIN, 1), head="# by hand\n# twice\n"),
    "savetxt": lambda p, s, m: savetxt(p, made.frame(s, made.PLAIN, 1)),
    "ur-rtde": lambda p, s, m: csv(p, made.frame(s, made.RTDE)),
    "record.py": lambda p, s, m: csv(p, made.frame(s, made.RTDE), " "),
    "plotjuggler": lambda p, s, m: plotjuggler(p, s, m.joint_names, "__time"),
    "plotjuggler 3.17": lambda p, s, m: plotjuggler(p, s, m.joint_names, "time"),
    "parquet": lambda p, s, m: made.frame(s, made.RTDE).to_parquet(p / "log.parquet") or p / "log.parquet",
    "mecademicpy": lambda p, s, m: made.write_meca_zip(p / "log.zip", s),
    "joint names and dates": lambda p, s, m: by_joint_names(p, s, m.joint_names),
    "rostopic": lambda p, s, m: rostopic(p, s, m.joint_names),
    "axes": lambda p, s, m: axes(p, s),
    "npz": lambda p, s, m: npz(p, s),
    "panda-python": lambda p, s, m: panda_python(p, s),
    "plotjuggler by topic": lambda p, s, m: plotjuggler_by_topic(p, s, m.joint_names),
    "long": lambda p, s, m: long(p, s, m.joint_names),
    "lists": lambda p, s, m: lists(p, s),
    "json lines": lambda p, s, m: json_lines(p, s, m.joint_names),
    "nested json": lambda p, s, m: nested_json(p, s),
    "libfranka": lambda p, s, m: csv(p, made.frame(s, made.FRANKA)),
}
BAGS = {
    "rosbag1": lambda p, r: made.write_bag(p / "log.bag", r, ".bag"),
    "rosbag1 bz2": lambda p, r: made.write_bag(p / "log.bag", r, ".bag", "BZ2"),
    "rosbag1 lz4": lambda p, r: made.write_bag(p / "log.bag", r, ".bag", "LZ4"),
    "db3": lambda p, r: made.write_bag(p / "log", r, ".db3"),
    "db3 lone": lambda p, r: made.write_bag(p / "log", r, ".db3") / "log.db3",
    "db3 messages": lambda p, r: made.write_bag(p / "log", r, ".db3", "MESSAGE"),
    "db3 file": lambda p, r: made.write_bag(p / "log", r, ".db3", "FILE"),
    "mcap": lambda p, r: made.write_bag(p / "log", r, ".mcap"),
    "mcap chunks": lambda p, r: made.write_bag(p / "log", r, ".mcap", "STORAGE"),
    "mcap mixed": lambda p, r: made.write_mixed_mcap(p / "log.mcap", r),
    "mcap killed": lambda p, r: made.write_mixed_mcap(p / "log.mcap", r, cut=0.9),
}


@pytest.mark.costs(2)
@pytest.mark.parametrize("name", FORMATS)
def test_every_format_has_a_map_and_a_motion(tmp_path, arm, signals, name):
    path = FORMATS[name](tmp_path, signals, arm)
    found = examine_log(path, arm)
    assert [question.place for question in found.questions] == []
    assert found.motion is not None
    assert found.recording.positions(arm.joint_names) == pytest.approx(signals["q"], abs=2e-6)
    (tmp_path / "columns.yaml").write_text(map_text(found, None, None))
    again = examine_log(path, arm, given=tmp_path / "columns.yaml")
    assert again.motion == found.motion


@pytest.mark.costs(3)
@pytest.mark.parametrize("name", BAGS)
def test_every_bag_has_a_map_and_a_motion(tmp_path, arm, signals, name):
    pytest.importorskip("rosbags", reason="writes the bags")
    path = BAGS[name](tmp_path, made.ros_messages(signals, arm.joint_names))
    if path.is_dir():
        (path / "metadata.yaml").unlink()  # as a killed recorder leaves it
    found = examine_log(path, arm)
    count = len(found.recording.t)
    assert count == len(signals["t"]) if name != "mcap killed" else 400 < count < len(signals["t"])
    assert found.recording.positions(arm.joint_names) == pytest.approx(signals["q"][:count])
    assert found.motion is not None
    said = " ".join(map(str, found.findings))
    assert ("breaks off, as a killed recorder leaves it" in said) == (name == "mcap killed")


def test_states_of_a_controller_have_its_commands(tmp_path, arm, signals):
    pytest.importorskip("rosbags", reason="writes the bags")
    path = made.write_bag(
        tmp_path / "log", made.ros_messages(signals, arm.joint_names), kind="JointTrajectoryControllerState"
    )
    found = examine_log(path, arm)
    assert found.motion.commanded
    assert "elbow_joint.reference.position" in found.table.columns
    assert found.table.columns["elbow_joint.feedback.position"] == pytest.approx(signals["q"][:, 2])


def test_names_that_tell_nothing_are_asked_for_and_the_answers_taken(cli, tmp_path, arm, signals):
    names = ["red", "green", "blue", "black", "white", "grey"]
    table = pd.DataFrame(signals["q"], columns=names).assign(t=signals["t"], count=np.arange(len(signals["t"])))
    path = csv(tmp_path, table)
    found = examine_log(path, arm)
    assert [question.place for question in found.questions] == ["columns"]
    assert [one.column for one in found.meanings] == names  # without the counter
    assert found.motion is None
    assert cli("doctor", path, "--robot", "ur5e", "-o", tmp_path / "mine").code == 1
    text = (tmp_path / "mine" / "columns.yaml").read_text()
    unanswered = cli("doctor", path, "--robot", "ur5e", "--columns", tmp_path / "mine" / "columns.yaml")
    assert "columns.red.unit: needs a value; found null (line 4)" in unanswered.err
    for joint in arm.joint_names:
        text = text.replace("{joint: null, unit: null}", f"{{joint: {joint}, unit: rad}}", 1)
    (tmp_path / "answered.yaml").write_text(text)
    answered = examine_log(path, arm, given=tmp_path / "answered.yaml")
    assert answered.recording.positions(arm.joint_names) == pytest.approx(signals["q"], abs=2e-6)


def test_a_log_of_commands_is_called_one(cli, tmp_path, signals):
    path = csv(tmp_path, made.frame(signals, {key: made.RTDE[key] for key in ("t", "command")}))
    assert "motion  the commanded positions of the log" in cli("doctor", path, "--robot", "ur5e").out


def test_a_split_bag_is_read_in_order(tmp_path, arm, signals):
    pytest.importorskip("rosbags", reason="writes the bags")
    rows = made.ros_messages(signals, arm.joint_names)
    for place, part in enumerate((rows[:200], rows[200:300], rows[300:])):
        folder = made.write_bag(tmp_path / f"part{place}", part, ".db3")
        (tmp_path / "log").mkdir(exist_ok=True)
        shutil.move(folder / f"part{place}.db3", tmp_path / "log" / f"log_{9 + place}.db3")
    table = read_log(tmp_path / "log")
    assert np.diff(table.columns["stamp"]) == pytest.approx(0.008)
    assert len(table) == 500


STATES = 90.0 * np.sin(np.outer(np.arange(120) / 30.0, [1.0, 1.3, 1.7, 1.1, 2.0]))
MOTORS = ("shoulder_pan", "shoulder_lift", "elbow_flex", "wrist_flex", "wrist_roll")


def test_a_lerobot_episode_asks_for_its_unit_or_takes_the_calibration(tmp_path):
    model = validate(compose(["robot=so101"])).arm.model
    folder = made.write_lerobot(tmp_path / "set", STATES, MOTORS)
    found = examine_log(folder, model)
    assert found.table.form == "LeRobot data set, episode 0, the longest of 0 to 1"
    assert found.motion is None
    assert "per cent of the calibrated range or degrees: say unit: deg" in str(found.questions[0])
    assert "unit: null}  # fill in: " in map_text(found, None, None)
    assert len(examine_log(folder, model, episode=1).table) == 110
    ranges = ", ".join(f'"{name}": {{"range_min": 1024, "range_max": 3072}}' for name in MOTORS)
    (folder / "meta" / "calibration.json").write_text(f"{{{ranges}}}")
    scaled = examine_log(folder, model)
    assert scaled.recording.positions(model.joint_names) == pytest.approx(STATES / 100.0 * np.pi / 2.0, abs=1e-4)


def test_torques_without_gravity_are_proposed_with_the_evidence(tmp_path, arm, signals):
    gravity = np.array([arm.gravity_torque(row) for row in signals["q"]])
    path = csv(tmp_path, made.frame({**signals, "tau": signals["tau"] - gravity}, made.PLAIN, 1))
    found = examine_log(path, arm)
    assert found.recording.holds == "without_gravity"
    assert "holds: without_gravity" in map_text(found, None, None)
    assert found.motion is not None


def test_an_inverted_joint_is_asked_for_and_no_motion_is_written(cli, tmp_path, arm, signals):
    q = signals["q"] * np.array([1, 1, -1, 1, 1, 1])
    path = csv(tmp_path, made.frame({**signals, "q": q}, made.PLAIN, 1))
    ending = cli("doctor", path, "--robot", "ur5e", "-o", tmp_path / "out")
    assert ending.code == 1
    assert "ask     columns.q3: fits with the opposite sign" in ending.out
    assert {file.name for file in (tmp_path / "out").iterdir()} == {"columns.yaml"}
    said = yaml.safe_load((tmp_path / "out" / "columns.yaml").read_text())
    said["columns"]["q3"]["sign"] = -1
    (tmp_path / "out" / "columns.yaml").write_text(yaml.safe_dump(said))
    again = cli(
        "doctor", path, "--robot", "ur5e", "--columns", tmp_path / "out" / "columns.yaml", "-o", tmp_path / "out"
    )
    assert again.code == 0
    assert (tmp_path / "out" / "motion.csv").is_file()


def test_effort_that_is_zero_is_not_taken(tmp_path, arm, signals):
    path = csv(tmp_path, made.frame({**signals, "tau": 0.0 * signals["tau"]}, made.PLAIN, 1))
    found = examine_log(path, arm)
    assert "is 0 in all rows" in str(found.questions[0])
    assert "  # tau1: " in map_text(found, None, None)
    assert found.motion is not None


def test_rows_counted_by_one_are_asked_for(tmp_path, arm, signals):
    path = csv(tmp_path, made.frame({**signals, "t": np.arange(500.0)}, made.PLAIN, 1))
    assert "is it ms, or a number of rows?" in str(examine_log(path, arm).questions[0])


@pytest.mark.costs(8)
def test_the_printed_line_runs_and_compares(cli, tmp_path, arm, signals, monkeypatch):
    monkeypatch.chdir(tmp_path)
    path = csv(tmp_path, made.frame(signals, made.RTDE))
    ending = cli("doctor", path.name, "--robot", "ur5e", "-o", "out")
    line, folder = ending.out.splitlines()[-2:]
    assert (ending.code, folder) == (0, "out")
    first, then = (part.split()[1:] for part in line.split(" && "))
    assert cli(*first).code == 0
    compared = cli(*then)
    assert compared.code == 0
    assert "elbow_joint          Coulomb" in compared.out


def doubled(table):
    return table.assign(**{f"q{place}": table[f"q{place - 6}"] for place in range(7, 13)})


@pytest.mark.parametrize(
    ("make", "options", "wanted"),
    [
        (lambda p, f: (p / "log.csv").write_text(""), [], "is empty"),
        (lambda p, f: (p / "log.csv").write_bytes(b"\x00\x01" * 1000), [], "is neither text nor Parquet"),
        (lambda p, f: (p / "log.csv").write_text("once upon a time\nthere was an arm\n"), [], "no columns of joint"),
        (lambda p, f: (p / "log.csv").write_text('{"t": 0}\n' * 9 + '{"t": ' + "[" * 999 + "\n"), [],
         "line 10: is not JSON: nested deeper than 100 levels"),
        (lambda p, f: f.replace({"q3": {f.q3[40]: np.inf}}).to_csv(p / "log.csv", index=False), [],
         "line 42: q3 is infinite; allowed: a finite number"),
        (lambda p, f: f[:200].to_csv(p / "log.csv", index=False), [], "the log lasts 1.59 s"),
        (lambda p, f: [(p / "log.csv").mkdir(), *((p / "log.csv" / str(k)).touch() for k in range(1000))], [],
         "a folder of 1,000 files is not a log"),
        (lambda p, f: f.to_csv(p / "log.csv", index=False), ["--tip", "tool0"], "--tip: is for robot files"),
        (lambda p, f: f.to_csv(p / "log.csv", index=False), ["--name", "x"], "--name: is for robot files"),
        (lambda p, f: f.to_csv(p / "log.csv", index=False), ["--package-path", "x"], "--package-path: is for robot"),
        (lambda p, f: f.to_csv(p / "log.csv", index=False), ["--format", "html"], "--format: is for robot files"),
        (lambda p, f: f.to_csv(p / "log.csv", index=False), ["--topic", "/a"], "topic: is for ROS bags"),
        (lambda p, f: f.to_csv(p / "log.csv", index=False), ["--episode", "1"], "episode: is for logs with the"),
        (lambda p, f: doubled(f).to_csv(p / "log.csv", index=False), [], "two arms"),
    ],
)  # fmt: skip
def test_bad_input_is_one_sentence_and_nothing_is_written(cli, tmp_path, arm, signals, make, options, wanted):
    make(tmp_path, made.frame(signals, made.PLAIN, 1))
    ending = cli("doctor", tmp_path / "log.csv", "--robot", "ur5e", "-o", tmp_path / "out", *options)
    assert ending.code == 2
    assert wanted in ending.err
    assert len(ending.err.strip().splitlines()) == 1
    assert not (tmp_path / "out").exists()


def test_options_of_logs_are_refused_for_robots(cli):
    for option in ("--robot", "--topic", "--columns"):
        ending = cli("doctor", examples_dir().parent / "robots" / "macro.urdf", option, "x")
        assert ending.code == 2


def test_without_a_robot_columns_are_listed(cli, tmp_path, signals):
    path = csv(tmp_path, made.frame(signals, made.RTDE))
    ending = cli("doctor", path)
    assert ending.code == 0
    assert "written by UR's RTDE client" in ending.out
    assert cli("doctor", path, "-o", tmp_path / "out").code == 2


def test_two_arms_by_their_names_are_refused(tmp_path, arm, signals):
    table = made.frame(signals, {"t": "t", "q": "left_{}.pos"})
    names = {f"left_{k}.pos": f"left_{joint}.pos" for k, joint in enumerate(arm.joint_names)}
    both = table.rename(columns=names)
    both = both.assign(**{c.replace("left", "right"): both[c] for c in both.columns if c != "t"})
    with pytest.raises(RunnerError, match="holds two arms"):
        examine_log(csv(tmp_path, both), arm)
