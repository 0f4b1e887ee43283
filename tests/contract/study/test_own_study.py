"""A study in a user's folder: written, read, simulated and checked, and its messages if something is wrong."""

import re
import sys
from pathlib import Path

import pytest
from support.pdf_text import pages

from runner.base.errors import RunnerError
from runner.base.paths import example_study_dir
from runner.cli.main import dispatch
from runner.papers.study.chapters import Chapters
from runner.papers.study.check import problems
from runner.papers.study.execute import make_all
from runner.papers.study.measured import findings
from runner.papers.study.names import find_study, study_names, write_new
from runner.papers.study.report import study_document
from runner.papers.study.results import Results
from runner.papers.study.study import load_study
from runner.reporting.document import Table
from runner.reporting.render import render_html, render_pdf
from runner.sweeps.job import run

ABOUT = "title: T\nsource: S\nabstract: A\nchapters: [one.md]\n"
RUNS = """\
grids:
  goal:
    with: [robot=macro, trajectory=quintic, caveats.short_horizon.share=20]
    over:
      preset: {slow: controller.natural_frequency=5, fast: controller.natural_frequency=10}
      duration: [0.05, 0.1]
"""
CHAPTER = """\
# One

{% set error = metric("goal/slow/0.1", "max_tracking_error", "largest error") %}

{{ table("Errors.", "goal/{preset}/{duration}", level("preset"), column("error", "max_tracking_error")) }}

::: finding It errs
It errs by {{ error }}.
holds: error > 1e-9
:::
"""


def a_study(folder: Path, **files: str) -> Path:
    """Write a small study; files by name, with `__` for the dot."""
    folder.mkdir(exist_ok=True)
    for name, text in ({"study__yaml": ABOUT, "runs__yaml": RUNS, "one__md": CHAPTER} | files).items():
        (folder / name.replace("__", ".")).write_text(text, encoding="utf-8")
    return folder


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """The runs of the small study, by name."""
    root = tmp_path_factory.mktemp("made")
    jobs = load_study(str(a_study(root / "paper"))).jobs()
    return {name: run(*job, f"outputs={root}") for name, job in jobs.items()}


def chapters(study, runs, missing=None):
    return Chapters(study, study.results(runs, missing), Results({}))


def read(folder, runs, **options):
    study = load_study(str(folder), **options)
    return study, chapters(study, runs).sections()


@pytest.mark.costs(5)
def test_the_study_that_is_written_first_is_small_and_stands(tmp_path, capsys):
    folder = tmp_path / "paper"
    assert dispatch(["study", "new", str(folder)]) == 0
    texts = {path.name: path.read_text() for path in folder.iterdir()}
    assert sorted(texts) == ["claims.yaml", "goal.md", "runs.yaml", "study.yaml"]
    lines = [line for text in texts.values() for line in text.splitlines()]
    assert len(lines) <= 45
    assert max(map(len, lines)) <= 100
    outputs = f"--output={tmp_path / 'outputs'}"
    assert dispatch(["reproduce", str(folder), outputs, "--check"]) == 0
    report = Path(capsys.readouterr().out.splitlines()[-1])
    assert report == tmp_path / "outputs" / "reports" / "paper"
    assert {"report.html", "report.pdf", "conclusions.json"} <= {path.name for path in report.iterdir()}
    assert dispatch(["study", "check", str(folder), outputs]) == 0
    assert "nothing is wrong" in capsys.readouterr().out


def test_answers_of_the_first_chapter_open_the_report(tmp_path, made):
    answer = CHAPTER.replace("# One", "# Does it err?").replace("::: finding It errs\n", "::: stands It does.\n")
    files = {"study__yaml": ABOUT.replace("[one.md]", "[answers.md, one.md]"), "answers__md": answer}
    study = load_study(str(a_study(tmp_path / "paper", **files)))
    assert [*problems(chapters(study, made))] == []
    studies = (load_study(str(a_study(tmp_path / "paper", **own))) for own in ({}, files))
    plain, opened = (study_document(chapters(each, made)) for each in studies)
    assert (plain.answers, [each.title for each in opened.answers]) == ([], ["It does."])
    assert all(finding[1].claim != "It does." for finding in findings(plain))
    assert [number for number, each in findings(opened) if each.claim == "It does."] == ["1"]
    page = render_html(opened)
    places = [
        page.index(text) for text in ("Does it err?</h2>", "It does.", ">A</p>", "Errors.", "</header>", "One</h2>")
    ]
    assert places == sorted(places)
    assert page.count("It does.") == 1
    text = " ".join(" ".join(pages(render_pdf(opened))).split())
    places = [text.index(words) for words in ("Does it err?", "It does.", "Errors.", "Contents", "2 One")]
    assert places == sorted(places)
    assert text.count("It does.") == 1


