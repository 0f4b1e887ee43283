/* Figures of curves and maps, drawn by Plotly as they come near. */

const config = {
  displaylogo: false,
  showSendToCloud: false,
  showEditInChartStudio: false,
  plotlyServerURL: "",
  showTips: false,
  displayModeBar: "hover",
  modeBarButtonsToRemove: ["select2d", "lasso2d", "autoScale2d", "sendDataToCloud", "editInChartStudio"],
};
const BELOW = 46;
const MANY = 6; // panels, of more a phone shows one
const phone = window.matchMedia("(max-width: 44rem)");
const plots = [];

async function collectPlots() {
  const figures = document.querySelectorAll("figure.curves");
  const data = figures.length ? JSON.parse(await inflate("plots")) : [];
  for (const figure of figures) {
    const panels = data[Number(figure.dataset.plots)];
    const columns = Number(getComputedStyle(figure.querySelector(".panels")).getPropertyValue("--columns"));
    figure.querySelectorAll(".plot").forEach((element, index) => {
      element.panel = panels[index];
      plots.push({ element, figure, columns, panel: element.panel, drawn: false, near: false, legend: 0, width: 0 });
    });
  }
  // These come with their data on them, and with new data whenever a reader filters.
  for (const element of document.querySelectorAll("figure.runlist .plot")) {
    const plot = { element, columns: 1, panel: element.panel, drawn: false, near: false, legend: 0, width: 0 };
    plots.push(plot);
    element.addEventListener("panel", () => {
      plot.panel = element.panel;
      if (plot.drawn) draw(plot);
    });
  }
}

// On a phone a figure of many panels shows one of them, which the reader chooses.
function choosePanel(figure) {
  const panels = [...figure.querySelectorAll(".panel")];
  if (panels.length <= MANY) return;
  const names = panels.map((panel, at) => panel.querySelector(".panel-title")?.textContent ?? `Panel ${at + 1}`);
  const select = document.createElement("select");
  select.append(...names.map((name, at) => new Option(name, at)));
  const label = Object.assign(document.createElement("label"), { className: "panel-choice", textContent: `Panel of ${panels.length} ` });
  label.append(select);
  figure.querySelector(".panels").before(label);
  const show = () => {
    label.hidden = !phone.matches;
    panels.forEach((panel, at) => { panel.hidden = phone.matches && at !== Number(select.value); });
    for (const plot of plots.filter((one) => one.figure === figure)) {
      plot.single = phone.matches;
      if (plot.drawn && plot.element.clientWidth) draw(plot);
    }
  };
  select.addEventListener("change", show);
  phone.addEventListener("change", show);
  show();
}

// Panels of a figure that have the same x axis are zoomed together.
const sameAxis = (one, other) => {
  const [a, b] = [one, other].map((plot) => plot.panel.layout.xaxis);
  return one !== other && one.figure && one.figure === other.figure && a.title.text === b.title.text && a.type === b.type;
};

function zoomTogether(plot, change) {
  if (plot.led || !("xaxis.range[0]" in change || change["xaxis.autorange"])) return;
  const range = change["xaxis.autorange"] ? null : [change["xaxis.range[0]"], change["xaxis.range[1]"]];
  for (const other of plots.filter((candidate) => candidate.drawn && sameAxis(plot, candidate))) {
    const given = other.panel.layout.xaxis.range;
    const to = range ? { "xaxis.range": range } : given ? { "xaxis.range": given } : { "xaxis.autorange": true };
    other.led = true;
    window.Plotly.relayout(other.element, to).then(() => { other.led = false; });
  }
}

// What the one legend of a figure hides is hidden in all its panels.
function hideTogether(plot, [change, traces]) {
  if (!plot.panel.together || plot.led || !("visible" in change)) return;
  // Panels may have bands and lines of their own, so that a curve has not the same place in all.
  const given = [change.visible].flat();
  const shown = new Map(traces.map((trace, at) => [plot.panel.traces[trace].legendgroup, given[at % given.length]]));
  for (const other of plots.filter((one) => one !== plot && one.figure === plot.figure && one.drawn)) {
    const groups = other.panel.traces.map((trace) => trace.legendgroup);
    const led = [...groups.keys()].filter((trace) => shown.has(groups[trace]));
    if (!led.length) continue;
    other.led = true;
    const visible = led.map((trace) => shown.get(groups[trace]));
    window.Plotly.restyle(other.element, { visible }, led).then(() => { other.led = false; });
  }
}

function leadToRun(event) {
  const run = event.points.map((point) => point.customdata).find(Boolean);
  if (!run) return;
  window.location.hash = `run-${run}`;
  document.dispatchEvent(new Event("run"));
}

// Enlarged panels fill the window: its height less the button, the titles and the legends.
function baseHeight(plot) {
  const panels = plot.element.closest("dialog .panels");
  if (!panels) return Math.round(Math.min(400, Math.max(230, 0.64 * plot.width)));
  const shown = [...panels.children].filter((panel) => !panel.hidden).length;
  const rows = Math.ceil(shown / getComputedStyle(panels).gridTemplateColumns.split(" ").length);
  return Math.round(Math.max(230, (window.innerHeight - 80) / rows - 50 - plot.legend));
}

