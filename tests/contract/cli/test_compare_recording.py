"""`runner compare RUN recording.csv --columns map.yaml`, on the example that comes with the package."""

import re
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import runner
from runner.base.paths import examples_dir
from runner.recordings.compare import compare_recording
from runner.reporting.mathml import faulty
from runner.reporting.recording_report import recording_document, report_folder
from runner.reporting.render import render_html
from runner.sweeps.job import run

HERE = examples_dir() / "recording"
VISCOUS, COULOMB = (1.2, 0.8, 0.5), (1.5, 1.0, 0.6)  # of the arm in make_recording.py


@pytest.fixture(scope="module")
def swing(tmp_path_factory):
    outputs = tmp_path_factory.mktemp("swing")
    return run("experiment=swing", f"outputs={outputs}", config_dirs=[HERE])


@pytest.fixture(scope="module")
def found(swing):
    return compare_recording(swing, HERE / "recording.csv", HERE / "columns.yaml")


def test_the_recording_is_made_by_its_script(tmp_path, monkeypatch):
    monkeypatch.setattr(sys, "path", [*sys.path, str(HERE)])
    import make_recording

    rows = make_recording.record(HERE, tmp_path)
    make_recording.write(tmp_path / "recording.csv", rows)
    lines, stored = ((path / "recording.csv").read_text().splitlines() for path in (tmp_path, HERE))
    assert lines[0] == stored[0]
    values, kept = (np.loadtxt(each[1:], delimiter=",") for each in (lines, stored))
    assert np.abs(values - kept).max(axis=0) == pytest.approx(0.0, abs=1.01e-4)  # a unit of the last digit


def test_the_offset_is_found_within_a_sample_and_the_friction_within_five_percent(found):
    from_script = re.search(r"^START = ([\d.]+)", (HERE / "make_recording.py").read_text(), re.M)
    assert found.offset.start == pytest.approx(float(from_script[1]), abs=found.recording.period)
    assert found.friction.lacking == []
    assert [joint.viscous for joint in found.friction.joints] == pytest.approx(VISCOUS, rel=0.05)
    assert [joint.coulomb for joint in found.friction.joints] == pytest.approx(COULOMB, rel=0.05)


@pytest.mark.bullet
def test_the_report_is_as_recorded(found, as_recorded):
    as_recorded("reports", "recording", recording_document(found))


def test_the_report_is_whole(found):
    assert faulty(recording_document(found)) == []


def test_what_is_printed_and_written(cli, swing):
    ending = cli("compare", swing.folder, HERE / "recording.csv", "--columns", HERE / "columns.yaml")
    assert ending.code == 0
    assert "the run's time 0 is 0.73" in ending.out
    assert re.search(r"^q1 +Coulomb +N m +1\.[45]\d+ ", ending.out, re.M)
    assert re.search(r"^max_tracking_error +m ", ending.out, re.M)
    assert {"report.html", "report.pdf"} == {path.name for path in ending.folder.iterdir()}
    assert ending.folder.parent == swing.folder.parent.parent / "reports"


def test_names_in_a_recording_cannot_become_markup(swing, tmp_path):
    text = (HERE / "recording.csv").read_text()
    name = "<script>alert(1)</script>$x$"
    (tmp_path / "a.csv").write_text(text.replace("elbow,", f"{name},", 1))
    said = (HERE / "columns.yaml").read_text().replace("elbow:", f"{name!r}:")
    (tmp_path / "map.yaml").write_text(said)
    page = render_html(recording_document(compare_recording(swing, tmp_path / "a.csv", tmp_path / "map.yaml")))
    assert "alert(1)" in page
    assert "<script>alert" not in page


@pytest.mark.parametrize(
    ("arguments", "wanted"),
    [
        (["RUN", "recording.csv"], "recording.csv: add --columns FILE"),
        (["RUN", "--columns", "columns.yaml"], "recordings: not one run and one recording"),
        (["RUN", "RUN", "recording.csv", "--columns", "columns.yaml"], "recordings: not one run and one recording"),
        (["recording.csv", "--columns", "columns.yaml"], "recordings: not one run and one recording"),
        (["RUN", "recording.csv", "--columns", "columns.yaml", "--metrics", "energy"], "not for recordings"),
        (
            ["RUN", "recording.csv", "--columns", "columns.yaml", "--fill-gaps", "20"],
            "Allowed: a time above 0, such as 20ms.",
        ),
        (["RUN", "RUN", "--fill-gaps", "20ms"], "recordings: not one run and one recording"),
        (["RUN", "none.csv", "--columns", "columns.yaml"], "cannot read none.csv"),
        (["RUN", "recording.csv", "--columns", "none.yaml"], "cannot read none.yaml"),
    ],
)
def test_arguments_that_do_not_fit(cli, swing, monkeypatch, arguments, wanted):
    monkeypatch.chdir(HERE)
    ending = cli("compare", *(str(swing.folder) if word == "RUN" else word for word in arguments))
    assert ending.code == 2
    assert wanted in ending.err


