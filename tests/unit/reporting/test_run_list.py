"""The list of a sweep's runs, on the page and on paper."""

import base64
import json

import numpy as np
import pytest
from support.sample_document import HOSTILE, run_list

from runner.reporting.markup import spans
from runner.reporting.render import ON_PAPER, first_runs, run_list_spec


def test_columns_keep_their_order():
    spec = run_list_spec(run_list())
    assert spec["levels"] == [[0, 1]]
    assert [metric["name"] for metric in spec["metrics"]] == ["words", "peak"]
    values = [np.frombuffer(base64.b64decode(column), dtype="<f4") for column in spec["values"]]
    assert np.allclose(values, [[1.0, 2e-5], [np.nan, 3.0]], equal_nan=True)
    assert spec["folders"] == ["", "../../runs/x/"]


def test_paper_lists_axes_status_and_metrics():
    block = run_list("a")
    header, *rows = first_runs(block).lines
    assert header == ["run", "a", "status", "a (m)", "peak"]
    assert rows == [["abababab", "a", "ok", "1", "–"], ["cdcdcdcd", "1", "failed", "2·10⁻⁵", "3"]]


def test_paper_lists_the_first_runs_only():
    many = run_list(levels=np.zeros((50, 1), dtype=int), values=np.zeros((50, 2)), hashes=["ab"] * 50,
                    failures=[""] * 50)  # fmt: skip
    assert len(first_runs(many).rows) == ON_PAPER


@pytest.mark.parametrize("text", HOSTILE)
def test_no_text_becomes_mathematics_and_all_is_json(text):
    block = run_list(text)
    cells = [cell for line in first_runs(block).lines for cell in line]
    assert not any(span.math for cell in cells for span in spans(cell))
    json.dumps(run_list_spec(block), allow_nan=False).encode()