def test_the_first_study_is_not_written_over_something(tmp_path):
    (tmp_path / "mine.txt").write_text("mine")
    with pytest.raises(RunnerError, match="exists and is not empty"):
        write_new(tmp_path)


def test_its_chapters_read_its_runs(tmp_path, made):
    study, (chapter,) = read(a_study(tmp_path / "paper"), made)
    (table, finding) = chapter.blocks
    assert isinstance(table, Table)
    assert table.lines[0] == ["preset", "error (mm)"]
    assert [row[0] for row in table.lines[1:]] == ["slow", "slow", "fast", "fast"]
    assert finding.holds
    assert [*problems(chapters(study, made))] == []


@pytest.mark.parametrize(
    ("holds", "words", "told"),
    [
        ("holds: error > 1e-9", "It errs by 3.2 m.", r"paper/one.md:7: 3.2 m: a number typed in a finding goes stale"),
        ("holds: error > -1e9", "It errs.", r"paper/one.md:8: holds: error > -1e9: no change of a named value"),
        ("holds: error > 1e9", "It errs.", r"It errs: not so: largest error > 1·10⁹ m"),
        ("holds: errr > 1e-9", "It errs.", r"paper/one.md:8: .*no name 'errr' \(did you mean error\?\)"),
    ],
)
def test_what_is_wrong_with_a_study_is_told_with_its_place(tmp_path, made, holds, words, told):
    text = CHAPTER.replace("holds: error > 1e-9", holds).replace("It errs by {{ error }}.", words)
    text = "\n".join(line for line in text.splitlines() if not line.startswith("{{ table"))
    study = load_study(str(a_study(tmp_path / "paper", one__md=text)))
    found = [*problems(chapters(study, made))]
    assert len(found) == 1
    assert re.search(told, found[0]), found


@pytest.mark.costs(3)
def test_reproduce_with_check_finds_what_study_check_finds(tmp_path, capsys):
    chapter = CHAPTER + "\n::: finding Small\nIt is 3.2 m.\nholds: error < 1e-9\nholds: error > -1e9\n:::\n"
    short = RUNS.replace("[0.05, 0.1]", "[0.1]").replace(", caveats.short_horizon.share=20", "")
    folder, outputs = a_study(tmp_path / "paper", one__md=chapter, runs__yaml=short), f"--output={tmp_path / 'outputs'}"
    assert dispatch(["study", "check", str(folder), outputs]) == 1
    *checked, count = capsys.readouterr().out.splitlines()
    assert dispatch(["reproduce", str(folder), outputs, "--check"]) == 1
    told = capsys.readouterr().err.splitlines()
    assert [line.removeprefix("runner: paper: ") for line in told if line.startswith("runner: paper: ")] == checked
    assert count == f"{len(checked)} problems"
    for problem in ("3.2 m: a number typed", "> -1e9: no change of a named value", "not so: largest error", "horizon"):
        assert any(problem in line for line in checked), checked
    assert dispatch(["reproduce", str(folder), outputs]) == 0


def test_caveats_that_no_run_can_have_are_told(tmp_path, made):
    caveats = "- {rules: [saturation], runs: [gaol/*], why: So.}\n"
    study = load_study(str(a_study(tmp_path / "paper", caveats__yaml=caveats)))
    assert [*problems(chapters(study, made))] == ["paper: gaol/*: expected caveats: no run of it is named so"]


def test_a_cover_shows_a_run_in_motion_and_one_that_is_none_is_told(tmp_path, made):
    def with_cover(run):
        return load_study(
            str(a_study(tmp_path / "paper", study__yaml=ABOUT + f"cover: {{run: {run}, caption: It moves.}}\n"))
        )

    assert "<animate" in study_document(chapters(with_cover("goal/slow/0.1"), made)).cover.moving
    study = with_cover("goal/slwo/0.1")
    assert study_document(chapters(study, made)).cover is None
    (told,) = problems(chapters(study, made))
    assert re.search(r"paper/study.yaml: cover: no run 'goal/slwo/0.1' \(did you mean goal/slow/0.1\?\)", told), told