def test_a_copied_run_has_its_report_in_the_working_folder(found, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    copied = replace(found, run=replace(found.run, folder=tmp_path / "copy"))
    assert report_folder(copied).parent == Path("outputs/reports")


def test_from_python(found, swing):
    again = runner.open_run(swing.folder).compare_recording(HERE / "recording.csv", HERE / "columns.yaml")
    assert again.offset.start == found.offset.start
    assert again.metrics == found.metrics
    with pytest.raises(runner.RunnerError, match=r"cannot read none.csv"):
        runner.open_run(swing.folder).compare_recording("none.csv", HERE / "columns.yaml")


def write_log(path, commands=True):
    """Write a log of a Macro with friction that moves twice from rest to rest; its clock starts at 5 s."""
    pause, step = np.zeros(150), 0.004
    share = np.arange(0.0, 1.0, step / 0.8)
    blend = 10.0 * share**3 - 15.0 * share**4 + 6.0 * share**5
    way = np.concatenate([pause, blend, 1.0 + pause, 1.0 - 0.5 * blend, 0.5 + pause])
    rows = np.array([0.3, 0.6, 0.8]) + way[:, None] * np.array([0.5, -0.4, 0.3])
    t = step * np.arange(len(rows))
    np.savetxt(path.with_name("ref.csv"), np.column_stack([t, rows]), delimiter=",", header="t,q1,q2,q3", comments="")
    arm = run(
        "robot=macro", "controller=computed_torque", "plant=rk4", "trajectory=from_file", "plant.friction.viscous=2",
        f"trajectory.file={path.with_name('ref.csv')}", f"outputs={path.with_name('arm')}",
    )  # fmt: skip
    trace = arm.trace()
    columns = {"timestamp": trace["t"] + 5.0}
    for place, joint in enumerate(("q1", "q2", "q3")):
        columns |= {f"actual_q_{place}": trace[joint], f"actual_current_as_torque_{place}": trace[f"tau{place + 1}"]}
        if commands:
            columns[f"target_q_{place}"] = np.interp(trace["t"], t, rows[:, place])
    table = np.column_stack([np.asarray(values) for values in columns.values()])
    np.savetxt(path, table, delimiter=",", header=",".join(columns), comments="")
    return arm


@pytest.mark.costs(8)
def test_a_log_is_replayed_and_cut_into_motions(cli, tmp_path):
    write_log(tmp_path / "log.csv")
    ending = cli("compare", "log.csv", "--robot", "macro")
    assert ending.code == 0
    first, *_ = ending.out.splitlines()
    assert re.match(
        r"Over [\d.]+ s, on 2 motions, the model predicts positions within .* and torques to .* % of", first
    )
    assert "Accuracy in each motion, from rest to rest." in ending.out
    assert ending.folder.parent.name == "reports"
    (made,) = (tmp_path / "outputs" / "runs").iterdir()
    written = (made / "metrics.json").stat().st_mtime_ns
    again = cli("compare", "log.csv", "--robot", "macro")
    assert again.out == ending.out
    assert (made / "metrics.json").stat().st_mtime_ns == written
    stored = runner.open_run(made)
    assert stored.config["plant"]["kind"] == "rk4"
    assert stored.config["controller"]["kind"] == "computed_torque"
    (files,) = (tmp_path / "outputs" / "logs").iterdir()
    assert sorted(path.name for path in files.iterdir()) == ["columns.yaml", "motion.csv"]


@pytest.mark.costs(4)
def test_a_log_without_commands_follows_its_measured_positions_and_says_so(cli, tmp_path):
    write_log(tmp_path / "log.csv", commands=False)
    ending = cli("compare", "log.csv", "--robot", "macro", "--controller", "joint_pd")
    assert ending.code == 0
    first, *_ = ending.out.splitlines()
    assert re.match(r"Over [\d.]+ s, on 2 motions, the model predicts torques to ", first)
    assert "the accuracy of positions, because the run follows the measured ones" in ending.out
    (made,) = (tmp_path / "outputs" / "runs").iterdir()
    assert runner.open_run(made).config["controller"]["kind"] == "joint_pd"


@pytest.mark.costs(4)
def test_the_payload_of_a_log_is_that_of_its_run(cli, tmp_path):
    write_log(tmp_path / "log.csv")
    cli("doctor", "log.csv", "--robot", "macro", "-o", "mine")
    columns = tmp_path / "mine" / "columns.yaml"
    columns.write_text(columns.read_text() + "\npayload: {mass: 0.5, position: [0.0, 0.0, 0.1]}\n")
    ending = cli("compare", "log.csv", "--robot", "macro", "--columns", columns)
    assert ending.code == 0
    (made,) = (tmp_path / "outputs" / "runs").iterdir()
    carried = runner.open_run(made).config["robot"]["payload"]
    assert (carried["mass"], carried["position"]) == (0.5, [0.0, 0.0, 0.1])
    columns.write_text(columns.read_text().replace("mass: 0.5", "mass: 0.6"))
    ending = cli("compare", made, "log.csv", "--columns", columns)
    assert ending.code == 2
    assert "the arm carried 0.6 kg at [0.0, 0.0, 0.1], in the run 0.5 kg" in ending.err
    assert "Make the run with robot.payload.mass=0.6 robot.payload.position=[0.0,0.0,0.1]." in ending.err


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (("lab.csv", "--controller", "joint_pd"), "--controller: no run is made without --robot."),
        (("lab.csv", "lab.csv", "--robot", "macro"), "--robot: not one log."),
        (("lab.csv", "--robot", "makro"), "did you mean macro?"),
        (("lab.csv", "--robot", "macro"), "columns: no column's name tells a position of q1, q2, q3"),
        (("lab.csv", "--robot", "macro", "--by", "controller"), "not for recordings."),
    ],
)
def test_bad_replays_end_with_one_sentence(cli, tmp_path, words, told):
    (tmp_path / "lab.csv").write_bytes((HERE / "recording.csv").read_bytes())
    ending = cli("compare", *words)
    assert ending.code == 2
    assert told in ending.err
    assert not (tmp_path / "outputs").exists()


