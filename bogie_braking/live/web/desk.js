// Common parts of both live pages: preset runs, the space bar, the link, a table to save, and two runs compared.

const NAMES = { machine: "vehicle", level: "level of detail", curve: "line", uneven: "shoes", wave: "rails" }; // of settings

// Adds a preset run: its title and its address; returns the link.
function addRun(title, href) {
  const item = document.createElement("li");
  item.append(Object.assign(document.createElement("a"), { textContent: title, href }));
  at("presets").append(item);
  return item.firstChild;
}

// Adds the preset runs of a page, which play without a reload; play: called with the hash of one. "Back" returns to the
// previous run.
function addRuns(runs, play) {
  for (const { title, link } of runs)
    addRun(title, `#${link}`).addEventListener("click", (event) => {
      event.preventDefault();
      if (window.top === window) history.pushState(null, "", `#${link}`);
      play(`#${link}`);
    });
}

// Marks the link of the present run if it is a preset one.
function markRun(hash) {
  for (const one of at("presets").querySelectorAll("a"))
    if (one.getAttribute("href") === hash) one.setAttribute("aria-current", "true");
    else one.removeAttribute("aria-current");
}

// The other page, which lies next to this one under its own name; null if this file has another name.
function besides(own, other) {
  const place = location.pathname.replace(own, other);
  return place === location.pathname ? null : place.split("/").at(-1);
}

// Events of both pages. press: the large button, and the space bar unless the focused control uses it. restart,
// openLink (of a hash), showLink, redraw: functions. file: a name and a function that returns the rows of its table.
function onDesk({ press, restart, openLink, showLink, redraw, file: [name, rows] }) {
  at("brake").addEventListener("click", press);
  addEventListener("keydown", (event) => {
    if (event.key !== " " || event.repeat || event.target.closest("button, select, summary, a, [type=checkbox]")) return;
    event.preventDefault();
    press();
  });
  // After a click the focus is dropped, so that the space bar always brakes for users of a mouse.
  addEventListener("click", (event) => {
    if (event.detail > 0) event.target.closest("button, summary, [type=checkbox]")?.blur();
  });
  at("share").addEventListener("click", () => share(showLink));
  at("restart").addEventListener("click", () => restart());
  at("table").addEventListener("click", () => save(name, rows()));
  addEventListener("popstate", () => openLink(location.hash));
  for (const event of ["resize", "click"]) addEventListener(event, redraw);
  look.changed = redraw;
}

// A speed [m/s] as text.
function inKmh(speed) {
  return `${(Math.abs(speed) < 0.01 ? 0 : 3.6 * speed).toFixed(1)} km/h`;
}

// Copies the address, which showLink has set to that of the run.
async function share(showLink) {
  showLink();
  try {
    await navigator.clipboard.writeText(location.href);
    at("share").textContent = "link copied";
  } catch {
    at("share").textContent = "the link is the address above";
  }
  setTimeout(() => { at("share").textContent = "copy link"; }, 3000);
}

// rows of a table, the first with the heads, as a file of this name.
function save(name, rows) {
  const text = rows.map((row) => row.join(",")).join("\n") + "\n";
  const address = URL.createObjectURL(new Blob([text], { type: "text/csv" }));
  Object.assign(document.createElement("a"), { href: address, download: name }).click();
  setTimeout(() => URL.revokeObjectURL(address), 1000);
}

// Shows the end of a run in one message, and the difference from the previous run's distance [m]; settings: those at
// its start.
function tellEnd(sentence, distance, before, settings) {
  at("result").textContent = sentence;
  at("chart-speed").setAttribute("aria-label", `speed over time. ${sentence}`);
  if (distance === null || !before) return;
  const more = distance - before.distance, words = `${Math.abs(more).toFixed(1)} m ${more > 0 ? "longer" : "shorter"} than the run before`;
  const others = Object.keys(settings).filter((name) => settings[name] !== before.settings[name]).map((name) => NAMES[name] ?? name);
  const compared = `${Math.abs(more) < 0.05 ? "As far as the run before" : words}${others.length ? ` (other ${others.join(", ")})` : ""}.`;
  at("result").append(" ", Object.assign(document.createElement("span"), { textContent: compared, className: "compared" }));
}

// A stopped run, to be drawn below the next: its history, the time at which it braked [s], its distance [m], its
// settings.
function asBefore(history, begun, distance, settings) {
  return { history, begun, distance, settings, words: `run before: ${distance.toFixed(1)} m` };
}

// Returns whether a control of the page accepts this value.
function takes(name, value = "") {
  const control = at(name);
  if (value === "" && control.dataset.empty) return true; // a value of the model's own
  if (control.tagName === "SELECT") return [...control.options].some((option) => option.value === value);
  if (control.type === "checkbox") return value === "0" || value === "1";
  const number = Number(value);
  return value.trim() !== "" && number >= Number(control.min) && number <= Number(control.max);
}

function taken(name) {
  const control = at(name);
  if (control.tagName === "SELECT") return [...control.options].map((option) => option.value).join(", ");
  return control.type === "checkbox" ? "0 or 1" : `${control.min} to ${control.max}`;
}
