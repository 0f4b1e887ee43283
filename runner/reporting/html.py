"""Report as a self-contained HTML file that needs no network."""

import base64
import gzip
import hashlib
import json
from collections.abc import Sequence
from functools import cache, lru_cache
from importlib import resources
from urllib.parse import quote

from runner.base import progress
from runner.base.paths import templates_dir
from runner.reporting import formulas, outline
from runner.reporting.charts import palette
from runner.reporting.charts.interactive import plotly_spec
from runner.reporting.document import Curves, Document, Maps, Playback, RunList
from runner.reporting.outline import Places
from runner.reporting.playback import playback_spec
from runner.reporting.run_list import run_list_spec
from runner.reporting.templating import Code, html_environment
from runner.reporting.verdicts import tallies

_OF_PLOTS = ("plot_keys", "curves")
_SCRIPTS = ("report", *_OF_PLOTS, "motion", "figure_tools")


def render(document: Document) -> str:
    """Return a document as an HTML page."""
    progress.begin("writing the HTML")
    made = formulas.all_mathml(document)
    has_plots, has_run_list, has_playback = (
        any(isinstance(block, kinds) for block in outline.blocks(document))
        for kinds in ((Curves, Maps, RunList), RunList, Playback)
    )
    library = _plotly() if has_plots else ""
    left_out = (() if has_plots else _OF_PLOTS) + (() if has_plots or has_playback else ("motion",))
    return (
        html_environment()
        .get_template("report.html.j2")
        .render(
            document=document,
            chapters=outline.chapters(document),
            mathml=lambda text, is_displayed: made[is_displayed].get(text.strip()),
            math_font=_math_font() if any(made.values()) else "",
            plotly_spec=plotly_spec,
            run_list_spec=run_list_spec,
            data_uri=data_uri,
            tallies=tallies(document),
            places=Places(document),
            plots=_Pack(),
            pictures=_Pack(),
            playback_spec=playback_spec,
            plotly=compress_text(library) if library else "",
            script_sources=lambda own: script_policy([*own, *([library] if library else [])]),
            palette={"light": palette.LIGHT, "dark": palette.DARK},
            style=asset("style.css"),
            scripts=[asset(f"{name}.js") for name in _SCRIPTS if name not in left_out],
            run_list_script=asset("run_list.js") if has_run_list else "",
        )
    )


def data_uri(svg: str) -> str:
    """Return an SVG as the address of an image; images share no ids and run no scripts."""
    return "data:image/svg+xml," + quote(svg, safe=" /:=;()+*!@?", encoding="utf-8", errors="replace")


class _Pack:
    """Data of plots, or pictures, which the page's script unpacks; figures name them by their places."""

    def __init__(self) -> None:
        self._items: list[object] = []

    def put(self, item: object) -> int:
        """Take an item, and return its place."""
        self._items.append(item)
        return len(self._items) - 1

    def packed(self) -> str:
        """Return all items as the page holds them."""
        return compress_text(json.dumps(self._items, separators=(",", ":"))) if self._items else ""


@lru_cache(maxsize=16)
def compress_text(text: str) -> str:
    """Return a string as base64 of its gzip, the same each time; `inflate` in report.js undoes it."""
    return base64.b64encode(gzip.compress(text.encode("utf-8"), compresslevel=9, mtime=0)).decode("ascii")


@cache
def _plotly() -> str:
    return resources.files("plotly").joinpath("package_data", "plotly.min.js").read_text(encoding="utf-8")


@cache
def _math_font() -> str:
    return base64.b64encode((templates_dir() / "maths.woff2").read_bytes()).decode("ascii")


def script_policy(scripts: Sequence[str]) -> Code:
    """Return the sources of some scripts in a policy."""
    return Code(" ".join(f"'sha256-{_sha256(script)}'" for script in scripts))


def _sha256(text: str) -> str:
    return base64.b64encode(hashlib.sha256(text.encode()).digest()).decode("ascii")


def asset(name: str) -> Code:
    """Return a style or a script of the templates."""
    return Code((templates_dir() / name).read_text(encoding="utf-8"))