@pytest.mark.costs(8)
def test_a_replay_fills_gaps_only_if_asked_and_rejects_jumps(cli, tmp_path):
    write_log(tmp_path / "log.csv")
    header, *lines = (tmp_path / "log.csv").read_text().splitlines()
    period = float(lines[1].split(",")[0]) - float(lines[0].split(",")[0])
    cut, half = round(0.06 / period), len(lines) // 2
    gap = [header, *lines[:half], *lines[half + cut :]]
    (tmp_path / "gap.csv").write_text("\n".join(gap) + "\n")
    cells = lines[half].split(",")
    cells[header.split(",").index("actual_q_1")] = "3.0"
    (tmp_path / "jump.csv").write_text("\n".join([header, *lines[:half], ",".join(cells), *lines[half + 1 :]]) + "\n")
    for words, told in (
        (
            ("gap.csv",),
            r"rows are missing for 0\.07 s, where rows are 0\.01 s apart; `--fill-gaps 70ms` fills",
        ),
        (("gap.csv", "--fill-gaps", "20ms"), r"rows are missing for 0\.07 s"),
        (("gap.csv", "--fill-gaps", "5s"), r"gaps of up to 0\.1 s can be filled; found 5 s"),
        (("jump.csv",), r"jump\.csv: log: actual_q_1 jumps by .* rad within .* Correct or cut that row\."),
    ):
        ending = cli("compare", *words, "--robot", "macro")
        assert ending.code == 2
        assert re.search(told, ending.err)
        assert not (tmp_path / "outputs").exists()
    ending = cli("compare", "gap.csv", "--robot", "macro", "--fill-gaps", "80ms")
    assert ending.code == 0
    assert "; 1 gap of up to 70 ms is filled" in ending.out


@pytest.mark.costs(3)
def test_a_log_of_positions_alone_is_not_replayed(cli, tmp_path):
    write_log(tmp_path / "log.csv", commands=False)
    header, *lines = (tmp_path / "log.csv").read_text().splitlines()
    kept = [place for place, name in enumerate(header.split(",")) if "current" not in name]
    rows = [",".join(line.split(",")[place] for place in kept) for line in (header, *lines)]
    (tmp_path / "log.csv").write_text("\n".join(rows) + "\n")
    ending = cli("compare", "log.csv", "--robot", "macro")
    assert ending.code == 2
    assert "has neither commanded positions nor torques, so that a replay says nothing" in ending.err
    assert not (tmp_path / "outputs").exists()


def test_a_section_of_a_plug_in_is_before_the_provenance(found, own_section):
    own_section("recording", "f'{len(subject.residuals)} residuals'")
    *_, own, _ = recording_document(found).sections
    assert own.blocks[0].text == f"{len(found.residuals)} residuals"
