"""`runner identify`: dry run, result, report and Python, and logs that do not fit."""

import json
import re
import shutil
from dataclasses import fields, replace

import numpy as np
import pytest
import yaml
from support.identified_logs import KnownArm, write_log

import runner
from runner.identification.result import open_identification
from runner.identification.words import answer_lines, method_lines
from runner.recordings.columns_map import FixedPayload
from runner.reporting.identification_report import identification_document, parameters
from runner.reporting.mathml import faulty
from runner.reporting.stored import compose_report


@pytest.fixture(scope="module")
def arm():
    return KnownArm("macro")


@pytest.fixture(scope="module")
def log(arm):
    t, q, dq, ddq, tau = arm.log(16.0)
    return t, q, dq, ddq, tau + 0.05 * np.random.default_rng(0).normal(size=tau.shape)


@pytest.fixture(scope="module")
def made(arm, log, tmp_path_factory):
    """A log, its column map, and the identification by it, made once."""
    folder = tmp_path_factory.mktemp("identify")
    path, columns = write_log(folder, arm.model, log, warmth="cold")
    found = runner.identify(path, columns=columns, robot="macro", friction="coulomb", outputs=folder / "outputs")
    return path, columns, found


def test_a_dry_run_says_what_the_log_can_determine_and_stores_nothing(made, cli, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    path, columns, _ = made
    ending = cli("identify", path, "--columns", columns, "--robot", "macro", "--dry-run")
    assert ending.code == 0
    assert re.search(
        r"^25 of 25 parameters can be told apart: 16 sums of masses, inertias and rotor inertias", ending.out
    )
    assert "near standstill" in ending.out
    assert "motor side, instant" in ending.out
    assert not list(tmp_path.iterdir())


@pytest.mark.costs(6)
def test_the_command_answers_first_and_ends_with_the_folder(made, cli, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    path, columns, _ = made
    ending = cli("identify", path, "--columns", columns, "--robot", "macro", "--cutoff", "10")
    assert ending.code == 0, ending.err
    lines = ending.out.splitlines()
    assert any(line.startswith("Torques that the fit has not seen are predicted to") for line in lines)
    folder = tmp_path / lines[-1]
    found = open_identification(folder)
    assert (len(found.parameters), found.frequency, found.logs[0].warmth) == (25, 10.0, "cold")
    assert [one.kind for one in found.alternatives] == ["coulomb", "sigmoid", "load", "stribeck"]
    assert sum(one.chosen for one in found.alternatives) == 1
    listed = cli("results")
    assert "identification" in listed.out
    assert cli("verify").code == 0
    assert cli("report", "latest", "--format", "html").code == 0


def test_values_lie_in_their_intervals_and_the_answer_names_the_open_questions(made, arm):
    found = made[2]
    frame = found.to_frame()
    truth = dict(zip([each.name for each in arm.sums], arm.base, strict=True))
    inside = [abs(frame.value[name] - value) <= frame.half[name] for name, value in truth.items()]
    assert np.mean(inside) > 0.8
    assert (frame.white <= 1.5 * frame.half).all()
    text = " ".join(found.sentences)
    assert "One log knows nothing of what differs between logs: temperature first" in text
    assert "friction of a warm one is not known" in text
    assert found.held_out < 0.05 < found.file
    assert runner.open_identification(found.folder) == found
    assert str(found.folder) in repr(found)
    assert "<p>" in found._repr_html_()


@pytest.mark.costs(3)
def test_a_prior_is_asked_for_and_its_share_is_shown(made, cli, tmp_path):
    path, columns, plain = made
    found = runner.identify(
        path, columns=columns, robot="macro", friction="coulomb", cutoff=10.0, prior=0.3, outputs=tmp_path
    )
    inertial = [one for one in found.parameters if one.file is not None]
    assert len(inertial) == 16
    assert all(0.0 <= one.prior_share <= 1.0 for one in inertial)
    assert "combined with those of the robot's file, 30 % wide, as asked for" in " ".join(found.sentences)
    assert found.command.endswith("--prior 30%")
    assert "from the file (%)" in str(parameters(found).header)
    assert all(one.prior_share is None for one in plain.parameters)
    assert "from the file (%)" not in str(parameters(plain).header)
    for width in ("30", "0%", "101%", "-1%", "x%"):
        ending = cli("identify", path, "--columns", columns, "--robot", "macro", f"--prior={width}")
        assert ending.code == 2, width
        assert "Allowed: above 0% up to 100%, such as 30%." in ending.err
    with pytest.raises(runner.RunnerError, match="prior: not a share"):
        runner.identify(path, columns=columns, robot="macro", prior=30.0)


def test_the_answer_says_whether_bodies_have_the_values(made):
    assert any("bodies with positive masses and inertias" in line.lower() for line in made[2].sentences)
    document, _ = compose_report([made[2].folder])
    assert document.dated == "Identified"


def test_the_report_has_no_fault_and_names_the_second_method(made):
    document, _ = compose_report([made[2].folder])
    assert faulty(document) == []
    titles = [section.title for section in document.sections]
    assert titles[:3] == ["Unseen torque", "Parameters", "What speaks against it"]
    assert "Second method" in titles


def test_a_damaged_result_is_told(made, tmp_path):
    folder = tmp_path / "outputs" / "identifications" / made[2].folder.name
    shutil.copytree(made[2].folder, folder)
    path = folder / "identification.json"
    content = json.loads(path.read_text())
    path.write_text(path.read_text().replace('"macro"', '"mini"', 1))
    with pytest.raises(runner.RunnerError, match="damaged"):
        runner.open_identification(folder)
    assert content["robot"] == "macro"


def test_sensors_behind_the_gears_leave_rotors_out(arm, tmp_path, cli):
    stiff = KnownArm("macro", rotors=False)
    path, columns = write_log(tmp_path, arm.model, stiff.log(), side="link")
    ending = cli("identify", path, "--columns", columns, "--robot", "macro", "--dry-run")
    assert ending.out.startswith("24 of 24 parameters")
    assert "rotor inertias and the friction of the gears are not in these torques" in ending.out


def test_a_joint_that_does_not_move_is_named_with_a_motion(arm, tmp_path, cli):
    path, columns = write_log(tmp_path, arm.model, arm.log(moves=[1.0, 1.0, 0.0]))
    ending = cli("identify", path, "--columns", columns, "--robot", "macro", "--dry-run")
    assert ending.code == 0
    assert "q3 does not move" in ending.out
    assert re.search(r"not determined: viscous of q3 .* move q3 in both directions", ending.out)


def test_a_clipped_torque_is_left_out_with_its_reason(arm, log, tmp_path, cli):
    tau = log[-1].copy()
    tau[:, 1] = np.clip(tau[:, 1], *(0.5 * np.array([tau[:, 1].min(), tau[:, 1].max()])))
    path, columns = write_log(tmp_path, arm.model, (*log[:-1], tau))
    ending = cli("identify", path, "--columns", columns, "--robot", "macro", "--dry-run")
    assert "the torque of q2 is left out: its torque is clipped" in ending.out


def test_a_current_says_what_scales_with_its_constant(arm, log, tmp_path, cli):
    path, columns = write_log(tmp_path, arm.model, log)
    said = yaml.safe_load(columns.read_text())
    said["columns"]["torque_q1"] |= {"unit": "A", "constant": 1.0}
    columns.write_text(yaml.safe_dump(said))
    ending = cli("identify", path, "--columns", columns, "--robot", "macro", "--dry-run")
    assert "torques of q1: currents times a constant, with which all parameters scale" in ending.out
    del said["columns"]["torque_q1"]["constant"]
    columns.write_text(yaml.safe_dump(said))
    ending = cli("identify", path, "--columns", columns, "--robot", "macro")
    assert ending.code == 2
    assert "all masses and friction scale with it" in ending.err


@pytest.mark.costs(4)
def test_two_known_payloads_determine_the_constants_of_currents(cli, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    loaded, logs, maps = KnownArm("macro"), [], []
    for number, payload in enumerate((None, {"mass": 2.0})):
        loaded.carried = None if payload is None else FixedPayload(**payload)
        t, q, dq, ddq, tau = loaded.log(16.0, first=20.0 * number)
        currents = (tau + 0.05 * np.random.default_rng(number).normal(size=tau.shape)) / 40.0
        path, columns = write_log(tmp_path, loaded.model, (t, q, dq, ddq, currents), f"{number}.csv")
        said = yaml.safe_load(columns.read_text())
        for name in ("torque_q1", "torque_q2", "torque_q3"):
            said["columns"][name] |= {"unit": "A", "constant": 30.0}
        columns.write_text(yaml.safe_dump(said | ({} if payload is None else {"payload": payload})))
        logs.append(path)
        maps.append(columns)
    options = ["--robot", "macro", "--friction", "coulomb", "--cutoff", "10"]
    words = ["identify", *logs, "--columns", maps[0], "--columns", maps[1], *options]
    dry = cli(*words, "--dry-run").out
    assert "torques of q1, q2, q3: currents times a constant, which the known payloads determine" in dry
    assert "it carries 2 kg" in dry
    ending = cli(*words)
    assert "Torque constants in N m/A from the known payloads: q1 " in ending.out
    assert "(map: 30)" in ending.out
    assert "scales with it" not in ending.out
    found = runner.open_identification(tmp_path / ending.out.splitlines()[-1])
    values = [one for one in found.parameters if one.unit == "N m/A"]
    assert [one.name for one in values] == [f"torque constant of q{joint}" for joint in (1, 2, 3)]
    for one in values:
        assert abs(one.value - 40.0) < min(2.0 * one.half, 1.0)
    assert "value of a torque constant is that in the column map" in parameters(found).caption
    frame = found.to_frame()
    truth = dict(zip([each.name for each in loaded.sums], loaded.base, strict=True))
    assert np.mean([abs(frame.value[name] - value) <= frame.half[name] for name, value in truth.items()]) > 0.8
    with_prior = runner.identify(*logs, columns=maps, robot="macro", friction="coulomb", cutoff=10.0, prior=0.3)
    assert [one.value for one in with_prior.parameters if one.unit == "N m/A"] == pytest.approx(3 * [40.0], rel=0.02)
    other = yaml.safe_load(maps[0].read_text())
    other["columns"]["torque_q1"]["constant"] = 31.0
    maps[0].write_text(yaml.safe_dump(other))
    ending = cli(*words)
    assert ending.code == 2
    assert "the maps differ in constant" in ending.err


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"holds": "without_gravity"}, "leaves no masses to identify"),
        ({"joint": "q9"}, "both hold the position of q9"),
    ],
)
def test_a_map_that_does_not_fit_is_one_sentence(arm, log, tmp_path, cli, change, words):
    path, columns = write_log(tmp_path, arm.model, log)
    said = yaml.safe_load(columns.read_text())
    for name, column in said["columns"].items():
        if name.startswith("torque") == ("holds" in change):
            column.update(change)
    columns.write_text(yaml.safe_dump(said))
    ending = cli("identify", path, "--columns", columns, "--robot", "macro")
    assert ending.code == 2
    assert words in ending.err
    assert len(ending.err.strip().splitlines()) == 1


