"""Pages of the site from outside docs/: a hook of MkDocs, which `make docs` runs.

The README becomes the start page; changelog, contributing and security pages come from the root, too. A link of a page
to a file of the source, such as ../runner/base/trace.py, leads to a page that shows it, so that the site needs no other
place. The gallery has the report that `python -m tools.docs.gallery` left in build/gallery, as gallery_report.html.
"""

import posixpath
import re
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from mkdocs.config.defaults import MkDocsConfig
    from mkdocs.structure.files import Files
    from mkdocs.structure.pages import Page

ROOT = Path(__file__).resolve().parents[2]
ROOT_PAGES = {  # by where they are in the site
    "index.md": "README.md",
    "changelog.md": "CHANGELOG.md",
    "contributing.md": "CONTRIBUTING.md",
    "security.md": "SECURITY.md",
}
_PLACES = {
    **{name: uri for uri, name in ROOT_PAGES.items()},
    "LICENSE": "source/LICENSE.md",
    "reports/example.png": "pictures/example.png",
}
_LINK = re.compile(r"\]\((?!https?:|mailto:|#)([^)#\s]+)(#[^)\s]*)?\)")
_LANGUAGES = {".py": "python", ".yaml": "yaml", ".urdf": "xml", ".sh": "sh", ".cff": "yaml"}


def on_files(files: "Files", config: "MkDocsConfig") -> "Files":
    """Add the pages from the root, and one for each file of the source that a page links to."""
    from mkdocs.exceptions import PluginError
    from mkdocs.structure.files import File

    report = ROOT / config.extra["live_report"]
    if not report.is_file():
        raise PluginError(f"{report} is missing: `python -m tools.docs.gallery` makes it; `make docs` does both")
    files.append(File.generated(config, "gallery_report.html", abs_src_path=str(report)))
    for uri, name in ROOT_PAGES.items():
        files.append(File.generated(config, uri, content=(ROOT / name).read_text(encoding="utf-8")))
    pages = {file.src_uri: file.content_string for file in files.documentation_pages()}
    for target in sorted({target for uri, text in pages.items() for target in targets(uri, text)}):
        place = place_of(target)
        if place.startswith("source/"):
            files.append(File.generated(config, place, content=shown(target)))
        elif not files.get_file_from_path(place) and (ROOT / target).is_file():
            files.append(File.generated(config, place, abs_src_path=str(ROOT / target)))
    return files


def on_page_markdown(markdown: str, page: "Page", **_: object) -> str:
    """Turn the links of a page to where their targets are in the site."""
    return relinked(page.file.src_uri, markdown)


def relinked(uri: str, text: str) -> str:
    """Return the text of a page of the site with its links turned to pages of the site.

    Args:
        uri: Where the page is in the site, such as "index.md".
        text: Its Markdown, whose links are relative to its place in the checkout.
    """

    def turned(link: re.Match[str]) -> str:
        place = place_of(_in_checkout(uri, link[1]))
        return f"]({posixpath.relpath(place, posixpath.dirname(uri) or '.')}{link[2] or ''})"

    return text if uri.startswith("source/") else _LINK.sub(turned, text)


def targets(uri: str, text: str) -> set[str]:
    """Return the link targets of a page, as paths in the checkout."""
    return {_in_checkout(uri, link[1]) for link in _LINK.finditer(text)}


def place_of(target: str) -> str:
    """Return the address of a file or folder of the checkout in the site."""
    if target in _PLACES:
        return _PLACES[target]
    if target.startswith("docs/"):
        return target.removeprefix("docs/")
    return f"source/{target}" if target.endswith(".ipynb") else f"source/{target}.md"


def shown(target: str) -> str:
    """Return a page that shows a file of the source, or lists and shows the files of a folder of examples."""
    path = ROOT / target
    if not path.is_dir():
        return f"# {target}\n\n{_fenced(path)}"
    inside = [file for file in sorted(path.rglob("*")) if file.is_file() and "__pycache__" not in file.parts]
    if target.startswith("examples/"):
        return f"# {target}\n\n" + "\n".join(f"## {file.relative_to(path)}\n\n{_fenced(file)}" for file in inside)
    folders = sorted({file.relative_to(path).parts[0] for file in inside})
    return f"# {target}\n\nIn this folder of the source:\n\n" + "".join(f"- `{name}`\n" for name in folders)


def _in_checkout(uri: str, link: str) -> str:
    page = ROOT_PAGES.get(uri, f"docs/{uri}")
    return posixpath.normpath(posixpath.join(posixpath.dirname(page), link))


def _fenced(path: Path) -> str:
    language = _LANGUAGES.get(path.suffix, "text")
    return f"``````{language}\n{path.read_text(encoding='utf-8').rstrip()}\n``````\n"
