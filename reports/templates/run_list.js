"use strict";
/* The runs of a sweep: filters, a plot of any two quantities, a sortable table, the details of one run. */
(() => {
  const FIRST_ROWS = 25;

  const superscript = (digits) => [...digits].map((c) => "⁰¹²³⁴⁵⁶⁷⁸⁹"[c] ?? "⁻").join("");

  function number(value) {
    if (Number.isNaN(value)) return "–";
    const size = Math.abs(value);
    if (value === 0 || (size >= 1e-2 && size < 1e4)) return String(Number(value.toPrecision(3)));
    const [mantissa, exponent] = value.toExponential(2).split("e");
    return mantissa + "·10" + superscript(exponent.replace("+", ""));
  }

  // Plotly reads tags and entities in all its texts.
  const neutral = (text) => text.replace(/&/g, "&amp;").replace(/</g, "&lt;").replace(/>/g, "&gt;").replace(/\$/g, "&#36;");

  function element(name, properties = {}, ...children) {
    const made = Object.assign(document.createElement(name), properties);
    made.append(...children);
    return made;
  }

  function unpack(text) {
    const bytes = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
    return new Float32Array(bytes.buffer);
  }

  function start(figure) {
    const data = JSON.parse(figure.querySelector("script").textContent);
    const part = (name) => figure.querySelector(name);
    const runs = data.hashes.map((_, index) => index);
    const place = new Map(data.hashes.map((hash, index) => [hash, index]));
    const failed = (run) => data.failures[run] !== "";

    // A quantity is an axis or a metric: its name, its number for a run, and the text of that.
    const axes = data.axes.map((axis, index) => {
      const numbers = axis.values.map(Number);
      const numeric = axis.values.every((value) => value.trim() !== "") && numbers.every(Number.isFinite);
      const level = (run) => data.levels[index][run];
      return {
        name: axis.name, label: axis.name, values: axis.values, names: numeric ? null : axis.values, level,
        number: (run) => (numeric ? numbers[level(run)] : level(run)), text: (run) => axis.values[level(run)],
      };
    });
    const metrics = data.metrics.map((metric, index) => {
      const values = unpack(data.values[index]);
      const unit = metric.unit;
      return {
        name: metric.name, label: unit ? `${metric.name} (${unit})` : metric.name, names: null,
        number: (run) => values[run], text: (run) => [number(values[run]), unit].join(" ").trim(),
        bare: (run) => number(values[run]),
      };
    });
    const status = { name: "status", values: ["ok", "failed"], level: (run) => Number(failed(run)) };
    const quantities = [...axes, ...metrics];
    const filters = [...axes, ...(runs.some(failed) ? [status] : [])];
    const hidden = filters.map(() => new Set());
    const state = {
      x: axes[0] ?? metrics[0], y: metrics[axes.length ? 0 : 1] ?? metrics[0] ?? axes[0], color: axes[1] ?? null,
      sort: null, up: true, rows: FIRST_ROWS, chosen: null,
    };

    const shown = () => runs.filter((run) => filters.every((filter, index) => !hidden[index].has(filter.level(run))));

    function sorted(list) {
      if (state.sort === null) return list;
      const key = (run) => state.sort.number(run);
      const missing = (run) => Number(Number.isNaN(key(run)));
      return list.slice().sort((a, b) => missing(a) - missing(b) || (state.up ? key(a) - key(b) : key(b) - key(a)));
    }

    /* ---- the plot ---- */

    function scale(quantity, list) {
      if (quantity.names) {
        const places = quantity.names.map((_, index) => index);
        return {
          type: "linear", tickmode: "array", tickvals: places, ticktext: quantity.names.map(neutral),
          range: [-0.5, places.length - 0.5],
        };
      }
      const values = list.map(quantity.number).filter(Number.isFinite);
      const [low, high] = [Math.min(...values), Math.max(...values)];
      return low > 0 && high >= 10 * low ? { type: "log", dtick: 1 } : { type: "linear" };
    }

    function hint(run) {
      const lines = [...axes, ...new Set([state.x, state.y].filter((quantity) => !axes.includes(quantity)))]
        .map((quantity) => `${quantity.name}: ${quantity.text(run)}`);
      return [...lines, ...(failed(run) ? [data.failures[run]] : [])].map(neutral).join("<br>");
    }

    // A failed run without a number stands above all others.
    function height(list) {
      const values = list.map(state.y.number).filter(Number.isFinite);
      const [low, high] = [Math.min(...values), Math.max(...values)];
      const top = !values.length ? 1 : low > 0 && high >= 10 * low ? 2 * high : high + 0.1 * (high - low || 1);
      return (run) => (failed(run) && Number.isNaN(state.y.number(run)) ? top : state.y.number(run));
    }

    function trace(list, name, symbol, y) {
      return {
        type: "scatter", mode: "markers", name: neutral(name), showlegend: name !== "", hoverinfo: "text",
        x: list.map(state.x.number), y: list.map(y), text: list.map(hint),
        customdata: list.map((run) => data.hashes[run]), marker: { size: 8, opacity: 0.8, symbol },
      };
    }

    function panel() {
      const list = shown();
      const groups = state.color
        ? state.color.values.map((value, level) => [`${state.color.name} ${value}`, level])
        : [["", null]];
      const y = height(list);
      const traces = [];
      const colors = [];
      for (const [name, level] of groups) {
        const own = list.filter((run) => level === null || state.color.level(run) === level);
        for (const [isFailed, symbol] of [[false, "circle"], [true, "x"]]) {
          const some = own.filter((run) => failed(run) === isFailed);
          if (!some.length) continue;
          traces.push(trace(some, isFailed ? "" : name, symbol, y));
          colors.push(level ?? 0);
        }
      }
      return {
        traces, colors,
        layout: {
          xaxis: { title: { text: neutral(state.x.label) }, ...scale(state.x, list) },
          yaxis: { title: { text: neutral(state.y.label) }, ...scale(state.y, list) },
          showlegend: state.color !== null, hovermode: "closest",
        },
      };
    }

    /* ---- the table, the details ---- */

    const columns = [...axes, { ...status, number: status.level, text: (run) => status.values[status.level(run)] },
      ...metrics.slice(0, data.shown)];

    function head() {
      const cells = columns.map((quantity) => {
        const button = element("button", { type: "button", textContent: quantity.label ?? quantity.name });
        button.addEventListener("click", () => {
          state.up = state.sort === quantity ? !state.up : true;
          state.sort = quantity;
          table();
        });
        const cell = element("th", { scope: "col" }, button);
        if (state.sort === quantity) cell.setAttribute("aria-sort", state.up ? "ascending" : "descending");
        return cell;
      });
      part("thead").replaceChildren(element("tr", {}, element("th", { scope: "col", textContent: "run" }), ...cells));
    }

    function table() {
      head();
      const list = sorted(shown());
      const rows = list.slice(0, state.rows).map((run) => {
        const hash = data.hashes[run];
        const link = element("a", { href: `#run-${hash}`, textContent: hash.slice(0, 8) });
        const cells = columns.map((quantity) => element("td", { textContent: (quantity.bare ?? quantity.text)(run) }));
        const row = element("tr", {}, element("td", {}, link), ...cells);
        row.classList.toggle("chosen-run", run === state.chosen);
        row.classList.toggle("failed-run", failed(run));
        return row;
      });
      part("tbody").replaceChildren(...rows);
      part(".chosen").textContent = `${list.length} of ${runs.length} runs`;
      const more = part(".more");
      more.hidden = list.length <= state.rows;
      more.textContent = `Show more (${list.length - state.rows} left)`;
    }

    function details(run) {
      state.chosen = run;
      const hash = data.hashes[run];
      const entry = (quantity) => element("div", {},
        element("dt", { textContent: quantity.name }), element("dd", { textContent: quantity.text(run) }));
      const box = part(".details");
      const content = [element("p", { className: "panel-title", textContent: `Run ${hash}` })];
      if (failed(run)) content.push(element("p", { className: "failure", textContent: data.failures[run] }));
      content.push(element("dl", {}, ...quantities.map(entry)));
      content.push(element("p", {}, "Made by ", element("code", { textContent: data.commands[run] })));
      if (data.folders[run]) {
        const link = element("a", { href: data.folders[run], textContent: "its folder" });
        content.push(element("p", {}, "Config, trace and metrics lie in ", link, "."));
      }
      box.replaceChildren(...content);
      box.hidden = false;
      table();
      box.scrollIntoView({ block: "center" });
    }

    function follow() {
      const run = place.get(location.hash.replace("#run-", ""));
      if (run !== undefined) details(run);
    }

    /* ---- filters ---- */

    const plot = part(".plot");

    function renew() {
      plot.panel = panel();
      plot.dispatchEvent(new Event("panel"));
      table();
    }

    function chooser(label, options, chosen, choose) {
      const select = element("select", {}, ...options.map((option, index) =>
        element("option", { value: String(index), textContent: option?.label ?? "one colour", selected: option === chosen })));
      select.addEventListener("change", () => { choose(options[Number(select.value)]); renew(); });
      return element("label", {}, `${label} `, select);
    }

    function chips(filter, index) {
      const buttons = filter.values.map((value, level) => {
        const button = element("button", { type: "button", className: "chip", textContent: value });
        button.setAttribute("aria-pressed", "true");
        button.addEventListener("click", () => {
          const off = hidden[index];
          if (!off.delete(level)) off.add(level);
          button.setAttribute("aria-pressed", String(!off.has(level)));
          renew();
        });
        return button;
      });
      return element("div", { className: "filter" }, element("span", { textContent: filter.name }), ...buttons);
    }

    part(".filters").replaceChildren(
      ...filters.map(chips),
      element("div", { className: "filter" },
        chooser("Horizontal", quantities, state.x, (quantity) => { state.x = quantity; }),
        chooser("Vertical", quantities, state.y, (quantity) => { state.y = quantity; }),
        chooser("Colour", [null, ...axes], state.color, (axis) => { state.color = axis; })),
    );
    part(".more").addEventListener("click", () => { state.rows += 200; table(); });
    window.addEventListener("hashchange", follow);
    document.addEventListener("run", follow);
    renew();
    follow();
  }

  document.querySelectorAll("figure.runlist").forEach(start);
})();
