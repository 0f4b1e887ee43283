"""Public function `identify`, and the public class of a stored identification."""

import shlex
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from runner.api import page
from runner.api.boundary import public, public_class
from runner.base.errors import RunnerError, unknown
from runner.base.sanitize import one_line
from runner.config.compose.files import outputs_dir
from runner.identification import result

if TYPE_CHECKING:
    import pandas as pd


class Identification(result.Identification):
    """A stored identification: `runner.identify` makes one, `runner.open_identification` opens one."""

    @property
    def sentences(self) -> list[str]:
        """The answer in sentences."""
        from runner.identification.words import answer_lines

        return list(answer_lines(self))

    def to_frame(self) -> "pd.DataFrame":
        """Return the determined parameters, one row each: unit, value, half-width of the interval, file and second.

        `white` is the half-width for residuals that are not correlated, `second` the value of ordinary least squares.
        """
        import pandas as pd

        names = ("name", "unit", "value", "half", "white", "file", "second", "differs", "spread", "prior_share")
        rows = [[getattr(one, name) for name in names] for one in self.parameters]
        return pd.DataFrame(rows, columns=list(names)).set_index("name")

    def __repr__(self) -> str:
        first, *rest = self.sentences
        return "\n  ".join(map(one_line, [f"Identification: {first}", *rest, str(self.folder)]))

    def _repr_html_(self) -> str:
        first, *rest = self.sentences
        return page.heading("Identification", first) + page.listed("", rest) + page.code(self.folder)


@public
def identify(
    *logs: str | Path,
    columns: str | Path | Sequence[str | Path],
    robot: str,
    friction: str | None = None,
    cutoff: float | None = None,
    prior: float | None = None,
    fill_gaps: float = 0.0,
    outputs: str | Path | None = None,
    config_dir: Sequence[str | Path] = (),
) -> Identification:
    """Identify an arm's masses, friction and rotor inertias from logs of it, as `runner identify` does.

    Args:
        logs: Logs of one arm, files or folders.
        columns: A column map of all logs, or one for each.
        robot: Name of the robot.
        friction: Kind of friction: coulomb, sigmoid, load or stribeck; None for the one that predicts unseen torques
            best.
        cutoff: Cut-off on both sides of the equations, in Hz; None for the one that predicts unseen torques best.
        prior: Width of the robot file's values, as a share of them, to combine with the logs; None for none.
        fill_gaps: Longest gap of a log that is filled, in s; 0 for none.
        outputs: Outputs folder; None for the usual one.
        config_dir: Further config folders.

    Raises:
        RunnerError: if a log cannot be read, is too short, contradicts the robot or itself, or has torques without
            gravity.
    """
    from runner.identification.examination import examine_logs, read_question
    from runner.identification.friction_kinds import KINDS
    from runner.identification.identify import identify as fit
    from runner.store.kinds import note
    from runner.sweeps.arm import arm_of

    kind = next((each for each in KINDS if each == friction), None)
    if friction is not None and kind is None:
        raise RunnerError(f"friction: {unknown('kind', friction, KINDS)}")
    if prior is not None and not 0.0 < prior <= 1.0:
        raise RunnerError(f"prior: not a share ({prior:g}). Allowed: above 0 up to 1.")
    if not logs:
        raise RunnerError("logs: none is given. Allowed: one or more.")
    arm = arm_of(robot, [Path(each) for each in config_dir])
    maps = [Path(columns)] if isinstance(columns, str | Path) else [Path(each) for each in columns]
    question = read_question(robot, arm.model, arm.urdf, [Path(log) for log in logs], maps, fill_gaps)
    words = ["runner", "identify", *map(str, logs), *(word for each in maps for word in ("--columns", str(each)))]
    words += [
        "--robot",
        robot,
        *(["--friction", kind] if kind else []),
        *(["--cutoff", f"{cutoff:g}"] if cutoff else []),
        *(["--prior", f"{100.0 * prior:g}%"] if prior else []),
    ]
    place = outputs_dir() if outputs is None else Path(outputs)
    found = fit(examine_logs(question), place, shlex.join(words), kind, cutoff, prior)
    found.write()
    note(found.folder)
    return public_class(Identification, found)
