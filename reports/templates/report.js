/* What every page does: theme, libraries, filters, commands, contents, pictures. */
const palette = JSON.parse(document.getElementById("palette").textContent);
const darkScreen = window.matchMedia("(prefers-color-scheme: dark)");
const narrowScreen = window.matchMedia("(max-width: 64rem)");
let printing = false;

// What a page says where scripts are off.
for (const told of document.querySelectorAll(".no-script")) told.remove();

const isDark = () => darkScreen.matches && !printing;

// Libraries stand in the page once, compressed.
async function inflate(id) {
  const packed = await fetch("data:application/gzip;base64," + document.getElementById(id).textContent);
  return new Response(packed.body.pipeThrough(new DecompressionStream("gzip"))).text();
}

/* ---- audited equations ---- */

for (const figure of document.querySelectorAll("figure.equations")) {
  const filter = figure.querySelector(".filter");
  const rows = [...figure.querySelectorAll(".equation-row")];
  // Found as it is read: without white space, signs of products and the underscore of "J_11"; digits of any height.
  const squeezed = (text) => text.normalize("NFKC").toLowerCase().replace(/[\s·*_]+/g, "");
  const texts = new Map();
  const apply = () => {
    const wanted = squeezed(filter.querySelector("input").value);
    const verdict = filter.querySelector("select").value;
    let shown = 0;
    for (const row of rows) {
      const words = row.closest(".alike")?.querySelector("p") ?? row;
      if (wanted && !texts.has(row)) texts.set(row, squeezed(row.textContent + words.textContent));
      row.hidden = (verdict && row.dataset.verdict !== verdict) || (wanted && !texts.get(row).includes(wanted));
      shown += !row.hidden;
    }
    for (const group of figure.querySelectorAll(".verdict, .alike")) {
      group.hidden = !group.querySelector(".equation-row:not([hidden])");
      if (group.matches("details") && (wanted || verdict)) group.open = !group.hidden;
    }
    filter.querySelector("output").textContent = `${shown} of ${rows.length} equations`;
  };
  filter.addEventListener("input", apply);
  filter.addEventListener("submit", (event) => event.preventDefault());
}

// Keys also scroll a formula or a command that is wider than the page.
const reach = (line) => {
  if (line.scrollWidth > line.clientWidth) line.tabIndex = 0;
  else line.removeAttribute("tabindex");
};
const wide = new ResizeObserver((entries) => entries.forEach(({ target }) => reach(target)));
// A folded line is not observed, and the font of mathematics changes the width of a formula.
document.fonts.ready.then(() => document.querySelectorAll(".equation, .form-math, .command code").forEach((line) => {
  reach(line);
  wide.observe(line);
}));

/* ---- formulas ---- */

// A copied formula pastes as a line of text; by itself a browser puts each sign on its own line.
function linear(node) {
  const parts = [...node.children].map(linear);
  const group = (text) => ([...text].length > 1 ? `(${text})` : text);
  const script = (sign, text) => (text ? sign + group(text) : "");
  switch (node.localName) {
    case "msub": return parts[0] + script("_", parts[1]);
    case "msup": return parts[0] + script("^", parts[1]);
    case "msubsup": return parts[0] + script("_", parts[1]) + script("^", parts[2]);
    case "mmultiscripts": { // of frames: below and above, then those before the letter
      const [letter, below, above, , low, high] = parts;
      return script("^", high) + script("_", low) + letter + script("_", below) + script("^", above);
    }
    case "mfrac": return `${group(parts[0])}/${group(parts[1])}`;
    case "msqrt": return `√${group(parts.join(""))}`;
    case "mtable": return `[${parts.join("; ")}]`;
    case "mtr": return parts.join(", ");
    case "mo": return /^[=≈≤≥]$/.test(node.textContent) ? ` ${node.textContent} ` : node.textContent;
    default: return parts.length ? parts.join("") : node.textContent;
  }
}

document.addEventListener("copy", (event) => {
  const selection = window.getSelection();
  const copied = document.createElement("div");
  for (let i = 0; i < selection.rangeCount; i += 1) {
    const range = selection.getRangeAt(i);
    const around = range.commonAncestorContainer;
    const formula = (around.closest ? around : around.parentElement).closest("math");
    copied.append(formula ? formula.cloneNode(true) : range.cloneContents());
  }
  const formulas = copied.querySelectorAll("math");
  if (!formulas.length) return;
  event.preventDefault();
  event.clipboardData.setData("text/html", copied.innerHTML);
  formulas.forEach((formula) => formula.replaceWith(linear(formula)));
  document.body.append(copied); // lines are broken as they are drawn
  event.clipboardData.setData("text/plain", copied.innerText);
  copied.remove();
});

/* ---- commands, contents ---- */

for (const button of document.querySelectorAll("button[data-copy]")) {
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
const toc = document.querySelector(".toc");
const keepInSight = (link) => {
  const [entry, column] = [link.getBoundingClientRect(), toc.getBoundingClientRect()];
  const margin = Math.min(120, column.height / 3);
  if (entry.top < column.top + margin) toc.scrollTop += entry.top - column.top - margin;
  if (entry.bottom > column.bottom - margin) toc.scrollTop += entry.bottom - column.bottom + margin;
};
const reading = new IntersectionObserver((entries) => {
  for (const entry of entries) {
    if (!entry.isIntersecting) continue;
    links.forEach((link) => link.removeAttribute("aria-current"));
    const here = links.get(entry.target.id);
    here?.setAttribute("aria-current", "true");
    if (here && !narrowScreen.matches) keepInSight(here);
  }
}, { rootMargin: "-10% 0px -80% 0px" });
document.querySelectorAll("main section").forEach((section) => reading.observe(section));

// A link to a folded chapter unfolds it; paper shows all.
const rest = document.querySelector("details.rest");
if (rest) {
  const unfold = () => {
    const target = document.getElementById(decodeURIComponent(location.hash.slice(1)).split(":")[0]);
    if (!target || !rest.contains(target) || rest.open) return;
    rest.open = true;
    target.scrollIntoView();
  };
  window.addEventListener("hashchange", unfold);
  window.addEventListener("beforeprint", () => { rest.open = true; });
  unfold();
}

/* ---- pictures ---- */

async function showPictures() {
  const images = document.querySelectorAll("img[data-picture]");
  if (!images.length) return;
  const drawings = JSON.parse(await inflate("pictures"));
  for (const image of images) {
    image.src = "data:image/svg+xml," + encodeURIComponent(drawings[Number(image.dataset.picture)]);
  }
}

// A click shows the motion of the first screen again.
const cover = document.querySelector(".cover img");
cover?.addEventListener("click", () => { const shown = cover.src; cover.src = ""; cover.src = shown; });

showPictures();