def test_a_part_has_sections_and_a_file_of_python_is_a_chapter(tmp_path, made):
    about = "title: T\nsource: S\nabstract: A\nchapters: [{title: Part, sections: [one.md, two.py]}]\n"
    code = (
        "from runner.reporting.document import Section\ndef section(runs):\n    return Section(f'{len(runs)} runs')\n"
    )
    folder = a_study(tmp_path / "paper", study__yaml=about, two__py=code)
    _, (part,) = read(folder, made, allow_code=True)
    assert [section.title for section in part.sections] == ["One", "4 runs"]
    _, (part,) = read(folder, made)
    assert part.sections[1].title == "Left out: two.py"
    assert "two.py was not run: code in a folder runs only with --code" in part.sections[1].blocks[0].text


def test_functions_of_the_study_are_called_where_code_may_run(tmp_path, made):
    chapter = "# One\n\nThere are {{ count() }} runs, {{ twice(2) }}.\n"
    folder = a_study(
        tmp_path / "paper",
        one__md=chapter,
        figures__py="def count(runs):\n    return len(runs)\n",
        one__py="from functools import cache\n\n\n@cache\ndef twice(x):\n    return 2 * x\n",
    )
    _, (section,) = read(folder, made, allow_code=True)
    assert section.blocks[0].text == "There are 4 runs, 4."
    _, (section,) = read(folder, made)
    assert section.title == "Left out: One"
    assert "not run" in study_document(chapters(load_study(str(folder)), made)).sections[-2].blocks[1].rows[-1][1]


def test_code_that_cannot_be_imported_is_told(tmp_path, made):
    folder = a_study(tmp_path / "paper", figures__py="1 / 0\n")
    with pytest.raises(RunnerError, match=r"figures.py cannot be imported: .*division by zero"):
        read(folder, made, allow_code=True)


def test_a_run_that_was_not_made_leaves_its_chapter_out(tmp_path, made):
    study = load_study(str(a_study(tmp_path / "paper")))
    runs = {name: each for name, each in made.items() if name != "goal/slow/0.1"}
    (section,) = chapters(study, runs, {"goal/slow/0.1": "cut short"}).sections()
    assert section.title == "Left out: One"
    assert "goal/slow/0.1: cut short" in section.blocks[0].text


def test_a_profile_makes_other_levels(tmp_path):
    about = ABOUT + "profiles: {quick: {repetitions: 3, levels: {goal: {duration: [0.2], preset: [slow]}}}}\n"
    folder = a_study(tmp_path / "paper", study__yaml=about)
    jobs = load_study(str(folder), profile="quick").jobs()
    assert list(jobs) == ["goal/slow/0.2"]
    assert jobs["goal/slow/0.2"][-2:] == ("duration=0.2", "repetitions=3")
    assert len(load_study(str(folder)).jobs()) == 4
    assert sorted(load_study(str(folder), profile="quick").dropped()) == sorted(load_study(str(folder)).jobs())
    with pytest.raises(RunnerError, match=r"no profile 'quik' \(did you mean quick\?\); profiles: quick"):
        load_study(str(folder), profile="quik")


@pytest.mark.parametrize(
    ("files", "told"),
    [
        ({"study__yaml": "title: T\n"}, r"study.yaml: source: Field required .*chapters: Field required"),
        ({"study__yaml": ABOUT.replace("one.md", "on.md")}, r"study.yaml: chapters: on.md: must be .*mean one.md\?\)"),
        ({"study__yaml": ABOUT + "in_al: false\n"}, r"study.yaml: in_al: unknown key"),
        ({"study__yaml": "title: [\n"}, r"study.yaml, line 2"),
        ({"runs__yaml": "grids: {goal: {wiht: []}}\n"}, r"runs.yaml: grids.goal.*wiht"),
        ({"caveats__yaml": "- {rules: [satration], runs: [a], why: W.}\n"}, r"no rule 'satration' \(did you mean satu"),
        ({"caveats__yaml": "- {rules: [saturation], runs: [a]}\n"}, r"caveats.yaml: 0.why: Field required"),
        (
            {"study__yaml": ABOUT + "profiles: {quick: {levels: {goal: {preset: [slaw]}}}}\n"},
            r"grid 'goal': axis 'preset' has no level 'slaw' \(did you mean slow\?\)",
        ),
    ],
)
def test_data_that_do_not_fit_are_refused_with_file_and_key(tmp_path, files, told):
    with pytest.raises(RunnerError, match=told):
        load_study(str(a_study(tmp_path / "paper", **files)), profile="quick" if "quick" in str(files) else "")


