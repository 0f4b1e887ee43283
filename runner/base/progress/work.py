"""Progress estimate: remaining time from stages, expected durations and elapsed time."""

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass

_START = 3.0  # s until a command has read its code
_EXPECTED = 0.05  # of all work: so much weight the expected times have against those that the clock has shown
_WITHIN = 0.05  # of a stage: likewise, of its own pace
_OVERDUE = 0.25  # of the time that a stage has taken, which is the least that is told to be left of it


@dataclass
class Stage:
    """A stage under way.

    Attributes:
        name: What is done.
        seconds: How long it was expected to take, in s; None where nobody can say.
        total: How much there is to do, in its unit; None where nobody knows.
        unit: What is counted; empty where nothing is.
        count: Tells from any thread how much is made; None where `reached` does.
        began: When it began, in s.
        moved: When it was first seen to be where it is, in s.
        reached: How much is made, as told.
        most: How much is made, as seen last.
    """

    name: str
    seconds: float | None
    total: float | None
    unit: str
    count: Callable[[], float] | None
    began: float
    moved: float
    reached: float = 0.0
    most: float = 0.0

    def made(self, now: float) -> float:
        """Return how much is made at some time, in its unit; it never gets less."""
        made = self.reached if self.count is None else self.count()
        if made > self.most:
            self.most, self.moved = made if self.total is None else min(made, self.total), now
        return self.most

    def done(self, now: float) -> float:
        """Return the share that is made at some time, 0 to 1."""
        made = self.made(now)
        return made / self.total if self.total else 0.0


class Work:
    """Stages of work, one after another: those that ended, the one under way, and those to come.

    How long it will take follows from what each stage is expected to cost, corrected by what the clock has shown: a
    machine that has taken twice as long so far is taken to go on so, and a stage keeps its own pace once it shows one.
    A stage counts as done by what was made of it, never by the time it took.

    One thread does the work; another may ask how far it is.

    Args:
        clock: Tells the time, in s.
    """

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self._clock = clock
        self.restart()

    def restart(self, title: str = "") -> None:
        """Forget all stages, and start some work of which it is not known what follows.

        Args:
            title: What stands before the names of its stages.
        """
        self.title, self._came, self._shown = title, self._clock(), 0.0
        self._spent = self._ended = 0.0  # s: what the stages that ended took, and were expected to take
        self._coming: Mapping[str, float | None] = {}
        self._planned = False
        self._stage = self._start = Stage("starting", _START, 1.0, "", None, self._came, self._came)

    def plan(self, stages: Mapping[str, float | None]) -> None:
        """Say what is to come, in its order, with the time that each stage is expected to take, in s; None is unknown.

        A stage that is planned already keeps its place; the others come before those that are.
        """
        known = self._coming
        before = {name: seconds for name, seconds in stages.items() if name not in known}
        self._coming = before | {name: stages.get(name, seconds) for name, seconds in known.items()}
        self._planned = True

    def begin(
        self,
        name: str,
        seconds: float | None = None,
        total: float | None = 1.0,
        unit: str = "",
        count: Callable[[], float] | None = None,
    ) -> None:
        """End the stage under way and begin another one; stages that were planned before it are left out.

        Args:
            name: What is done.
            seconds: How long it is expected to take, in s; None for what was planned, if it was.
            total: How much there is to do; None where nobody knows.
            unit: What is counted.
            count: Tells from any thread how much is made, where `step` is not called.
        """
        now, last = self._clock(), self._stage
        took = now - last.began
        self._ended += took if last.seconds is None else last.seconds
        self._spent += took if last is not self._start else _START  # to read code tells nothing of what follows
        names = list(self._coming)
        if name in names:
            seconds = self._coming[name] if seconds is None else seconds
            self._coming = {each: self._coming[each] for each in names[names.index(name) + 1 :]}
        self._stage, self._planned = Stage(name, seconds, total, unit, count, now, now), True

    def step(self, made: float = 1.0) -> None:
        """Take note that so much more of the stage is made, in its unit."""
        self._stage.reached += made

    @property
    def said(self) -> str:
        """What is done now, with its count."""
        stage = self._stage
        made = stage.made(self._clock())
        words = f"{stage.name}, {_count(made, stage.total)} {stage.unit}" if stage.unit else stage.name
        return f"{self.title}: {words}" if self.title else words

    @property
    def elapsed(self) -> float:
        """The time since the start, in s."""
        return self._clock() - self._came

    def named(self, title: str) -> None:
        """Give a title to work that has only started; work that is further ends, and other work starts."""
        if self._planned:
            self.restart(title)
        self.title = title

    @property
    def share(self) -> float | None:
        """The share of all work that is done, 0 to 1, weighted by what it is expected to cost; None where unknown.

        It never gets less, though expectations may.
        """
        share = self._share()
        if share is not None:
            self._shown = share = max(share, self._shown)
        return share

    def _share(self) -> float | None:
        stage, coming = self._stage, list(self._coming.values())
        done = stage.done(self._clock())
        if stage.seconds is None and stage.total and stage.unit and not coming:
            return done
        if stage.seconds is None or not self._planned or None in coming:
            return None
        whole = self._ended + stage.seconds + _sum(coming)
        return (self._ended + done * stage.seconds) / whole if whole > 0.0 else None

    @property
    def left(self) -> float | None:
        """The time that all will still take, in s; None where the cost of a stage is not known yet."""
        stage, coming, now = self._stage, list(self._coming.values()), self._clock()
        done, took = stage.done(now), now - stage.began
        if not self._planned or None in coming or (stage.seconds is None and not done):
            return None
        seconds = (stage.moved - stage.began) / done if stage.seconds is None else stage.seconds
        pace = self._pace(stage, seconds, done, took, _sum(coming))
        seen = done / (done + _WITHIN)
        whole = ((stage.moved - stage.began) / done * seen if done else 0.0) + (1.0 - seen) * seconds * pace
        rest = max(whole - took, (1.0 - done) * _OVERDUE * took) if done < 1.0 else 0.0
        return rest + _sum(coming) * pace

    def _pace(self, stage: Stage, seconds: float, done: float, took: float, coming: float) -> float:
        """Return by how much all has taken longer than expected, which counts the more the more of it is over."""
        spent, ended = self._spent, self._ended
        if done:
            spent, ended = spent + stage.moved - stage.began, ended + done * seconds
        elif took > seconds and stage is not self._start:
            spent, ended = spent + took, ended + seconds
        weight = _EXPECTED * (self._ended + seconds + coming)
        return (spent + weight) / (ended + weight) if ended + weight > 0.0 else 1.0


def _sum(coming: list[float | None]) -> float:
    return sum(each or 0.0 for each in coming)


def _count(made: float, total: float | None) -> str:
    """Return a count and its whole, such as "1.2 of 8.0 M"."""
    if total is None:
        return f"{made:.0f}"
    for least, size, letter in ((1e9, 1e9, " G"), (1e6, 1e6, " M"), (1e4, 1e3, " k")):
        if total >= least:
            return f"{made / size:.1f} of {total / size:.1f}{letter}"
    return f"{made:.0f} of {total:.0f}"
