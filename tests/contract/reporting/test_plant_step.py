"""Sentences on the plant and the error of its integration step."""

import pytest

from runner.base.engines import has_pybullet
from runner.reporting.plant_step import describe_plant, percent
from runner.reporting.run_report import run_document
from runner.reporting.words import PLANT
from runner.sweeps.job import run

KIND = "bullet" if has_pybullet() else "mujoco"
CASE = ("robot=macro", "trajectory=quintic", "trajectory.duration=1", "duration=1.5", f"plant={KIND}")


@pytest.fixture(scope="module")
def outputs(tmp_path_factory):
    return f"outputs={tmp_path_factory.mktemp('outputs')}"


@pytest.fixture(scope="module")
def compared(outputs):
    return run(*CASE, "plant_error=true", outputs)


def test_what_the_step_is_worth_is_told_of_the_metrics_of_the_task(compared):
    share = compared.plant_error["metrics"]["max_tracking_error"]["share"]
    text = describe_plant(compared)
    assert text.startswith(
        f"{PLANT[KIND]} is the plant, in steps of 1 ms. The integration step contributes {percent(share)} of the "
    )
    assert f"{percent(share)} of the largest tracking error and " in text


def test_metrics_may_be_asked_for(compared):
    share = compared.plant_error["metrics"]["rms_tracking_error"]["share"]
    assert describe_plant(compared, ["rms_tracking_error"]).endswith(
        f"The integration step contributes {percent(share)} of the rms tracking error."
    )


def test_motions_that_part_are_not_compared(outputs):
    text = describe_plant(run("experiment=thesis/figure_3_5", "repetitions=1", f"plant={KIND}", outputs))
    assert "goes another way from" in text
    assert text.endswith("Their metrics are not comparable.")


def test_what_was_not_asked_for_is_told_with_the_way_to_it(outputs):
    text = describe_plant(run(*CASE, outputs))
    assert text.endswith("The error of the integration step was not measured: plant_error=true measures it.")


def test_of_runge_kutta_there_is_nothing_to_tell(outputs):
    text = describe_plant(run("robot=mini", "duration=0.01", "plant=rk4", outputs))
    assert text == "Runge-Kutta is the plant, in steps of 1 ms."


def test_the_report_of_a_run_has_a_column_for_it(compared, outputs):
    def head(stored):
        document = run_document(stored)
        (table,) = [
            block
            for section in document.sections
            for block in section.blocks
            if getattr(block, "caption", "").startswith("Metrics of")
        ]
        return table.lines[0][-1], {row[1]: row[-1] for row in table.rows}

    name, cells = head(compared)
    assert name == "the plant's step"
    assert cells["max_tracking_error"] == percent(compared.plant_error["metrics"]["max_tracking_error"]["share"])
    assert head(run(*CASE, outputs))[0] == "largest"


@pytest.mark.parametrize(
    ("share", "text"), [(0.366, "37 %"), (0.0031, "0.31 %"), (0.0, "less than 0.01 %"), (1.5, "150 %")]
)
def test_shares_are_written_in_two_digits(share, text):
    assert percent(share) == text


@pytest.mark.parametrize("side", ["motor", "link"])
def test_flexible_joints_are_told_with_the_side_of_their_encoders(outputs, side):
    soft = ("robot=macro", "plant=rk4_flexible", f"plant.flexible_joints.encoders={side}", "duration=0.05")
    expected = f"Runge-Kutta is the plant, in steps of 10 ms. Joints are flexible, with encoders at the {side}s."
    assert describe_plant(run(*soft, outputs)) == expected


def test_links_that_bend_are_told_and_that_pictures_show_them_straight(outputs):
    soft = ("robot=macro", "plant=rk4_flexible_links", "plant.links.link2=null", "trajectory=quintic", "duration=0.05")
    expected = (
        "Runge-Kutta with bending links is the plant, in steps of 1 ms. Links bend (link3); pictures show the arm with "
        "straight ones, and the tip where it is."
    )
    assert describe_plant(run(*soft, outputs)) == expected
