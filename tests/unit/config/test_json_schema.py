"""The JSON Schema of configs: its keys are those of the models, and our own files fit it."""

import json

import pytest
import yaml

from runner.base.errors import RunnerError
from runner.base.paths import conf_dir
from runner.config.compose.files import group_options, place_in
from runner.config.groups import GROUPS
from runner.config.json_schema import json_schema

FILES = [place_in(conf_dir(), f"{group}/{name}.yaml") for group in GROUPS for name in group_options(group)]
NEEDS = {"bullet": pytest.mark.bullet}  # the schema names the plants that are installed


def misfit(value, schema, place=""):
    """Return the place of a misfit to the parts of JSON Schema that the runner uses; empty if the value fits."""
    if "anyOf" in schema:
        found = [misfit(value, form, place) for form in schema["anyOf"]]
        return "" if "" in found else max(found, key=len)
    if "enum" in schema:
        return "" if value in schema["enum"] else f"{place}: {value}"
    kinds = schema.get("type", [])
    known = {"null": type(None), "boolean": bool, "string": str, "array": list, "object": dict, "integer": int}
    known["number"] = (int, float)
    allowed = [kinds] if isinstance(kinds, str) else kinds
    if allowed and not any(isinstance(value, known[kind]) for kind in allowed):
        return f"{place}: {value}"
    if "exclusiveMinimum" in schema and isinstance(value, (int, float)) and value <= schema["exclusiveMinimum"]:
        return f"{place}: {value}"
    if "pattern" in schema and isinstance(value, str) and not value.startswith("${"):
        return f"{place}: {value}"
    if isinstance(value, dict) and "properties" in schema:
        unknown = [key for key in value if key not in schema["properties"]]
        if unknown:
            return f"{place}.{unknown[0]}: unknown"
        found = (misfit(item, schema["properties"][key], f"{place}.{key}") for key, item in value.items())
        return next(filter(None, found), "")
    return ""


@pytest.mark.parametrize(
    "path",
    [pytest.param(path, id=f"{path.parent.name}/{path.stem}", marks=NEEDS.get(path.stem, ())) for path in FILES],
)
def test_our_files_fit(path):
    text = path.read_text()
    values = yaml.safe_load(text) or {}
    group = "" if "_global_" in text.partition("\n")[0] else path.parent.name
    assert misfit(values, json_schema(group)) == ""


def test_a_wrong_key_or_value_does_not_fit():
    assert misfit({"kp": 1.0}, json_schema("trajectory")) == ".kp: unknown"
    assert misfit({"repetitions": "many"}, json_schema())
    assert misfit({"plant": {"step": -1.0}}, json_schema())


def test_keys_have_their_meaning_and_values_with_units_are_allowed():
    period = json_schema("controller")["properties"]["period"]
    assert "in s" in period["description"]
    assert misfit("20ms", period) == ""
    assert misfit("${robot.period}", period) == ""


def test_kinds_are_listed_and_the_text_is_json():
    assert "operational_space" in json_schema("controller")["properties"]["kind"]["enum"]
    text = json.dumps(json_schema())
    assert json.loads(text)["additionalProperties"] is False
    assert "$ref" not in text


def test_an_unknown_group_is_refused_with_the_nearest():
    with pytest.raises(RunnerError, match="Did you mean 'controller'"):
        json_schema("controler")
