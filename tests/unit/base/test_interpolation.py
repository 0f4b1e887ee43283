"""References between keys: free ones pass; functions and references that multiply are refused with their line."""

import pytest

from runner.base.bounded_yaml import YamlError, check_yaml
from runner.base.dotted_keys import check_references
from runner.base.errors import ConfigError
from runner.base.paths import conf_dir, studies_dir
from runner.config.compose.overrides import force


def test_files_of_ours_refer_to_keys_alone():
    for path in (*conf_dir().rglob("*.yaml"), *studies_dir().glob("*/experiment/*.yaml")):
        check_yaml(path.read_text(), path.name)


@pytest.mark.parametrize("value", ["${robot.goal}", "${.x}", "${a.b[0]}_${ c }", "$ {oc.env:HOME}", "costs $5 {a: b}"])
def test_references_to_keys_are_free(value):
    check_yaml(f"a: '{value}'", "f")


@pytest.mark.parametrize(
    "text",
    [
        "b: ${oc.env:HOME}",
        r"b: '\${oc.env:HOME}'",
        r'b: "\x24{oc.env:HOME}"',
        "b: [1, {c: 'x${ oc.env : HOME }'}]",
        "b: ${${c}:HOME}",
        "b: ${a.${c}}",
        "b: ${oc.decode:'1e400'}",
        "b: ${oc.create:${trap}}",
        "b: ${now:%H}",
        "${oc.env:HOME}: b",
    ],
)
def test_functions_in_a_file_are_refused_with_their_line(text):
    with pytest.raises(YamlError, match=r"own\.yaml, line 2: .* calls a function; a file may only refer to keys"):
        check_yaml(f"a: 1\n{text}", "own.yaml")


@pytest.mark.parametrize(
    "override",
    [
        "a=${oc.env:HOME}",
        "a='${oc.env:HOME}'",
        r"a=$\{oc.env:HOME\}",
        r"a=\${oc.env:HOME}",
        "a=[1,{b: ${now:%H}}]",
        "a=1,${hydra:run.dir}",
        "a=${${b}:HOME}",
        "${oc.env:HOME}=1",
    ],
)
def test_functions_in_an_override_are_refused(override):
    with pytest.raises(ConfigError, match="calls a function; a value may only refer to keys"):
        force([override])


@pytest.mark.parametrize("override", ["a=${robot.period}", "a='${.x}'", "a=[${b},1]", "a={b: ${ c.d }}", "a=x$y"])
def test_references_to_keys_in_an_override_are_free(override):
    assert force([override]) == [f"++{override}"]


def doubling(first, double):
    return {"a0": first, **{f"a{n}": double(f"${{a{n - 1}}}") for n in range(1, 60)}}


@pytest.mark.parametrize(
    "config",
    [
        doubling("x" * 100, lambda reference: reference * 2),
        doubling([1, 2, 3], lambda reference: [reference, reference]),
        {"a": "x" * 200_000, "b": "${a}" * 5000},
        {"list": [0] * 8000, **{f"a{n}": "${list}" for n in range(3)}},
    ],
)
def test_references_that_multiply_are_refused(config):
    with pytest.raises(ConfigError, match="stands for too many values, by its references"):
        check_references(config)


@pytest.mark.parametrize(
    ("config", "problem"),
    [
        ({"a": "${b}", "b": "${a}"}, "a: refers to itself, by way of b"),
        ({"a": {"b": "${a}"}}, "a: refers to itself, by way of a.b"),
        ({"a": {"b": "${.b}"}}, "a.b: refers to itself, by way of a.b"),
        ({"a": [{"c": "${a[0]}"}]}, "a.0: refers to itself"),
        ({f"a{n}": f"${{a{n + 1}}}" for n in range(5000)}, "deeper than 60 levels"),
    ],
)
def test_references_in_a_circle_and_long_chains_are_refused(config, problem):
    with pytest.raises(ConfigError) as raised:
        check_references(config)
    assert problem in str(raised.value)


def test_references_between_neighbours_and_to_nothing_pass():
    check_references({"a": {"b": 1, "c": "${a.b}", "d": "${.b}", "e": "${..f.0}"}, "f": ["${a.c}", "${nope.x}", "???"]})
