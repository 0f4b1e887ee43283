"""The verdicts on a study's claims, from runs invented here."""

from dataclasses import replace

import numpy as np
import pytest
from support.made_up_runs import made_up_metric, made_up_run

from runner.papers.reporting.claims import Verdicts
from runner.papers.reporting.published_claims import CONTRADICTION, PublishedClaim, PublishedStatement
from runner.papers.study.claims import judged_claims, judged_statements, legend
from runner.papers.study.results import MissingError
from runner.reporting.words import PRESET

NUMBER = {
    "number": 1,
    "statement": "It settles",
    "place": "section 1",
    "printed": [1.4],
    "unit": "s",
    "experiment": "study/macro",
    "metric": "settling_time",
    "reason": "As printed.",
}
MOTION = NUMBER | {
    "printed": [0.1508],
    "unit": "m",
    "metric": "",
    "extents": [{"axis": "y", "span": 0.4, "tolerance": 5e-3}, {"axis": "z", "span": 0.0, "tolerance": 5e-4}],
}


def seconds(*values):
    return made_up_metric(*values, unit="s")


def run_of(metrics=None, failed=False, width=0.4):
    """Return a run whose tip moves along y by a width; 0.4 m are wanted."""
    y = np.linspace(0.0, width, 5)
    signals = {"tip_x": 0.6, "tip_y": y, "tip_z": 0.1508, "desired_x": 0.6, "desired_y": 0.4 * y / width}
    band = {"robot": {"settling_band": 0.02}}
    return made_up_run(metrics, signals | {"desired_z": 0.1508}, band, failed=failed, command="runner macro")


def blocks(runs, *claims):
    both = {f"{name}/{preset}": each for name, each in runs.items() for preset in PRESET}
    return judged_claims([PublishedClaim.model_validate(claim) for claim in claims], both, PRESET)


def told(block):
    assert [finding.preset for finding in block.findings] == list(PRESET)
    (said,) = {(finding.measured, finding.verdict) for finding in block.findings}
    return said


def test_a_claim_names_one_cell_of_a_grid_with_two_axes():
    cells = {f"stiff/f{hertz}": run_of({"settling_time": seconds(0.1 * hertz)}) for hertz in (10, 20)}
    other = {key: value for key, value in NUMBER.items() if key not in ("experiment", "run")}
    for hertz, measured in ((10, "1 s"), (20, "2 s")):
        (block,) = blocks(cells, other | {"run": f"stiff/f{hertz}"})
        assert told(block)[0] == measured
    (block,) = blocks(
        cells, other | {"printed": [], "run": "stiff/f20", "like": {"run": "stiff/f10", "metric": "settling_time"}}
    )
    assert told(block)[1] == "differs"


def test_a_number_is_judged_by_the_median_and_shown_with_its_range():
    (block,) = blocks({"macro": run_of({"settling_time": seconds(3.0, 4.0, 5.0)})}, NUMBER)
    assert told(block) == ("4.00 s (3.00 to 5.00)", "larger than printed")
    assert (block.number, block.printed, block.reason) == ("1", "1.4 s", "As printed.")
    assert block.command == "runner macro"


def test_a_printed_range_is_shown_by_both_ends():
    (block,) = blocks({"macro": run_of({"settling_time": seconds(1.4)})}, NUMBER | {"printed": [0.7, 1.4]})
    assert block.printed == "0.7 to 1.4 s"


def test_a_run_that_failed_decides_nothing_and_says_why():
    (block,) = blocks({"macro": run_of(failed=True)}, NUMBER)
    assert told(block) == ("failed in repetition 0 at t = 0.5 s: diverged", "undecided")


def hanging(run, longer=None):
    """Return the dependencies of the verdict on a printed 1.4 s, from a run and from a longer run."""
    claim = PublishedClaim.model_validate(NUMBER | ({} if longer is None else {"longer": "longer"}))
    runs = {"macro/full_equations": run, "longer/full_equations": longer}
    (block,) = judged_claims([claim], runs, {"full_equations": "full_equations"})
    return dict(block.findings[0].hangs)


def lasting(end, lost, *values):
    """Return a run of some seconds, whose target is out of reach for some of them."""
    metrics = {"settling_time": seconds(*values), "reach_loss_fraction": made_up_metric(lost / end, unit="1")}
    return made_up_run(metrics, {"t": np.array([0.0, end])})


