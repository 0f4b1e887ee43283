// What scrolls sideways can be scrolled by keys, and what a reader of screens announces has a name.
function name_parts() {
  document.querySelectorAll(".md-search[role=dialog]:not([aria-label])").forEach((found) => found.setAttribute("aria-label", "Search"));
  document.querySelectorAll("nav.md-code__nav").forEach((found, place) => found.setAttribute("aria-label", `Code ${place + 1}`));
  document.querySelectorAll(".md-typeset__scrollwrap, .md-typeset pre > code").forEach((found) => { found.tabIndex = 0; });
  document.querySelectorAll("th:empty").forEach((found) => found.replaceWith(document.createElement("td")));
}
document.addEventListener("DOMContentLoaded", () => {
  name_parts();
  new MutationObserver(name_parts).observe(document.body, { childList: true, subtree: true });
});
