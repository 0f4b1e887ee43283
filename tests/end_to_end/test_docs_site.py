"""The site that `make docs` builds: every link resolves, nothing is loaded from elsewhere, search needs no server."""

import re
import subprocess
import sys
from html.parser import HTMLParser
from xml.etree import ElementTree

import pytest
import yaml
from support.pages import ROOT

import runner
from tools.docs.pictures import PICTURES

pytest.importorskip("mkdocs")
# Slow, as `make docs` builds the same site, as strictly; these look closer at what a second build gives.
OF_THE_SITE = pytest.mark.slow
LOADED = {"script": "src", "link": "href", "img": "src", "iframe": "src", "source": "src", "object": "data"}
ELSEWHERE = re.compile(r"(https?:)?//")


class _Page(HTMLParser):
    """Loaded files, links and anchors of a page."""

    def __init__(self):
        super().__init__()
        self.loaded, self.links, self.anchors = [], [], set()

    def handle_starttag(self, tag, attrs):
        values = dict(attrs)
        self.anchors.add(values.get("id"))
        if values.get(LOADED.get(tag)):
            self.loaded.append(values[LOADED[tag]])
        if tag == "a" and values.get("href"):
            self.links.append(values["href"])


def read(path):
    page = _Page()
    page.feed(path.read_text(encoding="utf-8"))
    return page


@pytest.fixture(scope="session")
def site(tmp_path_factory):
    """The site, strictly built, with a stub of the live report."""
    folder = tmp_path_factory.mktemp("site")
    (folder / "report.html").write_text("<title>A report</title>")
    changed = {
        "INHERIT": str(ROOT / "mkdocs.yml"),
        "docs_dir": str(ROOT / "docs"),
        "hooks": [str(ROOT / "tools" / "docs" / "site_pages.py")],
        "site_dir": str(folder / "built"),
        "extra": {"live_report": str(folder / "report.html")},
    }
    (folder / "mkdocs.yml").write_text(yaml.safe_dump(changed))
    command = [sys.executable, "-m", "mkdocs", "build", "--strict", "--config-file", folder / "mkdocs.yml"]
    ended = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    assert ended.returncode == 0, ended.stderr
    return folder / "built"


@pytest.fixture(scope="session")
def pages(site):
    """Its pages by path, except for the report."""
    return {path: read(path) for path in site.rglob("*.html") if path.name != "gallery_report.html"}


@OF_THE_SITE
def test_every_page_of_docs_is_in_it(site, pages):
    names = {path.relative_to(site).as_posix() for path in pages}
    assert {f"{page.stem}.html" for page in (ROOT / "docs").glob("*.md")} <= names
    assert {"index.html", "changelog.html", "contributing.html", "security.html"} <= names


@OF_THE_SITE
def test_every_link_leads_somewhere(pages):
    for path, page in pages.items():
        for link in page.links:
            if ELSEWHERE.match(link) or path.name == "404.html":
                continue
            name, _, anchor = link.partition("#")
            target = (path.parent / name).resolve() if name else path
            assert target.is_file(), (path.name, link)
            if anchor and target in pages:
                assert anchor in pages[target].anchors, (path.name, link)


@OF_THE_SITE
def test_no_page_loads_anything_from_elsewhere(site, pages):
    for path, page in pages.items():
        assert not [each for each in page.loaded if ELSEWHERE.match(each)], path.name
        assert "mermaid" not in path.read_text(), path.name  # for which the theme would load a script
    for path in site.rglob("*.css"):
        found = re.findall(r"(?:url\(|@import)\s*[\"']?([^\"')]+)", path.read_text())
        assert not [each for each in found if ELSEWHERE.match(each)], path.name


@OF_THE_SITE
def test_search_works_without_a_server(site, pages):
    assert (site / "search" / "search_index.js").read_text().startswith("var __index = ")
    for path, page in pages.items():
        if path.parent == site and path.name != "404.html":
            assert {"assets/iframe-worker.js", "assets/scrolling.js"} <= set(page.loaded), path.name


@OF_THE_SITE
def test_all_that_import_runner_gives_is_on_the_page_of_the_api(site, pages):
    anchors = pages[site / "api.html"].anchors - {None}
    for name in runner.__all__:
        assert [each for each in anchors if each.startswith("runner.") and each.endswith(f".{name}")], name


@OF_THE_SITE
def test_a_file_of_the_source_is_shown_where_a_page_links_to_it(site):
    shown = re.sub(r"<[^>]+>", "", (site / "source" / "runner" / "base" / "trace.py.html").read_text())
    assert (ROOT / "runner" / "base" / "trace.py").read_text().splitlines()[0].strip('"')[:60] in shown


def test_a_missing_report_is_told(tmp_path):
    (tmp_path / "mkdocs.yml").write_text(
        yaml.safe_dump(
            {
                "INHERIT": str(ROOT / "mkdocs.yml"),
                "docs_dir": str(ROOT / "docs"),
                "hooks": [str(ROOT / "tools" / "docs" / "site_pages.py")],
                "extra": {"live_report": str(tmp_path / "none.html")},
            }
        )
    )
    command = [sys.executable, "-m", "mkdocs", "build", "--config-file", tmp_path / "mkdocs.yml"]
    ended = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True)
    assert ended.returncode != 0
    assert "none.html is missing: `python -m tools.docs.gallery` makes it" in ended.stderr


def test_every_picture_of_the_docs_is_one_that_is_drawn():
    pages = [page.read_text() for page in (ROOT / "docs").glob("*.md")]
    shown = {name for page in pages for name in re.findall(r"!\[.+\]\(pictures/(\w+)\.svg\)", page)}
    assert shown == {*PICTURES, "layers"}  # which test_architecture.py compares
    for name in shown:
        text = (ROOT / "docs" / "pictures" / f"{name}.svg").read_text()
        assert ElementTree.fromstring(text).tag.endswith("svg")
    assert PICTURES["closed_loop"]().count("<path") == (ROOT / "docs/pictures/closed_loop.svg").read_text().count(
        "<path"
    )


def test_the_glossary_is_in_order():
    rows = re.findall(r"^\| (?!term)([^|]+?) \|", (ROOT / "docs" / "glossary.md").read_text(), re.M)
    assert len(rows) > 30
    assert rows == sorted(set(rows), key=str.lower)