def test_a_verdict_hangs_on_the_engine_where_the_same_noise_is_judged_otherwise_on_it():
    def with_plant_error(value):
        made = run_of({"settling_time": seconds(1.4, 1.5, 1.4)})
        error = {"plant": "rk4", "metrics": {"settling_time": {"value": value}}}
        return replace(made, record={**made.record, "plant_error": error})

    assert hanging(with_plant_error(1.3)) == {}
    assert hanging(with_plant_error(2.2)) == {"the engine": "repetition 0 on Runge-Kutta: 2.2 s, larger than printed"}
    assert hanging(with_plant_error(None)) == {
        "the engine": "repetition 0 on Runge-Kutta: no value, larger than printed"
    }


def test_a_verdict_hangs_on_the_seed_where_repetitions_alone_are_judged_otherwise():
    assert hanging(run_of({"settling_time": seconds(1.3, 1.4, 1.5)})) == {}
    found = hanging(run_of({"settling_time": seconds(0.1, 1.4, 1.4, 1.5, 9.0)}))
    told = "1 of 5 single repetitions: smaller than printed, 1 of 5 single repetitions: larger than printed"
    assert found == {"the seed": told}


def test_a_single_repetition_is_compared_with_the_same_one_of_the_other_run():
    other = {key: value for key, value in NUMBER.items() if key not in ("experiment", "run")}
    like = {"printed": [], "run": "own", "like": {"run": "other", "metric": "settling_time"}}
    claim = PublishedClaim.model_validate(other | like)

    def seeds_of(*others):
        given = {"own": seconds(1.0, 0.95, 1.0), "other": seconds(*others)}
        runs = {f"{name}/full_equations": run_of({"settling_time": values}) for name, values in given.items()}
        (block,) = judged_claims([claim], runs, {"full_equations": "full_equations"})
        return dict(block.findings[0].hangs)

    assert seeds_of(1.4, 1.45, 1.4) == {"the seed": "1 of 3 single repetitions: differs"}
    assert seeds_of(1.4, 1.4, 1.45) == seeds_of(1.4) == {}  # with one value only, each is compared with it


def test_a_verdict_hangs_on_the_end_of_the_run_where_a_longer_one_is_judged_otherwise_or_loses_its_target():
    assert hanging(lasting(4.0, 1.0, 1.4), lasting(8.0, 1.2, 1.5)) == {}
    found = hanging(lasting(4.0, 1.0, 1.4), lasting(8.0, 1.2, 3.0))
    assert found == {"the end of the run": "over 8 s: 3 s, larger than printed"}
    found = hanging(lasting(4.0, 1.0, 1.4), lasting(8.0, 4.5, 1.5))
    assert found == {"the end of the run": "over 8 s the target is out of reach for 3.5 s more"}
    assert hanging(lasting(4.0, 1.0, 3.0), lasting(8.0, 4.5, 3.0)) == {}


def test_the_legend_speaks_of_the_kinds_of_claims_that_a_study_has():
    numbers, motions = legend([PublishedClaim.model_validate(NUMBER)]), legend([PublishedClaim.model_validate(MOTION)])
    assert "factor of 1.5" in numbers
    assert "motion" not in numbers
    assert "factor" not in motions
    assert "half a unit of the last printed digit" in motions
    assert legend([]) == ""


def test_a_motion_is_judged_by_the_tip_and_shown_axis_by_axis():
    (block,) = blocks({"macro": run_of()}, MOTION)
    assert told(block) == ("y 0.0000 to 0.4000 m, z 0.1508 to 0.1508 m", "matches")
    assert block.printed == "0.1508 m"
    (block,) = blocks({"macro": run_of(width=0.3)}, MOTION)
    assert told(block) == ("y 0.0000 to 0.3000 m, z 0.1508 to 0.1508 m", "differs")


def test_a_failure_that_is_told_matches_where_the_run_fails():
    (block,) = blocks({"macro": run_of(failed=True, width=0.1)}, MOTION | {"fails": True})
    assert told(block) == ("failed in repetition 0 at t = 0.5 s: diverged", "matches")


