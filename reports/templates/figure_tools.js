/* What a reader may do with a figure or table: enlarge it, save its picture and data. */

function save(name, type, text) {
  const address = URL.createObjectURL(new Blob([text], { type }));
  Object.assign(document.createElement("a"), { href: address, download: name }).click();
  setTimeout(() => URL.revokeObjectURL(address), 1000);
}

// A text that a spreadsheet would take for a formula begins with an apostrophe.
function cell(value) {
  const text = String(value ?? "");
  const safe = /^[=+\-@\t\r]/.test(text) && Number.isNaN(Number(text)) ? "'" + text : text;
  return /[",\n\r]/.test(safe) ? '"' + safe.replaceAll('"', '""') + '"' : safe;
}

const csv = (rows) => rows.map((row) => row.map(cell).join(",") + "\r\n").join("");

function rowsOfCurves(panel, title) {
  const [x, y] = [panel.layout.xaxis, panel.layout.yaxis].map((axis) => readable(axis.title.text));
  const drawn = panel.traces.filter((trace) => trace.type === "scatter" && trace.hoverinfo !== "skip"
    && numbers(trace.x).some(Number.isFinite));
  return drawn.flatMap((trace) => {
    const name = panel.traces.find((one) => one.name && one.legendgroup === trace.legendgroup)?.name;
    const heights = numbers(trace.y);
    const [low, high] = [trace.meta?.low, trace.meta?.high].map((edge) => edge && numbers(edge));
    return numbers(trace.meta?.x ?? trace.x).map((value, index) => [
      title, readable(name), x, panel.names_across ? readable(panel.names_across[value] ?? value) : value, y,
      ...[low ? NaN : heights[index], low?.[index] ?? NaN, low ? heights[index] : NaN, high?.[index] ?? NaN]
        .map((number) => (Number.isFinite(number) ? number : "")),
    ]);
  });
}

function rowsOfMap(panel, title) {
  const { z, colorbar } = panel.traces.find((trace) => trace.z);
  const [columns, rows] = panel.names.map((names) => names.map(readable));
  const [x, y] = [panel.layout.xaxis, panel.layout.yaxis].map((axis) => readable(axis.title.text));
  const label = readable(colorbar.title.text);
  return z.flatMap((row, at) => row.map((value, place) => [
    title, x, columns[place], y, rows[at], label, value !== null && panel.log ? 10 ** value : value,
  ]));
}

function rowsOfMotion({ runs }) {
  const names = ["run", "time (s)", ...["tip", "desired"].flatMap((what) => ["x", "y", "z"].map((axis) => `${what} ${axis} (m)`))];
  return [names, ...runs.flatMap((run) => points(run.tip).map((tip, at) => [
    run.name, run.times[at], ...tip, ...run.target.subarray(3 * at, 3 * at + 3),
  ]))];
}

function rowsOf(figure) {
  const motion = motions.find((one) => one.figure === figure);
  if (motion) return rowsOfMotion(motion);
  const table = figure.querySelector("table");
  if (table) return [...table.rows].map((row) => [...row.cells].map((one) => one.innerText.trim().replace(/\s+/g, " ")));
  const panels = [...figure.querySelectorAll(".panel")].map((panel) => [
    panel.querySelector(".plot").panel, panel.querySelector(".panel-title")?.textContent ?? "",
  ]);
  if (figure.classList.contains("maps")) {
    return [["panel", "x axis", "x", "y axis", "y", "quantity", "value"], ...panels.flatMap((one) => rowsOfMap(...one))];
  }
  const names = ["panel", "curve", "x axis", "x", "y axis", "y", "low", "median", "high"];
  return [names, ...panels.flatMap((one) => rowsOfCurves(...one))];
}

/* ---- pictures ---- */

const decoded = (address) => decodeURIComponent(address.slice(address.indexOf(",") + 1));

// The panels of a figure side by side, in the colours of paper.
async function pictureOfCurves(figure) {
  const own = plots.filter((plot) => plot.figure === figure);
  const [width, gap, head] = [Math.max(360, Math.floor(760 / own[0].columns)), 10, 22];
  const [panels, tops] = [[], []];
  let bottom = 0;
  for (const [index, plot] of own.entries()) {
    const column = index % own[0].columns;
    if (!column) tops.push(bottom);
    const height = baseHeight({ ...plot, width }) + plot.legend;
    const [data, layout] = themed({ ...plot, width }, false);
    const address = await window.Plotly.toImage({ data, layout: { ...layout, height } }, { format: "svg", width, height });
    const title = plot.element.parentElement.querySelector(".panel-title")?.textContent ?? "";
    const words = Object.assign(document.createElementNS("http://www.w3.org/2000/svg", "text"), { textContent: title });
    for (const [name, value] of Object.entries({ y: 15, x: 4, "font-family": "sans-serif", "font-size": 13, "font-weight": 600 })) {
      words.setAttribute(name, value);
    }
    const inner = decoded(address).replace("<svg ", `<svg y="${head}" `);
    panels.push(`<g transform="translate(${column * (width + gap)} ${tops.at(-1)})">${new XMLSerializer().serializeToString(words)}${inner}</g>`);
    bottom = Math.max(bottom, tops.at(-1) + head + height + gap);
  }
  const across = Math.min(own.length, own[0].columns) * (width + gap) - gap;
  return `<svg xmlns="http://www.w3.org/2000/svg" width="${across}" height="${bottom}" viewBox="0 0 ${across} ${bottom}">`
    + `<rect width="100%" height="100%" fill="#fff"/>${panels.join("")}</svg>`;
}

/* ---- enlarged ---- */

function enlarge(figure) {
  const shown = figure.querySelector(".panels, .live") ?? figure.querySelector("img.still");
  const place = document.createComment("");
  const dialog = document.createElement("dialog");
  const close = Object.assign(document.createElement("button"), { type: "button", className: "copy", textContent: "Close" });
  dialog.className = "enlarged";
  dialog.setAttribute("aria-label", figure.querySelector("figcaption p").textContent);
  const room = document.createElement("div");
  room.style.height = `${shown.offsetHeight}px`;
  shown.before(place, room);
  dialog.append(close, shown);
  figure.append(dialog);
  close.addEventListener("click", () => dialog.close());
  dialog.addEventListener("close", () => {
    place.replaceWith(shown);
    room.remove();
    dialog.remove();
  });
  dialog.showModal();
}

const actions = {
  enlarge,
  svg: async (figure, name) => {
    const still = figure.querySelector("img.still");
    save(`${name}.svg`, "image/svg+xml", still ? decoded(still.src) : await pictureOfCurves(figure));
  },
  csv: (figure, name) => save(`${name}.csv`, "text/csv", csv(rowsOf(figure))),
};

for (const button of document.querySelectorAll("button[data-do]")) {
  const figure = button.closest("figure");
  button.addEventListener("click", () => actions[button.dataset.do](figure, figure.id || "figure"));
}

for (const button of document.querySelectorAll("button[data-save]")) {
  const text = button.parentElement.querySelector("code").textContent;
  button.addEventListener("click", () => save(button.dataset.save, "text/plain", text));
}
