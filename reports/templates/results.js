"use strict";
/* The list of results: search, and two of them side by side. */
(() => {
  const rows = [...document.querySelectorAll("tbody tr")];
  const search = document.getElementById("search");
  search.addEventListener("input", () => {
    const words = search.value.toLowerCase().split(/\s+/).filter(Boolean);
    let shown = 0;
    for (const row of rows) {
      const text = `${row.textContent} ${row.dataset.what} ${row.dataset.answer} ${row.dataset.folder}`.toLowerCase();
      row.hidden = !words.every((word) => text.includes(word));
      shown += !row.hidden;
    }
    document.getElementById("count").textContent = `${shown} of ${rows.length} results`;
  });

  const box = document.getElementById("compare");
  const line = (name, text) => {
    const element = document.createElement(name);
    element.textContent = text;
    return element;
  };
  // A command is pasted into a shell: everything but plain characters is quoted.
  const quoted = (text) => (/^[\w./=,-]+$/.test(text) ? text : `'${text.replaceAll("'", "'\\''")}'`);
  function compare() {
    const chosen = rows.filter((row) => row.querySelector("input").checked);
    for (const row of rows) row.querySelector("input").disabled = chosen.length === 2 && !chosen.includes(row);
    box.replaceChildren();
    if (chosen.length < 2) {
      box.append(line("p", "Tick two results to compare them."));
      return;
    }
    for (const [place, row] of chosen.entries()) {
      box.append(line("p", `${"AB"[place]}: ${row.dataset.what || row.dataset.folder}. ${row.dataset.answer}`));
    }
    const folders = chosen.map((row) => quoted(row.dataset.folder)).join(" ");
    const both = document.createElement("pre");
    both.append(line("code", `runner compare ${folders}\nrunner report ${folders}`));
    box.append(both);
  }
  rows.forEach((row) => row.querySelector("input").addEventListener("change", compare));
})();
