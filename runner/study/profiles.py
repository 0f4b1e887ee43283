"""Profiles of a study: other axis levels or numbers of repetitions for a smaller or larger version."""

from collections.abc import Iterator, Mapping
from typing import Annotated, TypeVar

from pydantic import Field, PositiveInt

from runner.base.errors import nearest
from runner.schema.model import StrictModel
from runner.study.arithmetic import Level
from runner.study.grid import Grid, Overrides

G = TypeVar("G", bound=Grid)


class Profile(StrictModel):
    """What differs from the whole study.

    Attributes:
        repetitions: Repetitions of every run; None leaves those of the grids.
        levels: Levels of axes in place of those in runs.yaml, by grid and axis; of an axis with labels some of these.
        without: Grids and tunings that it does without.
        tuned_anew: Whether gains are tuned, and not taken from gains.yaml.
    """

    repetitions: PositiveInt | None = None
    levels: dict[str, dict[str, Annotated[list[Level], Field(min_length=1)]]] = Field(default_factory=dict)
    without: list[str] = Field(default_factory=list)
    tuned_anew: bool = False

    def problems(self, grids: Mapping[str, Grid]) -> Iterator[str]:
        """Yield what it names that the grids do not have."""
        for key in dict.fromkeys([*self.levels, *self.without]):
            if key not in grids:
                yield f"there is no grid '{key}'{nearest(key, grids)}"
        for key, axes in self.levels.items():
            if key not in grids:
                continue
            over = grids[key].over
            for axis, levels in axes.items():
                if axis not in over:
                    yield f"grid '{key}': there is no axis '{axis}'{nearest(axis, over)}"
                elif None not in over[axis].values():
                    known = [str(level) for level in over[axis]]
                    for level in map(str, levels):
                        if level not in known:
                            yield f"grid '{key}': axis '{axis}' has no level '{level}'{nearest(level, known)}"

    def applied(self, grids: Mapping[str, G]) -> dict[str, G]:
        """Return the grids that it has, with the levels that it gives their axes."""
        return {key: self._applied(key, grid) for key, grid in grids.items() if key not in self.without}

    def _applied(self, key: str, grid: G) -> G:
        given = self.levels.get(key, {})
        over = {
            axis: {level: levels.get(level) for level in given.get(axis, levels)} for axis, levels in grid.over.items()
        }
        return grid.model_copy(update={"over": over})

    def repeated(self, overrides: Overrides) -> Overrides:
        """Return a run's overrides with the profile's number of repetitions."""
        if self.repetitions is None:
            return overrides
        kept = (text for text in overrides if not text.startswith("repetitions="))
        return (*kept, f"repetitions={self.repetitions}")
