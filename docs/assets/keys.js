// Tables that are too wide scroll, and so must be reached by keys; the theme wraps them when a page is there.
addEventListener("load", () => {
  for (const wrap of document.querySelectorAll(".md-typeset__scrollwrap")) wrap.tabIndex = 0
})