def test_logs_that_do_not_fit_are_one_sentence(arm, log, tmp_path, cli):
    path, columns = write_log(tmp_path, arm.model, log)
    words = ["--columns", columns, "--robot", "macro"]
    short = write_log(tmp_path, arm.model, [part[:400] for part in log], "short.csv")[0]
    for given, message in (
        ((path, path, *words), "one is given twice"),
        ((path, short, short, *words, "--columns", columns), "one for all, or one for each"),
        ((short, *words), "Needed: 2 s or more"),
        ((tmp_path / "none.csv", *words), "none.csv"),
        ((path, *words, "--cutoff", "200"), "--cutoff: 200 Hz does not fit"),
    ):
        ending = cli("identify", *given)
        assert ending.code == 2, given
        assert message in ending.err
    with pytest.raises(runner.RunnerError, match="Did you mean 'load'"):
        runner.identify(path, columns=columns, robot="macro", friction="lood")
    with pytest.raises(runner.RunnerError, match="none is given"):
        runner.identify(columns=columns, robot="macro")


@pytest.mark.parametrize("more", [("--dry-run",), ()])
def test_an_arm_that_stands_still_is_refused_before_anything_is_stored(arm, log, tmp_path, cli, more):
    noise = np.random.default_rng(2).normal(0.0, 1.0, (2, *log[1].shape))
    rest = np.full((1, 3), 0.3)
    held = arm.torques(rest, 0.0 * rest, 0.0 * rest)
    still = (log[0], rest + 2e-4 * noise[0], 0.0 * log[2], 0.0 * log[3], held + 0.05 * noise[1])
    path, columns = write_log(tmp_path, arm.model, still)
    ending = cli("identify", path, "--columns", columns, "--robot", "macro", *more)
    assert (ending.code, ending.out) == (2, "")
    assert "the arm stands still: no joint moves" in ending.err
    assert not (tmp_path / "outputs").exists()