def test_what_is_no_study_is_told(tmp_path):
    told = r"no study 'tesis' \(did you mean thesis\?\); studies: benchmark, engines, meca500, precision, thesis, "
    told += "thesis_beyond, xarm7"
    with pytest.raises(RunnerError, match=told):
        find_study("tesis")
    with pytest.raises(RunnerError, match=r"no study: there is no study.yaml in it; `runner study new"):
        find_study(str(tmp_path))
    with pytest.raises(RunnerError, match="is the name of an installed study; rename the folder"):
        find_study(str(a_study(tmp_path / "thesis")))


def test_an_installed_package_is_a_study_by_its_entry_point(tmp_path, made, monkeypatch):
    package = a_study(tmp_path / "a_paper", one__md="# One\n\n{{ count() }} runs.\n")
    (package / "__init__.py").write_text("")
    (package / "one.py").write_text("def count(runs):\n    return len(runs)\n")
    info = tmp_path / "a_paper-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: a-paper\nVersion: 1.0\n")
    (info / "entry_points.txt").write_text("[runner.studies]\nsmith_2020 = a_paper\n")
    monkeypatch.setattr(sys, "path", [str(tmp_path), *sys.path])
    assert "smith_2020" in study_names()
    _, (section,) = read("smith_2020", made)
    assert section.blocks[0].text == "4 runs."


def test_the_example_is_what_is_written():
    assert {path.name for path in example_study_dir().iterdir()} >= {
        "study.yaml",
        "runs.yaml",
        "claims.yaml",
        "goal.md",
    }


def test_its_printed_equations_are_judged_by_yaml_alone(tmp_path, made):
    folder = a_study(tmp_path / "paper", one__md='# One\n\n{{ equations("All.") }}\n')
    (folder / "equations").mkdir()
    entry = '- {id: %s, number: "1", place: p. 1, title: H, derivation: model.position, printed: {elements: {%s}}%s}'
    right = "cos(q2 + q3) + sin(q2)"
    corrected = f", corrected: {{elements: {{P_z: {right}}}}}"
    entries = [entry % ("a", f"P_z: {right}", ""), entry % ("b", "P_z: sin(q2)", corrected)]
    (folder / "equations" / "1.yaml").write_text("\n".join(["robot: macro", "entries:", *entries]))
    _, (section,) = read(folder, made)
    assert [row.verdict for row in section.blocks[0].rows] == ["correct", "wrong as printed"]
    stated = [f"- {{name: {name}, statement: S, place: p. 1}}" for name in ("height", "yields", "safe", "fast")]
    (folder / "statements.yaml").write_text("\n".join(stated))
    judged = '{"height": ["b", "m"], "yields": [[True], "m"], "safe": ["undecided", "m"], "fast": [[True, False], "m"]}'
    (folder / "one.md").write_text(f'# One\n\n{{{{ statements("All.", {judged}) }}}}\n')
    _, (section,) = read(folder, made)
    verdicts = [row.findings[0].verdict for row in section.blocks[0].rows]
    assert verdicts == ["wrong as printed", "matches", "undecided", "differs"]
    (folder / "one.md").write_text(f'# One\n\n{{{{ statements("All.", {judged.replace("b", "c")}) }}}}\n')
    with pytest.raises(RunnerError, match=r"no equation .c. in the folder.*; or write .undecided."):
        read(folder, made)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("sin(q2)}", "sin(q7)}", r"line 3: height: P_z, position 20: no name 'q7' \(did you mean"),
        ("cos(q2 + q3) + sin(q2)", "'[1, 2] @ [3, 4]'", r"height: P_z, position 10: .* a vector of 2 @ a vector of 2"),
        ("P_z: cos(q2 + q3) + sin(q2)", "P: '[q1, q2]'", "height: P is a vector of 2; its true value is a vector of 3"),
        ("unit: m", "letters: {q2: frac(1}", r"line 3: height: no formula in Typst's notation: .*frac\(1"),
        ("title: Height", "title: Height, finding: Holds $frac(1$", r"no formula in Typst's notation: frac\(1"),
        ("+ sin(q2)", "- sin(q2)", "line 3: height: is wrong by .* and has no correction"),
        (
            "unit: m",
            "truth: model.position",
            r"1.yaml: entries.0 \(1\).truth: unknown key; keys: id, .*derivation.* \(line 4\)",
        ),
    ],
)
def test_an_equation_that_cannot_be_checked_is_told_before_anything_is_simulated(tmp_path, old, new, message):
    folder, outputs = a_study(tmp_path / "paper"), tmp_path / "outputs"
    (folder / "equations").mkdir()
    text = """robot: macro
entries:
- {id: height, number: '1', place: p. 1, title: Height, derivation: model.position,
   unit: m, printed: {elements: {P_z: cos(q2 + q3) + sin(q2)}}}
"""
    path = folder / "equations" / "1.yaml"
    path.write_text(text)
    load_study(str(folder)).check_equations()
    path.write_text(text.replace(old, new))
    with pytest.raises(RunnerError, match=message):
        make_all(load_study(str(folder)), outputs)
    assert not outputs.exists()


