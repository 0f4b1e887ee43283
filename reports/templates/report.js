"use strict";
(() => {
  const palette = JSON.parse(document.getElementById("palette").textContent);
  const darkScreen = window.matchMedia("(prefers-color-scheme: dark)");
  const narrowScreen = window.matchMedia("(max-width: 64rem)");
  let printing = false;

  const isDark = () => darkScreen.matches && !printing;

  // Libraries stand in the page once, compressed.
  async function inflate(id) {
    const bytes = Uint8Array.from(atob(document.getElementById(id).textContent), (c) => c.charCodeAt(0));
    const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
    return new Response(stream).text();
  }

  /* ---- curves ---- */

  const config = {
    displaylogo: false,
    showSendToCloud: false,
    showEditInChartStudio: false,
    plotlyServerURL: "",
    showTips: false,
    modeBarButtonsToRemove: ["select2d", "lasso2d", "autoScale2d", "sendDataToCloud", "editInChartStudio"],
  };
  const BELOW = 46;
  const plots = [];

  function collectPlots() {
    for (const figure of document.querySelectorAll("figure.curves")) {
      const panels = JSON.parse(figure.querySelector("script").textContent);
      const columns = Number(getComputedStyle(figure.querySelector(".panels")).getPropertyValue("--columns"));
      figure.querySelectorAll(".plot").forEach((element, index) => {
        plots.push({ element, columns, panel: panels[index], drawn: false, near: false, legend: 0, width: 0 });
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

  function leadToRun(event) {
    const run = event.points.map((point) => point.customdata).find(Boolean);
    if (!run) return;
    window.location.hash = `run-${run}`;
    document.dispatchEvent(new Event("run"));
  }

  function baseHeight(plot) {
    return Math.round(Math.min(400, Math.max(230, 0.64 * plot.width)));
  }

  function themed(plot) {
    const colors = isDark() ? palette.dark : palette.light;
    const ink = isDark() ? "#d7dbe2" : "#23272f";
    const grid = isDark() ? "#343a45" : "#e3e6ea";
    const surface = isDark() ? "#1e222a" : "#ffffff";
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
      xaxis: axis(plot.panel.layout.xaxis),
      yaxis: axis(plot.panel.layout.yaxis),
      width: plot.width,
      height: baseHeight(plot) + plot.legend,
      margin: { l: 56, r: 12, t: 28, b: BELOW + plot.legend },
      paper_bgcolor: "rgba(0,0,0,0)",
      plot_bgcolor: "rgba(0,0,0,0)",
      font: { family: getComputedStyle(document.body).fontFamily, size: 12, color: ink },
      modebar: { bgcolor: "rgba(0,0,0,0)", color: isDark() ? "#7d8795" : "#a6aeb9", activecolor: ink },
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
    if (!plot.drawn) {
      window.Plotly.newPlot(plot.element, ...themed(plot), config);
      plot.element.on("plotly_afterplot", () => fitLegend(plot));
      plot.element.on("plotly_click", leadToRun);
      plot.element.classList.add("drawn");
      plot.drawn = true;
      fitLegend(plot);
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
    collectPlots();
    if (!plots.length) return;
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

  /* ---- playbacks ---- */

  let player = null;

  async function play(figure) {
    const stage = figure.querySelector(".stage");
    stage.classList.add("loading");
    player ??= inflate("player");
    const scene = JSON.stringify(figure.querySelector("script").textContent.trim());
    const start = "<script>window.__VISER_EMBED_DATA__=" + scene + ";window.__VISER_EMBED_CONFIG__={darkMode:"
      + isDark() + "};</" + "script>";
    const page = await player;
    const head = page.indexOf("</head>");
    const frame = document.createElement("iframe");
    frame.title = stage.querySelector("img").alt;
    frame.srcdoc = page.slice(0, head) + start + page.slice(head);
    stage.append(frame);
    stage.classList.remove("loading");
    stage.classList.add("playing");
  }

  for (const figure of document.querySelectorAll("figure.playback")) {
    figure.querySelector("button.play").addEventListener("click", () => play(figure), { once: true });
  }

  /* ---- audited equations ---- */

  for (const figure of document.querySelectorAll("figure.equations")) {
    const filter = figure.querySelector(".filter");
    const rows = [...figure.querySelectorAll("tbody tr")];
    // Subscripts are separate elements: without their white space "l4 cos" is found as it is read.
    const squeezed = (text) => text.toLowerCase().replace(/[\s·]+/g, "");
    const texts = new Map();
    const apply = () => {
      const wanted = squeezed(filter.querySelector("input").value);
      const verdict = filter.querySelector("select").value;
      let shown = 0;
      for (const row of rows) {
        if (wanted && !texts.has(row)) texts.set(row, squeezed(row.textContent));
        row.hidden = (verdict && row.dataset.verdict !== verdict) || (wanted && !texts.get(row).includes(wanted));
        shown += !row.hidden;
      }
      filter.querySelector("output").textContent = `${shown} of ${rows.length} equations`;
    };
    filter.addEventListener("input", apply);
    filter.addEventListener("submit", (event) => event.preventDefault());
  }

  /* ---- commands, contents ---- */

  for (const button of document.querySelectorAll("button.copy")) {
    button.addEventListener("click", async () => {
      const code = button.previousElementSibling;
      try {
        await navigator.clipboard.writeText(code.textContent);
        button.textContent = "Copied";
        setTimeout(() => { button.textContent = "Copy"; }, 1500);
      } catch {
        window.getSelection().selectAllChildren(code);
      }
    });
  }

  const contents = document.querySelector(".toc details");
  const fold = () => { contents.open = !narrowScreen.matches; };
  narrowScreen.addEventListener("change", fold);
  fold();

  const links = new Map([...document.querySelectorAll(".toc a")].map((link) => [link.hash.slice(1), link]));
  const reading = new IntersectionObserver((entries) => {
    for (const entry of entries) {
      if (!entry.isIntersecting) continue;
      links.forEach((link) => link.removeAttribute("aria-current"));
      links.get(entry.target.id)?.setAttribute("aria-current", "true");
    }
  }, { rootMargin: "-10% 0px -80% 0px" });
  document.querySelectorAll("main > section").forEach((section) => reading.observe(section));

  startPlots();
})();
