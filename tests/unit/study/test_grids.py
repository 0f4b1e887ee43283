"""Grids of a study's runs: which runs they stand for, and what is said of those that cannot be read."""

import pytest

from runner.base.errors import RunnerError
from runner.papers.study.grids import Grids


@pytest.fixture
def read(tmp_path):
    def make(text):
        path = tmp_path / "runs.yaml"
        path.write_text(text)
        return Grids(path)

    return make


def test_a_grid_is_a_run_for_each_combination_in_the_order_of_its_axes(read):
    grids = read("""
grids:
  turns:
    with: [experiment=thesis/figure_5_12]
    over: {preset: [as_reported, full_equations], schedule: {both: controller.schedule=both, turns: [a=1, b=2]}}
  alone: {with: [robot=xarm7]}
""")
    begin = "experiment=thesis/figure_5_12"
    assert list(grids.runs.items()) == [
        ("turns/as_reported/both", (begin, "preset=as_reported", "controller.schedule=both")),
        ("turns/as_reported/turns", (begin, "preset=as_reported", "a=1", "b=2")),
        ("turns/full_equations/both", (begin, "preset=full_equations", "controller.schedule=both")),
        ("turns/full_equations/turns", (begin, "preset=full_equations", "a=1", "b=2")),
        ("alone", ("robot=xarm7",)),
    ]
    assert grids.runs["alone"] == ("robot=xarm7",)
    assert grids.grid("turns").over["schedule"]["turns"] == ("a=1", "b=2")
    assert grids.calibrations == {}


def test_an_axis_stands_where_an_override_puts_it(read):
    grids = read("""
grids:
  g:
    name: "{{ x }}/at/{{ t }}"
    with: ["{{ y }}", "{{ t }}", "at={{ x }}"]
    over: {x: [1.0, 0.25], t: [3.0], y: {one: "{{ z }}", two: ["plant=rk4", "{{ z }}"]}, z: {a: [], b: z=b}}
""")
    assert grids.runs == {
        "1/at/3/one/a": ("t=3.0", "at=1"),
        "1/at/3/one/b": ("z=b", "t=3.0", "at=1"),
        "1/at/3/two/a": ("plant=rk4", "t=3.0", "at=1"),
        "1/at/3/two/b": ("plant=rk4", "z=b", "t=3.0", "at=1"),
        "0.25/at/3/one/a": ("t=3.0", "at=0.25"),
        "0.25/at/3/one/b": ("z=b", "t=3.0", "at=0.25"),
        "0.25/at/3/two/a": ("plant=rk4", "t=3.0", "at=0.25"),
        "0.25/at/3/two/b": ("plant=rk4", "z=b", "t=3.0", "at=0.25"),
    }


def test_an_alias_puts_its_overrides_in(read):
    grids = read("grids: {g: {with: [&one [a=1, b=2], c=3], over: {x: {l: [*one, d=4]}}}}")
    assert grids.runs == {"g/l": ("a=1", "b=2", "c=3", "a=1", "b=2", "d=4")}


def test_numbers_stand_in_names_and_overrides_as_they_are_written(read):
    grids = read("grids: {g: {over: {controller.period: [1, 2.0, 0.00025, 0.00001, 1.0e-4]}}}")
    texts = ["1", "2.0", "0.00025", "1e-05", "0.0001"]
    assert list(grids.runs.items()) == [(f"g/{text}", (f"controller.period={text}",)) for text in texts]
    assert grids.levels("g", "controller.period", float)[:2] == (1, 2.0)