function themed(plot, dark = isDark()) {
  const colors = dark ? palette.dark : palette.light;
  const ink = dark ? "#d7dbe2" : "#23272f";
  const grid = dark ? "#343a45" : "#e3e6ea";
  const surface = dark ? "#1e222a" : "#ffffff";
  const traces = plot.panel.traces.map((trace, index) => {
    const color = colors[plot.panel.colors[index] % colors.length];
    return {
      ...trace,
      ...(trace.line ? { line: { color, ...trace.line } } : {}),
      ...(trace.marker ? { marker: { ...trace.marker, color } } : {}),
      ...(trace.fill ? { fillcolor: color + "30" } : {}),
    };
  });
  const axis = (given) => ({
    ...given,
    title: { ...given.title, standoff: 8 },
    automargin: true,
    zeroline: false,
    gridcolor: grid,
    linecolor: grid,
    showline: true,
    ticks: "outside",
    ticklen: 4,
    tickcolor: grid,
    nticks: 7,
    exponentformat: "power",
    minexponent: 4,
  });
  const layout = {
    ...plot.panel.layout,
    showlegend: plot.panel.layout.showlegend && (plot.panel.legend !== false || plot.single === true),
    xaxis: axis(plot.panel.layout.xaxis),
    yaxis: axis(plot.panel.layout.yaxis),
    width: plot.width,
    height: baseHeight(plot) + plot.legend,
    margin: { l: 56, r: 12, t: 28, b: BELOW + plot.legend },
    paper_bgcolor: "rgba(0,0,0,0)",
    plot_bgcolor: "rgba(0,0,0,0)",
    font: { family: getComputedStyle(document.body).fontFamily, size: 12, color: ink },
    modebar: { bgcolor: "rgba(0,0,0,0)", color: dark ? "#7d8795" : "#a6aeb9", activecolor: ink },
    hoverlabel: { bgcolor: surface, bordercolor: grid, font: { size: 12, color: ink }, namelength: -1 },
    legend: {
      orientation: "h", traceorder: "normal", x: 0, xanchor: "left",
      yref: "container", y: 0, yanchor: "bottom", bgcolor: "rgba(0,0,0,0)", font: { size: 12 },
    },
    uirevision: "kept",
  };
  return [traces, layout];
}

// The legend stands below the axes; the plot grows by its height, so that the axes keep theirs.
function fitLegend(plot) {
  const box = plot.element.querySelector("g.legend");
  const legend = box ? Math.ceil(box.getBBox().height) : 0;
  if (Math.abs(legend - plot.legend) < 3) return;
  plot.legend = legend;
  window.Plotly.relayout(plot.element, { height: baseHeight(plot) + legend, "margin.b": BELOW + legend });
}

function draw(plot) {
  plot.width ||= plot.element.clientWidth;
  if (!plot.width) return;
  if (!plot.drawn) {
    window.Plotly.newPlot(plot.element, ...themed(plot), config);
    plot.element.on("plotly_afterplot", () => fitLegend(plot));
    plot.element.on("plotly_click", leadToRun);
    readByKeys(plot);
    plot.element.on("plotly_restyle", (change) => hideTogether(plot, change));
    plot.element.on("plotly_relayout", (change) => zoomTogether(plot, change));
    plot.element.classList.add("drawn");
    plot.drawn = true;
    fitLegend(plot);
    followCursor(plot);
  } else {
    window.Plotly.react(plot.element, ...themed(plot), config);
  }
}

// What is out of sight waits until it comes near.
function resize(plot, width) {
  if (!plot.drawn || !width || width === plot.width) return;
  plot.width = width;
  window.Plotly.relayout(plot.element, { width, height: baseHeight(plot) + plot.legend });
}

// What is in sight is drawn first, the rest whenever the browser has nothing else to do.
async function startPlots() {
  await collectPlots();
  if (!plots.length) return;
  document.querySelectorAll("figure.curves").forEach(choosePanel);
  const script = document.createElement("script");
  script.textContent = await inflate("plotly");
  document.head.append(script);
  const waiting = new Map(plots.map((plot) => [plot.element, plot]));
  const now = (plot) => {
    waiting.delete(plot.element);
    if (!plot.drawn) draw(plot);
  };
  const sight = new IntersectionObserver((entries) => {
    for (const entry of entries) {
      const plot = plots.find((candidate) => candidate.element === entry.target);
      plot.near = entry.isIntersecting;
      if (!plot.near) continue;
      now(plot);
      resize(plot, plot.element.clientWidth);
    }
  }, { rootMargin: "600px" });
  const size = new ResizeObserver((entries) => {
    // In the next frame: drawing changes the height of what is observed here.
    requestAnimationFrame(() => {
      for (const entry of entries) {
        const plot = plots.find((candidate) => candidate.element === entry.target);
        if (plot.near && !printing) resize(plot, plot.element.clientWidth);
      }
    });
  });
  plots.forEach((plot) => { sight.observe(plot.element); size.observe(plot.element); });
  const idle = window.requestIdleCallback ?? ((work) => setTimeout(work, 50));
  const next = () => {
    const [plot] = waiting.values();
    if (!plot) return;
    now(plot);
    idle(next);
  };
  setTimeout(() => idle(next), 300);
  darkScreen.addEventListener("change", () => plots.filter((plot) => plot.drawn).forEach(draw));
  window.addEventListener("beforeprint", () => {
    printing = true;
    plots.forEach((plot) => {
      plot.width = Math.floor(680 / plot.columns) - 12;
      waiting.delete(plot.element);
      draw(plot);
    });
  });
  window.addEventListener("afterprint", () => {
    printing = false;
    plots.forEach((plot) => {
      plot.width = plot.element.clientWidth;
      draw(plot);
    });
  });
}

startPlots();
