"""Sampler of a tuning: Optuna's Sobol sequence, then its tree-structured Parzen estimator."""

import warnings
from collections.abc import Mapping, Sequence

import numpy as np
import optuna
from optuna.distributions import BaseDistribution, FloatDistribution, IntDistribution
from optuna.trial import FrozenTrial, TrialState, create_trial

from runner.sweeps.tuning.key import TunedKey
from runner.sweeps.tuning.objective import Objective, Trial

SPREAD = 10
"""Number of the first trials of `runner tune`, which are spread evenly over the ranges."""

_FAILED = "failed"  # name of the constraint that a failed trial violates
_FEWEST_FOR_IMPORTANCE = 20  # trials; the best tenth is compared with all trials


def propose(
    keys: Sequence[TunedKey],
    objectives: Sequence[Objective],
    history: Sequence[FrozenTrial],
    under_way: Sequence[Mapping[str, float]],
    seed: int,
    spread: int = SPREAD,
) -> dict[str, float]:
    """Return the values of the next trial; they depend only on the arguments.

    The first trials are spread evenly over the ranges (a scrambled Sobol sequence; Owen, 1998). Later values are
    likely among the best trials and unlikely among the others, which include failed and unfinished trials (Bergstra et
    al., Algorithms for Hyper-Parameter Optimization, 2011; Watanabe, Tree-Structured Parzen Estimator, 2023).

    Args:
        keys: The keys to choose values for.
        objectives: The objectives.
        history: The finished trials, from `make_optuna_trial`.
        under_way: Values of the unfinished trials.
        seed: Seed of the search.
        spread: Number of first trials that are spread evenly.
    """
    number = len(history) + len(under_way)
    if number < spread:
        found = _spread(keys, objectives, number, seed)
    else:
        own_seed = int(np.random.SeedSequence([seed, number]).generate_state(1)[0])
        sampler = optuna.samplers.TPESampler(seed=own_seed, multivariate=True, n_startup_trials=spread)
        study = _study(objectives, sampler)
        study.add_trials([*history, *(_under_way(keys, params) for params in under_way)])
        found = study.ask(_distributions(keys)).params
    return {key.name: key.value(found[key.name]) for key in keys}


def _spread(keys: Sequence[TunedKey], objectives: Sequence[Objective], number: int, seed: int) -> dict[str, float]:
    """Return a point of the sequence by its number; point 0, before the start of the sequence, is random."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", optuna.exceptions.ExperimentalWarning)
        study = _study(objectives, optuna.samplers.QMCSampler(scramble=True, seed=seed))
    asked = [study.ask(_distributions(keys)) for _ in range(number + 1)]
    return asked[-1].params


def make_optuna_trial(keys: Sequence[TunedKey], trial: Trial) -> FrozenTrial:
    """Return a finished trial as an Optuna object; a failed trial violates a constraint and therefore ranks last."""
    return create_trial(
        params=dict(trial.params),
        distributions=_distributions(keys),
        values=list(trial.values),
        constraints={_FAILED: 1.0 if trial.failure else 0.0},
        user_attrs={"run": trial.run, "failure": trial.failure},
    )


def read_ended(frozen: FrozenTrial) -> Trial:
    """Return the trial that `make_optuna_trial` converted."""
    return Trial(frozen.params, tuple(frozen.values), frozen.user_attrs["run"], frozen.user_attrs["failure"])


def importances(
    keys: Sequence[TunedKey], trials: Sequence[Trial], objective: Objective, place: int
) -> dict[str, float]:
    """Return the importance of each key for a place among the best tenth, as fractions; empty for too few trials.

    Args:
        keys: The keys.
        trials: The trials.
        objective: The objective that ranks the trials.
        place: Index of the objective.

    Source:
        PED-ANOVA: Watanabe et al., Efficiently Quantifying Hyperparameter Importance in Arbitrary Subspaces, 2023.
    """
    good = [trial for trial in trials if not trial.failure]
    if len(good) < _FEWEST_FOR_IMPORTANCE:
        return {}
    study = _study([objective], None)
    for trial in good:
        study.add_trial(make_optuna_trial(keys, Trial(trial.params, (trial.values[place],), trial.run, "")))
    return optuna.importance.get_param_importances(study)


def _study(objectives: Sequence[Objective], sampler: optuna.samplers.BaseSampler | None) -> optuna.Study:
    optuna.logging.set_verbosity(optuna.logging.ERROR)
    return optuna.create_study(directions=[objective.direction for objective in objectives], sampler=sampler)


def _under_way(keys: Sequence[TunedKey], params: Mapping[str, float]) -> FrozenTrial:
    return create_trial(state=TrialState.RUNNING, params=dict(params), distributions=_distributions(keys))


def _distributions(keys: Sequence[TunedKey]) -> dict[str, BaseDistribution]:
    return {key.name: _distribution(key) for key in keys}


def _distribution(key: TunedKey) -> BaseDistribution:
    if key.integer:
        return IntDistribution(int(key.low), int(key.high), log=key.log, step=int(key.step or 1))
    return FloatDistribution(key.low, key.high, log=key.log, step=key.step)