def test_expressions_take_axes_and_values(read):
    grids = read("""
grids: {g: {with: ["m={{ mass / parts }}", "s={{ controller.period * twice }}"],
            over: {mass: [0.2, 3], controller.period: [0.1]}, values: {parts: 2}}}
values: {parts: 9, twice: 2}
""")
    assert grids.runs == {"g/0.2/0.1": ("m=0.1", "s=0.2"), "g/3/0.1": ("m=1.5", "s=0.2")}
    assert (grids.value("g", "parts"), grids.value("g", "twice")) == (2, 2)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("grids: {turns: {ovr: {a: [1]}}}", r"runs.yaml: grids.turns.ovr: unknown key \(did you mean over\?\)"),
        ("grid: {}", r"grid: unknown key \(did you mean grids\?\)"),
        ("grids: {g: {over: {a: {both: null}}}}", "grids.g.over.a: .*'both' must stand for an override or a list"),
        ("grids: {g: {over: {a: [1, null]}}}", "grids.g.over.a: .*a level must be a finite number or a text"),
        ("grids: {g: {over: {a: [true]}}}", "a level must be a finite number or a text"),
        ("grids: {g: {over: {a: [1, 1]}}}", "has a level twice"),
        ("grids: {g: {over: {a: [1, 1.0]}}}", "has a level twice"),
        ("grids: {g: {over: {a: [.inf]}}}", "a level must be a finite number"),
        (f"grids: {{g: {{over: {{a: {[*range(200)]}, b: {[*range(100)]}}}}}}}", "has 20,000 runs; allowed"),
        ("grids: {g: {over: {a: []}}}", "grids.g.over.a: .*must be a list of levels"),
        ("grids: {g: {over: {a: 1}}}", "must be a list of levels"),
        ("grids: {g: {with: a=1}}", "grids.g.with: must be a list of overrides"),
        ("grids: [a]", "grids: must be a group of grids"),
        ("- grids", "grids: must be a group of grids"),
        ("grids: {g: 1}", "grids.g"),
        ("grids: {g: {}, h: {name: g}}", "grids.h: the name 'g' is that of another run"),
        ("values: {a: b}", "values.a: must be a number"),
        ("grids: {g: {}, g: {}}", "line 1: the key 'g' stands twice"),
        ("grids: {g: {with: ['m={{ mas / 2 }}'], over: {mass: [1]}}}", r"grids.g: .*no name 'mas' .*mean mass\?"),
        ("grids: {g: {over: {a: {x: '{{ b }}'}, b: {x: '{{ a }}'}}, with: ['{{ a }}']}}", "'a' is put into itself"),
        ("grids: {g: {with: [}}", "runs.yaml, line 1"),
    ],
)  # fmt: skip
def test_what_is_wrong_is_told_with_file_and_grid(read, text, message):
    with pytest.raises(RunnerError, match=message):
        read(text)


def test_every_problem_is_told_at_once(read):
    with pytest.raises(RunnerError) as caught:
        read("grids: {g: {wth: []}, h: {over: {a: 1}}}")
    assert [line.split(": ")[1] for line in str(caught.value).splitlines()] == ["grids.g.wth", "grids.h.over.a"]


def test_a_file_that_is_not_there_is_named(tmp_path):
    with pytest.raises(RunnerError, match=r"cannot read .*runs\.yaml"):
        Grids(tmp_path / "runs.yaml")


def test_what_a_chapter_asks_for_is_there_or_refused_with_the_nearest_name(read):
    grids = read("grids: {rates: {over: {rate: [1, 2.5], plant: [rk4]}, values: {gain: 2}}}")
    assert grids.levels("rates", "plant", str) == ("rk4",)
    for ask, message in (
        (lambda: grids.grid("rate"), r"there is no grid 'rate' \(did you mean rates\?\)"),
        (lambda: grids.levels("rates", "rat", str), r"grid 'rates': there is no axis 'rat' \(did you mean rate\?\)"),
        (lambda: grids.levels("rates", "rate", int), "the levels of 'rate' are not all of kind int"),
        (lambda: grids.value("rates", "gan"), r"there is no value 'gan' \(did you mean gain\?\)"),
    ):
        with pytest.raises(RunnerError, match=message):
            ask()


@pytest.mark.parametrize(("place", "level"), [(0, 1), (2, 4), (-1, 4), (-3, 1)])
def test_a_level_is_found_by_its_place_from_either_end(read, place, level):
    assert read("grids: {rates: {over: {rate: [1, 2.5, 4]}}}").level("rates", "rate", place) == level


@pytest.mark.parametrize("place", [3, 4, -4])
def test_a_place_beyond_either_end_is_refused(read, place):
    grids = read("grids: {rates: {over: {rate: [1, 2.5, 4]}}}")
    with pytest.raises(RunnerError, match=rf"grid 'rates': axis 'rate' has 3 levels, no place {place}"):
        grids.level("rates", "rate", place)
