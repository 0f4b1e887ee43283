"""Public function `challenge`, and the public class of a stored challenge: its variations and its sentences."""

import shlex
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from runner.api import page
from runner.api.boundary import public, public_class
from runner.api.run import Run
from runner.api.sweep import Sweep
from runner.api.tuning import Tuning
from runner.base.sanitize import one_line
from runner.store.kinds import Kind, find_folder, outputs_of
from runner.sweeps.challenge import stored

if TYPE_CHECKING:
    import pandas as pd

Challengeable = Run | Sweep | Tuning | str | Path


class Challenge(stored.Challenge):
    """A stored challenge: `runner.challenge` makes one, `runner.open_challenge` opens one."""

    @property
    def sentences(self) -> list[str]:
        """The answer with its scope, in sentences."""
        from runner.reporting.challenge.words import scope_sentences

        return scope_sentences(self)

    def to_frame(self) -> "pd.DataFrame":
        """Return the variations, one row each.

        The columns are class, family, value, changed, word, effect, low, high and pairs. The effect is the difference
        of the second side from the first, relative to the larger median; low and high are the ends of its interval.
        """
        import pandas as pd

        rows = [
            {
                "class": one.variation.kind, "family": one.variation.family, "value": one.variation.value,
                "changed": one.variation.label, "word": one.judged.word if one.judged else None,
                "effect": one.judged.effect if one.judged else None, "low": one.judged.low if one.judged else None,
                "high": one.judged.high if one.judged else None, "pairs": one.judged.pairs if one.judged else 0,
            }
            for one in self.found
        ]  # fmt: skip
        return pd.DataFrame(rows)

    def __repr__(self) -> str:
        first, *rest = self.sentences
        return "\n  ".join(map(one_line, [f"Challenge: {first}", *rest, str(self.folder)]))

    def _repr_html_(self) -> str:
        first, *rest = self.sentences
        return page.heading("Challenge", first) + page.listed("", rest) + page.code(self.folder)


@public
def challenge(
    first: Challengeable,
    second: Challengeable | None = None,
    *,
    by: str = "",
    metric: str = "",
    where: Sequence[str] = (),
    vary: Mapping[str, Sequence[object]] | None = None,
    without: Sequence[str] = (),
    budget: str = "",
    workers: int = 2,
) -> Challenge:
    """Ask the question of a stored comparison again with one choice changed at a time, as `runner challenge` does.

    Args:
        first: A sweep, a tuning or a run, or its folder.
        second: Another sweep or run to compare with; None for the question of one sweep or tuning.
        by: Axis whose values are compared, for one sweep; empty for its question.
        metric: Metric that is compared; empty for the first one of the result.
        where: Values of keys that the cells have, each as KEY=VALUE.
        vary: Values by family or dotted key, such as {"duration": [0.7, 3]}.
        without: Families to leave out.
        budget: A time such as "60s", or a number of variations; empty for no limit.
        workers: Number of processes on this machine; 0 simulates the runs in this process.

    Raises:
        RunnerError: if there is no comparison, or a family or value does not exist.
    """
    from runner.reporting.challenge.question import read_question
    from runner.sweeps.challenge.budget import ChallengeBudget, read_budget
    from runner.sweeps.challenge.run import challenge as run_challenge
    from runner.sweeps.challenge.table import change_values, read_values
    from runner.sweeps.run import Engine

    things = [each for each in (first, second) if each is not None]
    kinds: Sequence[Kind] = ("run", "sweep", "tuning")
    folders = [find_folder(each, kinds) if isinstance(each, str | Path) else each.folder for each in things]
    question = read_question(folders, by, metric, where)
    texts = [f"{key}={','.join(map(str, values))}" for key, values in (vary or {}).items()]
    values = change_values(read_values(question.config_dirs), texts, without)
    words = [*map(str, folders), *(["--by", by] if by else []), *(["--metrics", metric] if metric else [])]
    words += [word for text in where for word in ("--where", text)]
    words += [word for text in texts for word in ("--vary", text)]
    words += ["--without", ",".join(without)] if without else []
    command = shlex.join(["runner", "challenge", *words])
    allowed = read_budget(budget) if budget else ChallengeBudget()
    made = run_challenge(question, values, outputs_of(folders[0]), Engine(workers, None), command, allowed)
    return public_class(Challenge, made)
