// The page itself: controls, the loop of frames, and what is told at the end.

const LONGEST_FRAME = 0.1; // a page that was asleep does not catch up [s]
const live = { running: true, train: null, module: null, left: 0, frames: 0, told: false, before: null };
const at = (name) => document.getElementById(name);
const chart = new Chart(at("chart-speed"), "speed of the head [km/h]", [{ label: "train", colour: "ink", heavy: true, value: (point) => point.speed }], [0, 10]);

async function start(plan = []) {
  live.module ??= await WebAssembly.compile(await unpacked(DATA.module));
  const consist = at("train").value, numbers = new Float64Array(await unpacked(DATA.consists[consist]));
  const train = await Train.create(live.module, numbers);
  if (live.train?.stopped) keepBefore(live.train);
  train.begin(Number(at("speed").value) / 3.6, plan);
  Object.assign(live, { train, consist, left: 0, told: false, running: true });
  at("pause").textContent = "pause";
  at("result").textContent = `${consist.split(",")[0]} roll at ${at("speed").value} km/h. Press Brake.`;
  show();
}

function keepBefore({ history, begun, stopped }) {
  const distance = stopped.distance - begun.distance;
  live.before = { history, begun: begun.time, distance, words: `run before: ${distance.toFixed(1)} m` };
}

function act(name) {
  live.train.act(name);
  show();
}

// The large button, and the space bar: full service, release, a new run.
function pressBrake() {
  if (live.train.ended) start();
  else act(live.train.valve === "running" ? "full service" : "running");
}

function show() {
  const { train, before } = live, brakes = train.valve !== "running" && train.valve !== "overcharge";
  drawTrain(at("train-view"), train);
  chart.draw(train.history, before && train.begun ? { ...before, shift: train.begun.time - before.begun } : null);
  for (const button of at("valve").children) button.setAttribute("aria-pressed", String(button.textContent === train.valve));
  at("brake-word").textContent = train.ended ? "Again" : brakes ? "Release" : "Brake";
  at("brake").setAttribute("aria-pressed", String(!train.ended && brakes));
  const { begun } = train;
  const since = begun && `, ${(train.distance - begun.distance).toFixed(0)} m and ${(train.time - begun.time).toFixed(1)} s since braking`;
  at("state").textContent = `${(3.6 * train.speed).toFixed(1)} km/h${since ?? ""}`;
  if (train.begun && !train.ended) at("result").textContent = "It brakes.";
}

function advance(time) {
  live.left += time;
  for (; live.left > 0.5 * STEP && !live.train.ended; live.left -= STEP) live.train.step();
  show();
  if (live.train.ended && !live.told) finish();
}

function finish() {
  const { train, before } = live;
  live.told = true;
  at("result").textContent = train.sentence();
  if (train.stopped && before) {
    const more = train.stopped.distance - train.begun.distance - before.distance;
    const words = `${Math.abs(more).toFixed(1)} m ${more < 0 ? "shorter" : "longer"} than the run before.`;
    at("result").append(" ", Object.assign(document.createElement("span"), { textContent: words, className: "compared" }));
  }
  at("chart-speed").setAttribute("aria-label", `speed of the train over time. ${at("result").textContent}`);
  showLink();
}

function showLink() {
  const words = new URLSearchParams({ train: live.consist, speed: at("speed").value });
  words.set("do", live.train.done.map((one) => one.join(":")).join(","));
  history.replaceState(null, "", `#${decodeURIComponent(words.toString().replaceAll("+", "%20"))}`);
}

// Plays the run of an address; what it has that cannot be is told.
function openLink(hash) {
  const refused = [];
  let plan = [];
  at("train").selectedIndex = 0;
  at("speed").value = "100";
  for (const [name, value] of new URLSearchParams(decodeURIComponent(hash.slice(1)).replaceAll("+", " "))) {
    if (name === "do") {
      const done = value.split(",").filter(Boolean).map((one) => one.split(":"));
      const known = ([step, what]) => /^\d{1,6}$/.test(step) && (what in VALVE || what === "part");
      plan = done.filter(known).map(([step, what]) => [Number(step), what]).sort(([a], [b]) => a - b);
      refused.push(...done.filter((one) => !known(one)).map((one) => one.join(":")));
    } else if ((name === "train" || name === "speed") && [...at(name).options].some((option) => option.value === value)) at(name).value = value;
    else refused.push(`${name}=${value}`);
  }
  for (const one of at("presets").querySelectorAll("a"))
    if (one.getAttribute("href") === hash) one.setAttribute("aria-current", "true");
    else one.removeAttribute("aria-current");
  return start(plan).then(() => {
    if (refused.length) at("result").textContent = `The link has ${refused.join(" and ")}, which this page does not know; it is left out.`;
  });
}

function frame(now) {
  const seconds = Math.min((now - (live.last ?? now)) / 1e3, LONGEST_FRAME) * Number(at("pace").value);
  live.last = now;
  if (live.running && live.train && !live.train.ended) advance(seconds);
  requestAnimationFrame(frame);
}

function listPresets() {
  const add = (title, href) => {
    const item = document.createElement("li");
    item.append(Object.assign(document.createElement("a"), { textContent: title, href }));
    at("presets").append(item);
    return item.firstChild;
  };
  for (const [title, link] of Object.entries(DATA.presets))
    add(title, `#${link}`).addEventListener("click", (event) => {
      event.preventDefault();
      openLink(`#${link}`);
    });
  const other = location.pathname.replace(/train\.html$/, "live.html"); // its page lies beside this one
  if (other !== location.pathname) add("One vehicle", other.split("/").at(-1));
}

function save() {
  const rows = live.train.history.map(({ time, distance, speed }) => [time, distance, speed].join(","));
  const text = ["time [s],distance of the head [m],speed of the head [km/h]", ...rows].join("\n") + "\n";
  const address = URL.createObjectURL(new Blob([text], { type: "text/csv" }));
  Object.assign(document.createElement("a"), { href: address, download: "train.csv" }).click();
  setTimeout(() => URL.revokeObjectURL(address), 1000);
}

function listen() {
  for (const name of Object.keys(VALVE)) {
    const button = Object.assign(document.createElement("button"), { type: "button", textContent: name });
    button.addEventListener("click", () => act(name));
    at("valve").append(button);
  }
  for (const name of Object.keys(DATA.consists)) at("train").append(new Option(name, name));
  for (const name of ["train", "speed"]) at(name).addEventListener("change", () => start());
  addEventListener("hashchange", () => openLink(location.hash));
  addEventListener("resize", show);
  addEventListener("keydown", (event) => {
    if (event.key !== " " || event.repeat || event.target.closest("button, select, summary, a")) return;
    event.preventDefault();
    pressBrake();
  });
  at("brake").addEventListener("click", pressBrake);
  at("part").addEventListener("click", () => act("part"));
  at("restart").addEventListener("click", () => start());
  at("table").addEventListener("click", save);
  at("pause").addEventListener("click", () => {
    live.running = !live.running;
    at("pause").textContent = live.running ? "pause" : "go on";
  });
  look.changed = () => show();
}

listen();
listPresets();
at("about").textContent = `bogie-braking ${DATA.version}; wagons of 80 t, screw couplers, two cells of the pipe a vehicle.`;
live.ready = openLink(location.hash).then(() => requestAnimationFrame(frame));
