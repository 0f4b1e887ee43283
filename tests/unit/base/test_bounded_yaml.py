"""YAML from outside: what is within the bounds reads as PyYAML reads it, what is not is refused with its line."""

import pytest
import yaml

from runner.base.bounded_yaml import CONFIG, Bounds, YamlError, check_yaml, read_yaml
from runner.base.limits import Limit
from runner.base.paths import conf_dir, studies_dir


def bomb(levels):
    """Each level names the one before nine times."""
    names = [chr(ord("a") + level) for level in range(levels)]
    lines = ["a: &a [1, 1, 1, 1, 1, 1, 1, 1, 1]"]
    lines += [f"{name}: &{name} [{', '.join([f'*{before}'] * 9)}]" for before, name in zip(names, names[1:])]  # noqa: B905, RUF007
    return "\n".join(lines)


def test_what_is_sound_is_read_as_the_safe_loader_reads_it():
    text = 'a: &a {b: [1, 2.5, null], "on": x}\nc: *a\nd: {<<: *a, "1": 2}\n'
    assert read_yaml(text, "f") == yaml.safe_load(text)


def test_every_file_of_ours_is_within_the_bounds():
    for path in (*conf_dir().rglob("*.yaml"), *studies_dir().glob("*/experiment/*.yaml")):
        check_yaml(path.read_text(), path)


@pytest.mark.parametrize(
    ("text", "problem"),
    [
        ("a: 1\nb: " + "[" * 50_000, "line 2: nested deeper than 30 levels"),
        ("a: " + "{a: " * 3000, "line 1: nested deeper than 30 levels"),
        ("- " * 5000 + "a", "line 1: nested deeper than 30 levels"),
        ("\n".join("  " * level + "a:" for level in range(300)), "line 31: nested deeper than 30 levels"),
        (bomb(9), "line 5: the file stands for more than 10000 values"),
        ("a: [" + "1," * 20_000 + "1]", "line 1: the file stands for more than 10000 values"),
        ("x: 1\nrobot: &r {goal: *r}", "line 2: *r stands inside of &r"),
        ("&a [*a]", "line 1: *a stands inside of &a"),
        ("a: *b", "line 1: *b stands for nothing"),
        ("1: 2", "line 1: the key '1' is not a string"),
        ("a:\n  null: 2", "line 2: the key 'null' is not a string"),
        ("{yes: 1}", "line 1: the key 'yes' is not a string"),
        ("? [a]\n: b", "line 1: the key a collection is not a string"),
        ("a: !!python/object/apply:os.getcwd []", "line 1: the tag 'tag:yaml.org,2002:python/object/apply:os.getcwd'"),
        ("a: !!timestamp x", "line 1: the tag "),
        ("a: [", "line 2, column 1: "),
        ("a: \x01", "unacceptable character"),
        ("#" * 250_001, "has 250,001 bytes; allowed: up to 250,000"),
    ],
)
def test_what_no_loader_would_survive_is_told_with_its_line_before_it_is_read_whole(text, problem, monkeypatch):
    events, parse = [], yaml.parse

    def counted(*arguments, **options):
        for event in parse(*arguments, **options):
            events.append(event)
            yield event

    monkeypatch.setattr(yaml, "parse", counted)
    with pytest.raises(YamlError) as raised:
        check_yaml(text, "own/f.yaml")
    assert str(raised.value).startswith("own/f.yaml")
    assert problem in str(raised.value)
    assert len(events) <= CONFIG.values + 10  # begin and end of the text and of its collections


@pytest.mark.parametrize("text", ["a: 2001-13-45", "a: 2001-01-01T00:00:00+99:99", f"a: {'9' * 5000}"])
def test_numbers_and_dates_that_python_has_not_are_told(text):
    with pytest.raises(YamlError, match=r"^f\.yaml: "):
        read_yaml(text, "f.yaml")


def test_a_key_that_stands_twice_is_refused():
    with pytest.raises(YamlError, match=r"own.yaml, line 3: the key 'a' stands twice"):
        read_yaml("a: {b: 1}\nc: {a: 2}\na: 3\n", "own.yaml")


def test_aliases_count_as_what_they_stand_for():
    text = "a: &a [1, 2, 3]\nb: [*a, *a]"
    check_yaml(text, "f", Bounds(Limit(100, "bytes"), values=16))  # 4 of a, 9 of b, two keys and the whole
    with pytest.raises(YamlError, match="more than 15 values"):
        check_yaml(text, "f", Bounds(Limit(100, "bytes"), values=15))


def test_a_config_may_hold_thousands_of_way_points():
    check_yaml("points:\n" + "- [0.123456, 0.234567, 0.345678]\n" * 2400, "f", CONFIG)


@pytest.mark.parametrize(
    ("text", "number"), [("010", 8), ("1:30", 90), ("1:0.01", 60.01), ("0x10", 16), ("0b101", 5), ("-012", -10)]
)
def test_a_number_of_another_base_is_refused_with_what_it_is(text, number):
    with pytest.raises(
        YamlError, match=rf"^mine, line 2: {text} is not a decimal number, and YAML reads it as {number}; "
    ):
        read_yaml(f"a: 1\nb: [{text}]", "mine")


@pytest.mark.parametrize("text", ["'010'", '"1:30"', "1_000", "0", "0.5", "1e-3", "08", "12:90", "1.5:3x"])
def test_other_scalars_are_read(text):
    assert read_yaml(f"a: {text}", "mine")["a"] == yaml.safe_load(text)
