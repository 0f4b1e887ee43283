import numpy as np
import pytest

from runner.execution import run
from runner.quantities import quantity
from runner.reporting import plant_agreement
from runner.reporting.figures import columns
from runner.reporting.plant_agreement import describe_agreement, disagreement, find_twin
from runner.reporting.words import PLANT

CASE = ("robot=macro", "trajectory=quintic", "trajectory.duration=1", "duration=0.5", "noise=thesis")


@pytest.fixture(scope="module")
def outputs(tmp_path_factory):
    return f"outputs={tmp_path_factory.mktemp('outputs')}"


@pytest.fixture(scope="module")
def pair(outputs):
    return run(*CASE, "repetitions=3", outputs), run(*CASE, "plant=rk4", outputs)


def test_disagreement_is_the_distance_of_the_tips(pair):
    distance = np.linalg.norm(columns(pair[0].trace, "tip") - columns(pair[1].trace, "tip"), axis=1)
    apart = disagreement(*pair)
    assert apart.tip == distance.max()
    assert apart.final == distance[-1]
    assert 0.0 < apart.tip < 0.01


def test_disagreement_is_symmetric_and_zero_with_itself(pair):
    assert disagreement(*pair) == disagreement(*reversed(pair))
    assert disagreement(pair[0], pair[0]).tip == 0.0


def test_disagreement_ends_with_the_shorter_run(pair, outputs):
    short = run(*CASE[:3], "duration=0.2", "noise=thesis", "plant=rk4", outputs)
    assert len(short.trace) < len(pair[0].trace)
    assert disagreement(pair[0], short).tip <= disagreement(*pair).tip


def test_the_twin_is_found_by_its_content_with_one_repetition(pair):
    bullet, rk4 = pair
    assert find_twin(bullet).hash == rk4.hash
    assert find_twin(rk4) is None  # its bullet twin has three repetitions, not one


def test_the_agreement_is_told_with_plant_and_step(pair):
    text, plant = describe_agreement(pair[0]), PLANT[pair[0].config["plant"]["kind"]]
    assert text.startswith(
        f"{plant} is the plant, in steps of 1 ms. With Runge-Kutta in its place and the same noise the tip"
    )
    assert f"at most {quantity(disagreement(*pair).tip, 'm', 2)} away at equal times" in text


def test_the_same_noise_is_spoken_of_where_there_is_some(outputs):
    case = ("robot=macro", "duration=0.05")
    quiet = run(*case, outputs)
    run(*case, "plant=rk4", outputs)
    text = describe_agreement(quiet)
    assert "With Runge-Kutta in its place the tip is at most" in text
    assert "noise" not in text


@pytest.mark.parametrize("there", [True, False])
def test_a_missing_twin_is_told_with_the_way_to_it(outputs, monkeypatch, there):
    monkeypatch.setattr(plant_agreement, "has_pybullet", lambda: there)
    alone = run("robot=mini", "duration=0.01", "plant=rk4", outputs)
    text = describe_agreement(alone)
    if not there:
        assert text.endswith("PyBullet, which it would be compared with, is not installed here.")
        return
    assert text.startswith(
        "Runge-Kutta is the plant, in steps of 1 ms. How far the other plant is from it has not been measured"
    )
    assert "plant=bullet and repetitions=1" in text
