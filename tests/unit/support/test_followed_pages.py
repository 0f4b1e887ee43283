"""The follower of pages against small pages: what it reads, what it types, and what it complains of."""

import pytest
from support.pages import Step, complaints, follow, steps, wrong_snippets

PAGE = """\
# A page

    $ echo one
    one

## First

    $ echo two \\
        three
    two...

    $ cat > file <<'END'
    a: $ 1

      b: 2
    END
    $ cat file

Not indented.

    no command

```console
$ not typed
```

## Second

    $ false
    $ echo $?
    1
"""


@pytest.fixture
def page(tmp_path):
    """Write a page."""

    def write(text):
        (tmp_path / "page.md").write_text(text)
        return tmp_path / "page.md"

    return write


def test_commands_are_read_with_what_is_shown_and_to_their_ends(page):
    assert steps(page(PAGE)) == [
        Step("echo one", ("one",)),
        Step("echo two \\\n    three", ("two...",)),
        Step("cat > file <<'END'\na: $ 1\n\n  b: 2\nEND", ()),
        Step("cat file", ()),
        Step("false", ()),
        Step("echo $?", ("1",)),
    ]


def test_a_beginning_ends_with_its_section(page):
    assert [step.command for step in steps(page(PAGE), until="First")][-1] == "cat file"
    assert steps(page(PAGE), until="Second") == steps(page(PAGE))


def test_a_page_that_shows_what_is_printed_gives_no_complaint(page, tmp_path):
    ended = follow(steps(page(PAGE)), tmp_path)
    assert complaints(ended) == []
    assert ended[3].printed == "a: $ 1\n\n  b: 2\n"


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("$ printf 'a\\nb\\n'\nb\na", "does not print, in its place,\na\n"),
        ("$ echo ab\na", "does not print, in its place,\na\n"),
        ("$ echo ab\nb...", "does not print, in its place,\nb...\n"),
        ("$ (exit 3)", "ends with 3 instead of 0"),
        ("$ false\n$ echo $?\n2", "does not print, in its place,\n2\n"),
        ("$ echo '1 problem in the config:'\n1 problem in the config:", "ends with 0 instead of 2"),
        ("$ test -n \"$USER$PYTHONPATH$RUNNER_PLUGINS\"", "ends with 1 instead of 0"),
    ],
    ids=["order", "whole line", "start", "code", "other code", "no refusal", "nothing but HOME and PATH"],
)  # fmt: skip
def test_each_difference_is_a_complaint(page, tmp_path, text, said):
    (found,) = complaints(follow(steps(page("\n".join(f"    {line}" for line in text.splitlines()))), tmp_path))
    assert said in found


def test_names_of_stored_folders_are_three_dots_and_a_refusal_ends_with_2(page, tmp_path):
    name = "outputs/runs/" + "0123456789ab" * 2
    text = f"    $ echo {name}\n    outputs/runs/...\n    $ echo '2 problems in the config'; test 1 -gt a\n"
    assert complaints(follow(steps(page(text + "    2 problems in the config\n")), tmp_path)) == []


@pytest.mark.parametrize(
    ("text", "wrong"),
    [
        (">>> 1 + 1\n2\n", False),
        (">>> 1 + 1\n3\n", True),
        ("```python\na = 1\n```\ntext\n```python\nassert a == 1\n```\n", False),
        ("```python\nassert False\n```\n", True),
        ("```yaml\nassert: False\n```\n", False),
    ],
    ids=["right", "wrong", "one namespace", "raises", "no Python"],
)
def test_python_of_a_page_is_run(page, text, wrong):
    assert bool(wrong_snippets(page(text))) is wrong