def test_a_comparison_in_words_takes_the_other_runs_median():
    like = NUMBER | {"printed": [], "like": {"experiment": "study/mini", "metric": "rise_time"}}
    runs = {"macro": run_of({"settling_time": seconds(1.0)}), "mini": run_of({"rise_time": seconds(2.0)})}
    (block,) = blocks(runs, like)
    assert told(block) == ("1 s", "differs")
    assert block.printed == "in words"
    with pytest.raises(MissingError, match="claim 1: there is nothing to compare it with under as_reported"):
        blocks(runs | {"mini": run_of(failed=True)}, like)


@pytest.mark.parametrize(("macro", "verdict"), [(1.0, CONTRADICTION), (3.0, "matches")])
def test_a_bound_is_the_other_claims_number_or_our_median_where_that_is_larger(macro, verdict):
    bound = {"claim": 1, "scale": 0.1, "name": "A tenth of the Macro's", "reason": "It is scaled."}
    mini = NUMBER | {"number": 2, "printed": [0.3], "experiment": "study/mini", "bound": bound}
    runs = {"macro": run_of({"settling_time": seconds(macro)}), "mini": run_of({"settling_time": seconds(0.3)})}
    block = blocks(runs, NUMBER, mini)[1]
    assert told(block) == ("0.3 s", verdict)
    each = f"{macro / 10:g} s"
    ours = f"{each} (as fitted) and {each} (by the printed equations)"
    assert block.reason == f"It is scaled. A tenth of the Macro's is {ours}."


def test_repetitions_that_are_late_are_counted_where_the_error_at_rest_is_judged():
    error = NUMBER | {"metric": "steady_state_error", "unit": "m", "printed": [0.009]}
    made = run_of({"steady_state_error": made_up_metric(0.01, 0.019, 0.03)})
    (block,) = blocks({"macro": made}, error)
    late = [f"1 of 3 repetitions ({PRESET[preset]}) are beyond 20 mm in the last half second." for preset in PRESET]
    assert block.reason == " ".join(["As printed.", *late])
    (block,) = blocks({"macro": run_of({"steady_state_error": made_up_metric(0.01)})}, error)
    assert block.reason == "As printed."


def test_the_table_has_a_row_for_each_claim_and_a_column_for_each_preset():
    made = blocks({"macro": run_of({"settling_time": seconds(1.4)})}, NUMBER, NUMBER | {"number": 2})
    assert Verdicts("Verdicts.", made).ways == ["as fitted", "by the printed equations"]
    assert [row.number for row in made] == ["1", "2"]
    assert [(found.measured, found.verdict) for found in made[0].findings] == [("1.4 s", "matches")] * 2


def test_statements_are_numbered_and_take_their_verdicts_by_name():
    stated = [PublishedStatement(name=n, statement=n.upper(), place="section 1", reason="So.") for n in ("a", "b")]
    first, second = judged_statements(stated, {"b": ("differs", "3 mm"), "a": ("matches", "1 mm")})
    assert (first.number, first.statement, first.findings[0].verdict) == ("1", "A", "matches")
    assert (second.number, second.findings[0].measured, second.reason) == ("2", "3 mm", "So.")
    with pytest.raises(ValueError, match="stated: a, b; judged: a, c"):
        judged_statements(stated, {"a": ("matches", ""), "c": ("matches", "")})


def test_a_claim_names_a_run_and_presets_of_its_study():
    claim = PublishedClaim.model_validate({**NUMBER, "experiment": "", "run": "goal"})
    runs = {"goal/slow": run_of({"settling_time": seconds(1.4)}), "goal/fast": run_of({"settling_time": seconds(0.1)})}
    (block,) = judged_claims([claim], runs, {"slow": "half", "fast": "whole"})
    assert [(each.preset, each.verdict) for each in block.findings] == [
        ("slow", "matches"),
        ("fast", "smaller than printed"),
    ]
    assert Verdicts("All.", [block]).ways == ["half", "whole"]


def test_without_presets_a_claim_is_judged_once():
    claim = PublishedClaim.model_validate({**NUMBER, "experiment": "", "run": "goal"})
    (block,) = judged_claims([claim], {"goal": run_of({"settling_time": seconds(1.4)})}, {})
    assert [(each.preset, each.verdict) for each in block.findings] == [("", "matches")]
    assert Verdicts("All.", [block]).ways == ["simulated"]


def test_a_claim_names_an_experiment_or_a_run():
    with pytest.raises(ValueError, match="names an experiment or a run, one of the two"):
        PublishedClaim.model_validate({**NUMBER, "run": "goal"})