@pytest.mark.parametrize("more", [("--dry-run",), ()])
def test_too_few_rows_in_the_fit_are_refused_before_anything_is_stored(arm, tmp_path, cli, more):
    t = np.arange(0.0, 4.0, 0.004)
    share = np.clip((t - 2.0) / 0.2, 0.0, 1.0)[:, None]
    q = 0.3 + 0.2 * share**3 * (10.0 - 15.0 * share + 6.0 * share**2) * np.ones(3)
    dq = np.gradient(q, t, axis=0)
    ddq = np.gradient(dq, t, axis=0)
    path, columns = write_log(tmp_path, arm.model, (t, q, dq, ddq, arm.torques(q, dq, ddq)))
    ending = cli("identify", path, "--columns", columns, "--robot", "macro", *more)
    assert (ending.code, ending.out) == (2, "")
    assert re.search(
        r"too few rows are in the fit: \d+ of \d+, .* Needed: more than \d+, at different times", ending.err
    )
    assert not (tmp_path / "outputs").exists()


def test_a_jump_of_a_joint_is_refused(arm, log, tmp_path, cli):
    q = log[1].copy()
    q[2000, 1] += 1.5
    path, columns = write_log(tmp_path, arm.model, (log[0], q, *log[2:]))
    ending = cli("identify", path, "--columns", columns, "--robot", "macro", "--dry-run")
    assert ending.code == 2
    assert "joint_q2 jumps by" in ending.err
    assert "rad within 4 ms at 8 s after the first row. Correct or cut that row." in ending.err


