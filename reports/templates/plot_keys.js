/* Plots read by keyboard: the arrow keys lead through the points, which are shown and said. */

// Plotly's texts hold tags and entities.
const readable = (text) => new DOMParser().parseFromString(String(text ?? "").replaceAll("<br>", " "), "text/html").body.textContent;

function numbers(values) {
  if (!values?.bdata) return values ?? [];
  const bytes = Uint8Array.from(atob(values.bdata), (c) => c.charCodeAt(0));
  return Array.from(new Float32Array(bytes.buffer), (value) => (Number.isNaN(value) ? "" : Number(value.toPrecision(7))));
}

const short = (value) => (typeof value === "number" ? String(Number(value.toPrecision(4))) : value);
const nearest = (values, wanted) => values.reduce(
  (best, value, index) => (value !== "" && Math.abs(value - wanted) < Math.abs(values[best] - wanted) ? index : best), 0,
);

// Return what the keys lead through: how many places across and up, what stands there, and which points to show.
function readCurves(panel) {
  const curves = panel.traces.map((trace, number) => ({ trace, number })).filter(({ trace }) => trace.type === "scatter" && !trace.fill)
    .map(({ trace, number }) => ({ number, name: readable(trace.name), x: numbers(trace.x), y: numbers(trace.y), hints: trace.text }));
  const longest = curves.reduce((most, curve) => (curve.x.length > most.x.length ? curve : most), { x: [] });
  const { ticktext: names, title } = panel.layout.xaxis;
  const at = (place) => {
    const x = longest.x[place];
    const points = curves.map((curve) => ({ curve, index: nearest(curve.x, x) }));
    const said = points.map(({ curve, index }) => `${curve.name} ${readable(curve.hints?.[index]) || short(curve.y[index])}`.trim());
    const across = names ? readable(names[panel.layout.xaxis.tickvals.indexOf(x)] ?? x) : short(x);
    const shown = points.map(({ curve, index }) => ({ curveNumber: curve.number, pointNumber: index }));
    return { said: `${readable(title.text)} ${across}: ${said.join("; ")}`, shown };
  };
  return { across: longest.x.length, up: 1, step: Math.max(1, Math.round(longest.x.length / 100)), at };
}

function readMap(panel) {
  const number = panel.traces.findIndex((trace) => trace.z);
  const { z, text, colorbar } = panel.traces[number];
  const [columns, rows] = panel.names.map((names) => names.map(readable));
  const at = (place, row) => {
    const value = panel.log && z[row][place] !== null ? 10 ** z[row][place] : z[row][place];
    const said = `${columns[place]}, ${rows[row]}: ${text?.[row]?.[place] || (value === null ? "none" : short(value))} ${readable(colorbar.title.text)}`;
    return { said, shown: [{ curveNumber: number, pointNumber: [row, place] }] };
  };
  return { across: columns.length, up: rows.length, step: 1, at };
}

function readByKeys(plot) {
  const place = { across: 0, up: 0 };
  let read = null;
  const said = document.getElementById("said");
  const moves = {
    ArrowRight: ["across", 1], ArrowLeft: ["across", -1], ArrowUp: ["up", 1], ArrowDown: ["up", -1],
    Home: ["across", -Infinity], End: ["across", Infinity],
  };
  plot.element.addEventListener("focus", () => { read = null; });
  plot.element.addEventListener("keydown", (event) => {
    const move = moves[event.key];
    if (!move || event.target !== plot.element || event.ctrlKey || event.altKey || event.metaKey) return;
    const first = !read;
    read ??= plot.panel.names ? readMap(plot.panel) : readCurves(plot.panel);
    const [direction, sign] = move;
    if (!read.across || (direction === "up" && read.up < 2)) return;
    event.preventDefault();
    const step = direction === "across" && !event.shiftKey ? read.step : 1;
    if (!first) place[direction] = Math.min(Math.max(place[direction] + sign * step, 0), read[direction] - 1);
    place.across = Math.min(place.across, read.across - 1);
    const { said: words, shown } = read.at(place.across, place.up);
    said.textContent = words;
    window.Plotly.Fx.hover(plot.element, shown);
  });
  plot.element.addEventListener("blur", () => { if (read) window.Plotly.Fx.unhover(plot.element); });
}