def test_all_equations_that_cannot_be_checked_are_told_at_once(tmp_path):
    folder = a_study(tmp_path / "paper")
    (folder / "equations").mkdir()
    entry = "- {id: %s, number: '1', place: p, title: t, derivation: model.position, printed: {elements: {P_z: %s}}}"
    lines = [entry % each for each in (("one", "q9"), ("two", "1"), ("three", "q2"))]
    (folder / "equations" / "1.yaml").write_text("\n".join(["robot: macro", "entries:", *lines]))
    with pytest.raises(RunnerError, match=r"(?s)line 3: one: .*line 4: two: is wrong .*line 5: three: is wrong"):
        load_study(str(folder)).check_equations()


def test_a_formula_that_cannot_be_read_is_told_with_its_line(tmp_path, made):
    study = load_study(str(a_study(tmp_path / "paper", one__md="# One\n\nSo.\n\nThis is $frac(1$.\n")))
    assert [*problems(chapters(study, made))] == ["paper/one.md:5: frac(1: no formula in Typst's notation"]


def test_claims_that_do_not_fit_are_told_before_anything_is_made(tmp_path):
    with pytest.raises(RunnerError, match=r"claims.yaml: 0.number: Field required"):
        load_study(str(a_study(tmp_path / "paper", claims__yaml="- {statement: S}\n")))


def test_what_a_profile_does_without_is_left_out_of_tables_and_of_the_chapters_that_name_it(tmp_path):
    text = '# One\n\n{{ table("Errors.", "goal/{preset}/{duration}", column("error", "max_tracking_error")) }}\n'
    about = ABOUT.replace("[one.md]", "[one.md, two.md]")
    about += "profiles: {quick: {levels: {goal: {duration: [0.05], preset: [slow]}}}}\n"
    folder = a_study(tmp_path / "paper", study__yaml=about, one__md=text, two__md=CHAPTER.replace("# One", "# Two"))
    outputs = f"--output={tmp_path / 'outputs'}"
    assert dispatch(["reproduce", str(folder), outputs, "--profile", "quick", "hydra.sweeper.workers=0"]) == 0
    page = (tmp_path / "outputs" / "reports" / "paper" / "report.html").read_text()
    assert "goal/slow/0.1: the profile quick has no such run" in page
    assert "Left out: Two" in page
    assert "Left out: One" not in page


LAW = """\
from typing import Literal

import numpy as np

from runner.controllers import Loop
from runner.plugins.registry import StrictModel


class CONFIG(StrictModel):
    kind: Literal["resting"]
    period: float


class Resting:
    def reset(self):
        pass

    def torque(self, time, q, dq, reference):
        return np.zeros(len(q))


def build(config, robot):
    return (Loop("arm", slice(0, robot.model.nq), config.period, Resting()),)
"""


def test_a_controller_of_the_study_runs_with_code_and_its_command_names_it(tmp_path, monkeypatch, capsys):
    monkeypatch.setenv("RUNNER_PLUGINS", "")
    monkeypatch.chdir(tmp_path)
    folder = a_study(
        tmp_path / "paper",
        study__yaml=ABOUT + "plugins: [controller=resting.py]\n",
        runs__yaml="grids: {rest: {with: [robot=macro, controller=resting, duration=0.02]}}\n",
        one__md='# One\n\n{{ table("Rest.", "rest", column("moved", "peak_torque")) }}\n',
        resting__py=LAW,
    )
    (folder / "controller").mkdir()
    (folder / "controller" / "resting.yaml").write_text("kind: resting\nperiod: 0.01\n")
    command = ["reproduce", "paper", "hydra.sweeper.workers=0"]
    assert dispatch(command) == 2
    told = "runner: paper: its runs need controller=resting.py: code in a folder runs only with --code"
    assert told in capsys.readouterr().err
    assert dispatch([*command, "--code"]) == 0
    page = (tmp_path / "outputs" / "reports" / "paper" / "report.html").read_text()
    assert "runner --config-dir paper --plugin controller=paper/resting.py robot=macro controller=resting" in page
