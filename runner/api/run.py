"""Public class of a stored run: tables, figures, sensitivity and comparison with recordings."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from runner import store
from runner.api import page
from runner.api.boundary import public
from runner.base.errors import RunnerError
from runner.base.sanitize import one_line

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure

    from runner.analysis import Sensitivity
    from runner.recordings.compare import RecordingComparison

_IN_TEXT, _ON_PAGE = 1, 6


class Run(store.Run):
    """A stored run: `runner.run` makes one, `runner.open_run` opens one.

    >>> run = runner.run("noise=thesis", robot="macro", trajectory="quintic", duration=0.1, repetitions=3)
    >>> run.metrics["peak_torque"].unit
    'N m'
    >>> len(run.metrics["peak_torque"].values)
    3
    >>> run.to_frame().columns.tolist()
    ['unit', 'median', 'min', 'max', 'n']
    >>> run.trace(repetition=2)[["t", "error_x"]].shape
    (11, 2)
    """

    def to_frame(self) -> "pd.DataFrame":
        """Return a table with one row per metric: unit, median, min, max and n, the number of values."""
        import numpy as np
        import pandas as pd

        rows = {
            name: (one.unit, one.median, one.min, one.max, int(np.count_nonzero(~np.isnan(one.read()))))
            for name, one in self.metrics.items()
        }
        frame = pd.DataFrame.from_dict(rows, orient="index", columns=["unit", "median", "min", "max", "n"])
        return frame.rename_axis("metric").astype({"median": float, "min": float, "max": float})

    @public
    def trace(self, repetition: int = 0) -> "pd.DataFrame":
        """Return the signals of a repetition, one row per tick; `units` has the units of the columns.

        Repetition 0 is stored. Any other repetition is simulated again, and its metrics must equal the stored metrics.
        On another machine than that of the run, metrics that are equal up to rounding cause a RuntimeWarning.

        Raises:
            RunnerError: if there is no such repetition, or the code has changed since the run.
        """
        from runner.api.signals import signals_of

        return signals_of(self, repetition).frame

    @public
    def plot(self, signal: str = "error", repetition: int = 0) -> "Figure":
        """Return a Matplotlib figure of a signal over time, to be changed or saved.

        Args:
            signal: Name of the signal, such as "error", "tip", "torque", "position" or "velocity".
            repetition: Number of the repetition; see `trace`.

        Raises:
            RunnerError: if the run has no such signal; lists the signals that it has.
        """
        from runner.api.signals import figure_of, signals_of

        return figure_of(signals_of(self, repetition), signal)

    @public
    def sensitivity(self, parameters: str | Sequence[str] = (), repetition: int = 0) -> "Sensitivity":
        """Return the derivatives of the metrics with respect to the parameters, as `runner sensitivity` prints them.

        The result has `metrics`, `parameters` and `derivatives`, with an array over the parameters for each metric;
        `elasticities(metric)`; `ranked(metric)`, the order of the parameters; `left_out`, parameters by reason.

        Args:
            parameters: Groups of parameters, such as "masses" and "gains"; empty for all.
            repetition: Number of the repetition.

        Raises:
            RunnerError: if the run has no derivatives, or no such repetition or parameter.
        """
        from runner.analysis import GROUPS, of_run

        groups = [parameters] if isinstance(parameters, str) else parameters
        return of_run(self, groups or GROUPS, repetition)

    @public
    def compare_recording(
        self, recording: str | Path, columns: str | Path, fill_gaps: float = 0.0
    ) -> "RecordingComparison":
        """Compare repetition 0 with the recording of a real arm, as `runner compare` does.

        The result has `offset`, the time in the recording at which the run begins; `residuals`, a list of signals with
        `mean`, `rms`, `largest` and `fit`; `metrics` of the run and of the recording by name; `friction` of the joints.

        Args:
            recording: The recording, a CSV file or a ROS bag.
            columns: The YAML file that describes the columns of the recording; see docs/recordings.md.
            fill_gaps: Longest gap in the recording that is filled, in s; 0 for none.

        Raises:
            RunnerError: if a file cannot be read, or the recording does not fit the run.
        """
        from runner.recordings.compare import compare_recording

        return compare_recording(self, Path(recording), Path(columns), fill_gaps)

    def __repr__(self) -> str:
        told = "; ".join(f"{title} {value}" for title, value, _ in self._key_metrics(_IN_TEXT))
        caveats = f"caveats: {', '.join(str(caveat['rule']) for caveat in self.caveats)}" if self.caveats else ""
        lines = [f"Run of {self._name()}: {self._ended()}", self.failure or "", told, caveats, str(self.folder)]
        return "\n  ".join(one_line(line) for line in lines if line)

    def _repr_html_(self) -> str:
        rows = self._key_metrics(_ON_PAGE)
        parts = [
            page.heading(self._name(), self._ended()),
            page.line(self.failure or ""),
            page.table(("metric", "median (smallest to largest)", ""), rows) if rows else "",
            page.listed("Caveats", [f"{caveat['rule']}: {caveat['text']}" for caveat in self.caveats]),
            self._picture(),
            page.code(self.folder),
        ]
        return "".join(parts)

    def _repr_png_(self) -> bytes | None:
        """Return the picture of the page as PNG, which a notebook exported as LaTeX or PDF shows."""
        from runner.api.signals import Signals, png_of

        try:
            return png_of(Signals(super().trace(), self.units), "error")
        except RunnerError:
            return None

    def _ended(self) -> str:
        return f"{self.status}, {self.repetitions} repetition{'s' if self.repetitions != 1 else ''}"

    def _name(self) -> str:
        config = self.config
        kinds = (config["controller"]["kind"], config["trajectory"]["kind"], config["plant"]["kind"])
        return ", ".join(str(part) for part in (config["robot"]["name"], *kinds))

    def _key_metrics(self, most: int) -> Sequence[tuple[str, str, str]]:
        from runner.reporting.metric_titles import key_metrics

        return key_metrics(self, most)

    def _picture(self) -> str:
        from runner.api.signals import Signals, svg_of

        try:
            signals = Signals(super().trace(), self.units)
        except RunnerError:
            return ""  # no trace, or a damaged one: the page shows the other parts
        return page.picture(svg_of(signals, "error"), "tip position error of repetition 0 over time")