def test_a_delay_that_the_logs_do_not_tell_is_stored_and_said(made, tmp_path):
    found = replace(made[2], folder=tmp_path / "identifications" / "a", delay=0.0, delay_half=None)
    found.write()
    assert open_identification(found.folder).delay_half is None
    text = " ".join(method_lines(found))
    assert "The logs do not determine the delay of the torques. Residuals" in text
    assert "(not known how exactly)" in " ".join(method_lines(replace(found, delay=0.001)))


def fields_with_numbers(thing):
    return [each.name for each in fields(thing) if isinstance(getattr(thing, each.name), float)]


@pytest.mark.parametrize("number", [np.nan, np.inf, -np.inf])
def test_every_result_that_is_written_can_be_read(made, tmp_path, number):
    """Each number that is not finite is either refused with its name, or read again."""
    whole = replace(made[2], folder=tmp_path / "identifications" / "a")
    spoilt = {name: replace(whole, **{name: number}) for name in fields_with_numbers(whole)}
    for part in ("parameters", "joints", "alternatives", "logs"):
        first, *rest = getattr(whole, part)
        for name in fields_with_numbers(first):
            spoilt[f"{part}.0.{name}"] = replace(whole, **{part: [replace(first, **{name: number}), *rest]})
    readable = {"delay_half", "parameters.0.file"}
    assert readable < spoilt.keys()
    assert len(spoilt) > 20
    for name in spoilt.keys() - readable:
        with pytest.raises(runner.RunnerError, match=f"identification: {name}: "):
            spoilt[name].write()
        assert not whole.folder.exists()
    for name in readable:
        spoilt[name].write()
        assert open_identification(whole.folder).robot == "macro"


def test_no_parameter_is_said_in_words(made):
    assert "The logs determine no parameter." in list(answer_lines(replace(made[2], parameters=[])))


def test_joints_in_another_order_are_asked_for(arm, log, tmp_path, cli):
    path, columns = write_log(tmp_path, arm.model, log)
    said = yaml.safe_load(columns.read_text())
    said["columns"]["joint_q2"]["joint"], said["columns"]["joint_q3"]["joint"] = "q3", "q2"
    columns.write_text(yaml.safe_dump(said))
    ending = cli("identify", path, "--columns", columns, "--robot", "macro")
    assert ending.code == 2
    assert "exchanged" in ending.err


def test_a_section_of_a_plug_in_is_before_the_method(made, own_section):
    own_section("identification", "subject.robot")
    *_, own, _ = identification_document(made[2]).sections
    assert own.blocks[0].text == "macro"
