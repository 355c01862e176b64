// The page itself: controls, frames, and the final message.

const live = Object.assign(new Player(["go on", "pause"], advance), { module: null, before: null, turn: 0 });
const line = { label: "train", colour: "ink", heavy: true, value: (point) => point.speed };
const chart = new Chart(at("chart-speed"), "speed of the head [km/h]", [line], [0, 10]);

async function start(plan = []) {
  const turn = (live.turn += 1);
  live.module ??= await WebAssembly.compile(await unpacked(DATA.module));
  const consist = at("train").value, numbers = new Float64Array(await unpacked(DATA.consists[consist]));
  const train = await Train.create(live.module, numbers);
  if (turn !== live.turn) return;
  keepBefore();
  train.begin(Number(at("speed").value) / 3.6, plan);
  Object.assign(live, { train, consist, settings: { train: consist, speed: at("speed").value }, left: 0, told: false, doing: "" });
  live.play();
  show();
}

function keepBefore() {
  const { train } = live;
  if (train?.stopped) live.before = asBefore(train.history, train.begun.time, train.stopped.distance - train.begun.distance, live.settings);
}

function act(name) {
  if (!live.train) return;
  live.train.act(name);
  show();
}

// The large button, and the space bar: full service, release, a new run.
function pressBrake() {
  if (!live.train) return;
  if (live.train.ended) start();
  else act(live.train.valve === "running" ? "full service" : "running");
}

function show() {
  const { train, before } = live, brakes = train.valve !== "running" && train.valve !== "overcharge";
  drawTrain(at("train-view"), train);
  chart.draw(train.history, before && train.begun ? { ...before, shift: train.begun.time - before.begun } : null);
  for (const button of at("valve").children) button.setAttribute("aria-pressed", String(button.textContent === train.valve));
  at("brake-word").textContent = train.ended ? "New run" : brakes ? "Release" : "Brake";
  at("brake").setAttribute("aria-pressed", String(!train.ended && brakes));
  const { begun } = train;
  const since = begun && `, ${(train.distance - begun.distance).toFixed(0)} m and ${(train.time - begun.time).toFixed(1)} s since braking`;
  at("state").textContent = `${inKmh(train.speed)}${since ?? ""}`;
  for (const button of document.querySelectorAll("#valve button, #part")) button.disabled = train.ended;
  at("part").disabled ||= train.parted;
  if (!train.ended) showDoing(brakes);
}

// Shows a message on the present motion, until the final one.
function showDoing(brakes) {
  const { train } = live, stands = Math.abs(train.speed) < RESTS, parted = train.parted ? " It has parted in the middle." : "";
  const doing = (stands ? "It stands." : brakes || train.parted ? "It brakes." : train.plan.length ? "It rolls." : "It rolls. Press Brake.") + parted;
  if (doing !== live.doing) at("result").textContent = doing; // once, for screen readers
  live.doing = doing;
}

function advance(time) {
  if (live.told) return;
  live.left += time;
  for (; live.left > 0.5 * STEP && !live.train.ended; live.left -= STEP) live.train.step();
  show();
  if (live.train.ended) finish();
}

function finish() {
  const { train, before } = live;
  live.told = true;
  tellEnd(train.sentence(), train.stopped && train.stopped.distance - train.begun.distance, before, live.settings);
  showLink();
}

function showLink() {
  if (!live.train) return;
  const words = new URLSearchParams({ train: live.consist, speed: at("speed").value });
  words.set("do", live.train.done.map((one) => one.join(":")).join(","));
  history.replaceState(null, "", `#${decodeURIComponent(words.toString().replaceAll("+", "%20"))}`);
}

// Plays the run of an address; its invalid parts are reported.
function openLink(hash) {
  const refused = [];
  let plan = [];
  at("train").selectedIndex = 0;
  at("speed").value = "100";
  for (const [name, value] of new URLSearchParams(hash.slice(1))) {
    if (name === "do") {
      const done = value.split(",").filter(Boolean).map((one) => one.split(":"));
      const known = ([step, what]) => /^\d{1,6}$/.test(step) && (what in VALVE || what === "part");
      plan = done.filter(known).map(([step, what]) => [Number(step), what]).sort(([a], [b]) => a - b);
      refused.push(...done.filter((one) => !known(one)).map((one) => one.join(":")));
    } else if ((name === "train" || name === "speed") && [...at(name).options].some((option) => option.value === value)) at(name).value = value;
    else refused.push(`${name}=${value}`);
  }
  markRun(hash);
  return start(plan).then(() => {
    if (refused.length) at("result").textContent = `The link has ${refused.join(" and ")}, which this page does not know; it is left out.`;
  });
}

function listRuns() {
  addRuns(DATA.presets, openLink);
  const other = besides(/live-train\.html$/, "live.html");
  if (other) addRun("One vehicle", other);
}

// The history as rows of a table, the first with the heads.
function table() {
  const heads = ["time [s]", "distance of the head [m]", "speed of the head [km/h]"];
  return [heads, ...live.train.history.map(({ time, distance, speed }) => [time, distance, speed])];
}

function listen() {
  for (const name of Object.keys(VALVE)) {
    const button = Object.assign(document.createElement("button"), { type: "button", textContent: name });
    button.addEventListener("click", () => act(name));
    at("valve").append(button);
  }
  for (const name of Object.keys(DATA.consists)) at("train").append(new Option(name, name));
  for (const name of ["train", "speed"]) at(name).addEventListener("change", () => start());
  at("part").addEventListener("click", () => act("part"));
  const redraw = () => live.train && show();
  onDesk({ press: pressBrake, restart: start, openLink, showLink, redraw, file: ["train.csv", table] });
}

listen();
listRuns();
at("about").textContent = `bogie-braking ${DATA.version}; wagons of 80 t, screw couplers, two cells of the pipe a vehicle.`;
live.ready = openLink(location.hash);
