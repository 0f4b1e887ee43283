"""How far work is, and how long it will take, by a clock of its own."""

import pytest

from runner.base.progress.work import Work


class Clock:
    def __init__(self):
        self.now = 100.0

    def __call__(self):
        return self.now


class Stub:
    """Work whose stages take as long as they are told to: planned and true seconds of each by its name.

    A stage is made in pieces, each of which takes its time; an uncounted one is made in one.
    """

    def __init__(self, stages, pieces=50):
        self.clock = Clock()
        self.work = Work(self.clock)
        self.stages, self.pieces = stages, pieces
        self.work.begin("start", 0.0)
        self.work.plan({name: planned for name, (planned, *_) in stages.items()})

    def looks(self):
        """Do the work; yield after each piece what is done of the true time, what is left of it, and what is told."""
        whole, began = sum(true for _, true, *_ in self.stages.values()), self.clock.now
        for name, (_, true, *counted) in self.stages.items():
            pieces = self.pieces if counted else 1
            if counted:
                self.work.begin(name, None, pieces, "things")
            else:
                self.work.begin(name)
            for _ in range(pieces):
                for _ in range(self.pieces // pieces):  # the clock moves within a piece, too
                    self.clock.now += true / self.pieces
                    gone = self.clock.now - began
                    yield gone / whole, whole - gone, self.work.left
                if counted:
                    self.work.step()


MIXES = {
    "all as planned": {"a": (10.0, 10.0, True), "b": (90.0, 90.0, True)},
    "a machine half as fast": {"a": (10.0, 20.0, True), "b": (90.0, 180.0, True)},
    "a machine three times as fast": {"a": (10.0, 3.3, True), "b": (90.0, 30.0, True)},
    "a fast start and a slow end": {"a": (5.0, 5.0, True), "b": (5.0, 6.0, True), "c": (90.0, 110.0, True)},
    "a slow start and a fast end": {"a": (80.0, 90.0, True), "b": (20.0, 15.0, True)},
    "a long start-up": {"start-up": (30.0, 40.0), "b": (60.0, 60.0, True)},
    "a start-up longer than planned": {"start-up": (4.0, 12.0), "b": (50.0, 50.0, True)},
    "many stages that cannot be counted": dict.fromkeys("abcdefgh", (5.0, 8.0)),
}


@pytest.mark.parametrize("mix", MIXES)
def test_after_a_tenth_the_time_left_is_told_within_a_factor_of_two(mix):
    told = [(left, said) for done, left, said in Stub(MIXES[mix]).looks() if 0.1 <= done <= 0.9]
    assert len(told) > 30
    for left, said in told:
        assert left / 2.0 <= said <= left * 2.0


def test_what_was_planned_wrongly_is_seen_once_it_is_under_way():
    """The stage takes ten times what was planned, which its own pace shows."""
    for done, left, said in Stub({"a": (10.0, 10.0, True), "b": (10.0, 100.0, True)}).looks():
        if 0.4 < done < 0.9:
            assert left / 2.0 <= said <= left * 2.0


def test_a_stage_of_unknown_cost_tells_its_time_as_soon_as_something_of_it_is_made():
    clock = Clock()
    work = Work(clock)
    work.begin("a", None, 100, "ticks")
    clock.now += 2.0
    assert work.left is None
    work.step(25)
    assert work.left == pytest.approx(6.0)
    assert work.share == 0.25


def test_nothing_is_told_while_it_is_unknown_what_follows():
    work = Work(Clock())
    assert (work.share, work.left) == (None, None)
    work.plan({"a": 1.0, "b": None})
    work.begin("a")
    assert (work.share, work.left) == (None, None)
    work.plan({"b": 3.0})
    assert work.left == 4.0


def test_time_alone_makes_no_share():
    clock = Clock()
    work = Work(clock)
    work.begin("a", 10.0, 10, "things")
    work.step(4)
    before = work.share
    clock.now += 1000.0
    assert work.share == before < 0.6
    assert work.left > 100.0  # what is overdue is not about to end


def test_the_share_never_gets_less():
    work = Work(Clock())
    work.plan({"a": 5.0, "b": 5.0})
    work.begin("b")
    before = work.share
    assert before > 0.3
    work.plan({"c": 100.0})
    assert work.share == before


def test_stages_that_were_left_out_no_longer_count():
    work = Work(Clock())
    work.plan({"a": 100.0, "b": 4.0})
    work.begin("b")
    assert work.left == 4.0


def test_a_plan_within_a_plan_comes_before_what_follows():
    clock = Clock()
    work = Work(clock)
    work.plan({"runs": None, "report": 5.0})
    work.plan({"start-up": 3.0, "runs": 20.0})
    work.begin("start-up")
    clock.now += 3.0
    work.begin("runs")
    assert work.left == 25.0


def test_counts_are_asked_and_never_fall():
    clock, counts = Clock(), iter([3, 2, 8, 20, 20])
    work = Work(clock)
    work.begin("a", None, 10, "ticks", lambda: next(counts))
    assert [work.said for _ in range(4)] == [f"a, {n} of 10 ticks" for n in (3, 3, 8, 10)]


@pytest.mark.parametrize(
    ("made", "total", "words"),
    [(3, None, "3 things"), (25_000, 400_000, "25.0 of 400.0 k things"), (1_230_000, 8e6, "1.2 of 8.0 M things")],
)
def test_counts_are_short(made, total, words):
    work = Work(Clock())
    work.begin("a", None, total, "things")
    work.step(made)
    assert work.said == f"a, {words}"


def test_work_has_its_title_and_begins_anew_with_the_next():
    clock = Clock()
    work = Work(clock)
    clock.now += 3.0
    work.named("one")
    assert (work.said, work.elapsed) == ("one: starting", 3.0)  # it had only started
    work.begin("a", 1.0)
    clock.now += 3.0
    work.named("two")
    assert (work.said, work.elapsed, work.share) == ("two: starting", 0.0, None)
