"""Tables of the studies' pages on a desktop, in Chromium: no column is out of sight."""

import html
import json
import re
import shutil
import subprocess

import pytest
from support.patience import PATIENCE

from runner.reporting.render import render_html

MEASURE = """<script>
document.querySelectorAll("details").forEach((each) => { each.open = true; });
const wide = [...document.querySelectorAll(".scroll")].filter((each) => each.scrollWidth > each.clientWidth + 1);
const found = document.createElement("pre");
found.id = "measured";
found.textContent = JSON.stringify([document.querySelectorAll(".scroll").length, wide.map((each) =>
  `${each.getAttribute("aria-label")}: ${each.scrollWidth} of ${each.clientWidth} px`)]);
document.body.append(found);
</script>"""

pytestmark = pytest.mark.slow


@pytest.mark.parametrize("study", ["thesis", "thesis_beyond", "xarm7", "meca500"])
def test_no_table_hides_a_column_at_1280_px(study, made, tmp_path):
    browser = shutil.which("chromium") or pytest.skip("chromium is not installed")
    page = re.sub(r'<meta http-equiv="Content-Security-Policy"[^>]*>', "", render_html(made(study).document))
    assert page.count("</body>") == 1
    (tmp_path / "page.html").write_text(page.replace("</body>", f"{MEASURE}</body>"), encoding="utf-8")
    shown = subprocess.run(
        [browser, "--headless", "--no-sandbox", "--disable-gpu", f"--user-data-dir={tmp_path / 'profile'}",
         "--window-size=1280,800", "--virtual-time-budget=20000", "--dump-dom", (tmp_path / "page.html").as_uri()],
        capture_output=True, text=True, check=True, timeout=PATIENCE,
    ).stdout  # fmt: skip
    tables, wide = json.loads(html.unescape(re.search(r'<pre id="measured">(.*?)</pre>', shown, re.S)[1]))
    assert tables > 5
    assert wide == []
