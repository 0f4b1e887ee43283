"""The thesis' claims judged by seeds: what one seed says, what medians of groups say, and by which interval."""

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np
import pytest
from fixtures.studies import Made
from scipy import stats
from support.study_sections import every_run, texts, unfinished_texts

from runner.papers.reporting.published_claims import load_claims
from runner.papers.studies.thesis import how_sure
from runner.papers.studies.thesis.how_sure import DRAWN, JudgedClaim, judge_by_seeds
from runner.papers.study.measured import Finding
from runner.papers.study.study import load_study
from runner.statistics.proportion import count_share
from runner.store import Run
from runner.sweeps.job import run

CLAIMS = load_claims("thesis")
SEEDS, OWN = 400, 40


@pytest.fixture
def runs(made: Callable[[str], Made]) -> Mapping[str, Run]:
    return made("thesis").runs


@pytest.fixture(scope="module")
def some(tmp_path_factory: pytest.TempPathFactory) -> Run:
    return run(
        "robot=macro", "trajectory=goal", "plant=rk4", "duration=0.02", f"outputs={tmp_path_factory.mktemp('o')}"
    )


def with_values(some: Run, **values: list[float | None]) -> Run:
    """Return a run that has these values of metrics."""
    metrics = {}
    for name, own in values.items():
        ordered = sorted(np.inf if value is None else value for value in own)
        ends = (float(np.median(ordered)), ordered[0], ordered[-1])
        median, low, high = (end if np.isfinite(end) else None for end in ends)
        metrics[name] = {"unit": "m", "values": own, "median": median, "min": low, "max": high}
    changed = replace(some, record={**some.record, "metrics": metrics})
    changed.__dict__["config"] = {**some.config, "repetitions": OWN}
    return changed


def judged_by(some: Run, number: int, values: list[float | None], **others: list[float | None]) -> JudgedClaim:
    """Return a claim judged by seeds with these values; the study's own run has those of the first ones."""
    claim = next(each for each in CLAIMS if each.number == number)
    stored = {claim.experiment.rpartition("/")[2]: {claim.metric: values}}
    if claim.like is not None:
        stored[claim.like.experiment.rpartition("/")[2]] = {claim.like.metric: others["like"]}
    if claim.bound is not None:
        stored.setdefault("figure_3_5", {})["settling_time"] = others["bound"]
    seeds = {name: with_values(some, **own) for name, own in stored.items()}
    own = {name: with_values(some, **{m: v[:OWN] for m, v in each.items()}) for name, each in stored.items()}
    return judge_by_seeds(claim, CLAIMS, seeds, own, "full_equations")


def test_one_seed_turns_by_its_own_value_and_a_group_by_the_binomial(some: Run) -> None:
    """Three in ten of 400 seeds are judged worse. A median of 40 is worse as often as half of 40 draws, or more."""
    worse = 120
    values = [5e-4] * (SEEDS - worse) + [9e-4] * worse  # claim 9 holds up to 6e-4
    each = judged_by(some, 9, list(np.random.default_rng(1).permutation(values)))
    assert (each.verdict, each.own_verdict) == ("matches", "matches")
    assert each.otherwise(each.alone) == worse
    # The mean of the two middle ones is judged: with half of the draws beyond, it is 7e-4 and worse.
    exact = float(stats.binom.sf(OWN // 2 - 1, OWN, worse / SEEDS))
    spread = 4.0 * np.sqrt(exact * (1.0 - exact) / DRAWN)
    assert each.otherwise(each.drawn) / DRAWN == pytest.approx(exact, abs=spread)


def test_a_seed_without_a_value_is_worse(some: Run) -> None:
    each = judged_by(some, 8, [1.0] * (SEEDS - 7) + [None] * 7)
    assert [verdict for verdict in each.alone if verdict != "matches"] == ["larger than printed"] * 7
    assert each.quantiles().tolist() == [1.0, 1.0, np.inf]


def test_what_a_claim_is_like_has_the_same_seeds(some: Run) -> None:
    """Two runs that go up and down together are alike in every seed, however far their seeds are apart."""
    values = np.random.default_rng(2).uniform(0.01, 1.0, SEEDS)
    each = judged_by(some, 16, list(values), like=list(values))
    assert set(each.alone) == {"matches"}
    apart = judged_by(some, 16, list(values), like=list(values[::-1]))
    assert apart.otherwise(apart.alone) > SEEDS // 4


def test_a_bound_is_that_of_the_same_seeds(some: Run) -> None:
    """Claim 5 contradicts claim 1 except for seeds in which the Macro itself takes long: 0.1 of 2 s or more."""
    slow = [1.4] * (SEEDS - 30) + [2.5] * 30
    each = judged_by(some, 5, [0.3] * SEEDS, bound=slow)
    assert each.verdict == "source contradicts itself"
    assert [verdict for verdict in each.alone if verdict != each.verdict] == ["matches"] * 30


def test_the_share_of_seeds_has_its_interval() -> None:
    """The ends are where the count becomes improbable: 2.5 % on each side."""
    share = count_share(7, 200)
    assert stats.binom.sf(6, 200, share.low) == pytest.approx(0.025)
    assert stats.binom.cdf(7, 200, share.high) == pytest.approx(0.025)
    assert count_share(0, 200).low == 0.0
    assert count_share(0, 200).high == pytest.approx(1.0 - 0.025 ** (1 / 200))
    assert count_share(200, 200).high == 1.0


def test_the_full_profile_raises_the_seeds_alone() -> None:
    whole, full = (load_study("thesis", profile=profile).jobs() for profile in ("", "full"))
    assert {name for name in whole if name not in full} == {name for name in whole if name.startswith("sure/")}
    more = {name: job for name, job in full.items() if name not in whole}
    assert len(more) == 22
    assert all(job[-1] == "repetitions=10000" and "plant=rk4" in job for job in more.values())
    assert all(full[name] == job for name, job in whole.items() if name in full)


def test_every_claim_has_its_run_of_many_seeds(runs: Mapping[str, Run]) -> None:
    given = how_sure.judged(runs)
    assert [(each.claim.number, each.preset) for each in given] == [
        (claim.number, preset) for claim in CLAIMS for preset in ("as_reported", "full_equations")
    ]
    assert all(each.values.size for each in given)


def test_the_chapter_bears_failed_runs_and_concludes_nothing_of_them(made: Callable[[str], Made]) -> None:
    section = made("thesis").spoiled(every_run).section("how_sure.md")
    assert not unfinished_texts(section)
    assert any("for this test" in text for text in texts(section))
    assert not any(block.holds for block in section.blocks if isinstance(block, Finding))
