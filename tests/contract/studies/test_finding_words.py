"""Numbers in the words of findings come from runs, or are levels of an axis."""

import pytest
from support.finding_words import typed_in_module

from runner.base.paths import package_dir
from runner.papers.study.check import levels_in, typed_numbers
from runner.papers.study.study import load_study


@pytest.mark.parametrize("study", ["thesis", "thesis_beyond", "xarm7", "meca500", "engines", "benchmark"])
def test_no_number_is_typed_in_the_words_of_a_finding(study):
    made = load_study(study)
    levels = levels_in(made.parts().values())
    texts = {path: path.read_text(encoding="utf-8") for path in sorted(made.folder.glob("*.md"))}
    assert [told for path, text in texts.items() for told in typed_numbers(path.name, text, levels)] == []
    assert [path.name for path in made.folder.rglob("*.py") if "finding(" in path.read_text(encoding="utf-8")] == []


def test_no_finding_of_all_studies_has_one():
    assert [told for path in (package_dir() / "reporting").rglob("*.py") for told in typed_in_module(path, set())] == []


def lint(tmp_path, words, *names):
    module = tmp_path / "module.py"
    module.write_text(f"def conclude(error):\n    more = f'about 7 m'\n    return finding({words})\n")
    return [told.split(": ")[1] for told in typed_in_module(module, levels_in(names))]


def test_the_lint_finds_typed_numbers_and_no_others(tmp_path):
    assert lint(tmp_path, "'Small', f'It is {error} at 12 s and 0.2 kg.', error < 2.0") in (
        ["12 s", "0.2 kg"],
        ["0.2 kg", "12 s"],
    )
    assert lint(tmp_path, "'3 times as good', f'{error} {more}'") == ["3 times", "7 m"]
    assert lint(tmp_path, "'6b. Figure 5.3, page 65 and claim 8', f'$x_3 = 4$ of {error:.3g} (3.32), joint 2'") == [
        "3.32"
    ]
    levels = (("case", "servo, 16.7 ms"), ("axis", "1 ms"))
    assert lint(tmp_path, "'At 1 ms', f'and 16.7 ms {error}'", levels) == []
