// The page itself: the train that it carries, frames, and the final message.

const CHART_FRAMES = 4; // plots over time and place are drawn once in this many frames
const LONGEST_LINK = 8000; // letters that mail programs keep

const live = Object.assign(new Player(["go on", "pause"], advance), { module: null, before: null, turn: 0, frames: 0, opened: null, looked: null });
const line = { label: "train", colour: "ink", heavy: true, value: (point) => point.speed };
const chart = new Chart(at("chart-speed"), "speed of the head [km/h]", [line], [0, 10]);
const plots = [new PressureView(at("chart-pipe"), "brake pipe [bar] over time, by vehicle", "pipe"),
  new PressureView(at("chart-cylinder"), "brake cylinders [bar] over time, by vehicle", "cylinder")];
const places = new PlaceView(at("chart-place"));
const desk = new TrainDesk(act);
const WARNINGS = { vigilance_warning: "VIGILANCE", penalty_applied: "PENALTY" }; // outputs of the head's valve, if there are any
const SETTINGS = ["train", "speed", "place"];

// Begins a run of the chosen train; one that cannot be made leaves the present run, with a message.
async function start(plan = []) {
  const turn = (live.turn += 1), settings = Object.fromEntries(SETTINGS.map((name) => [name, at(name).value]));
  live.module ??= await WebAssembly.compile(await unpacked(DATA.module));
  const consist = live.opened?.name === settings.train ? live.opened : await Consist.from(DATA.consists[settings.train]);
  const train = await Train.create(live.module, consist);
  if (turn !== live.turn) return;
  keepBefore();
  const known = plan.filter(([, name]) => Object.hasOwn(train.notches, name) || name in train.controls || (name === "part" && train.vehicles > 1));
  at("place").placeholder = consist.start;
  train.begin(Number(settings.speed) / 3.6, settings.place === "" ? consist.start : Number(settings.place), known);
  Object.assign(live, { train, consist: consist.name, settings, left: 0, told: false, doing: "" });
  desk.begin(train);
  live.play();
  show();
  return plan.filter((one) => !known.includes(one));
}

function keepBefore() {
  const { train } = live;
  if (train?.stopped) live.before = asBefore(train.history, train.begun.time, train.stopped.distance - train.begun.distance, live.settings);
}

// A control moves. A train that has stopped goes on once its brakes are released.
function act(name, value) {
  if (!live.train) return;
  live.train.act(name, value);
  if (!live.train.ended) live.told = false;
  show();
}

// The large button, and the space bar: full service, release, a new run.
function pressBrake() {
  const { train } = live;
  if (!train) return;
  if (train.ended) return void restart();
  if (!train.released) return act(train.notchOf(RUNNING));
  if (train.levers.traction) act("traction", 0);
  act(train.fullService);
}

const restart = () => start().catch((error) => tell(error.message));

function tell(message) {
  at("result").textContent = message;
}

function show(all = true) {
  const { train, before } = live, applied = !train.released, { begun } = train;
  drawTrain(at("train-view"), train);
  if (all) {
    chart.draw(train.history, before && begun ? { ...before, shift: begun.time - before.begun } : null);
    const { running } = train.consist, ranges = [running > 0 ? [0, 0.6 * running, 1.1 * running] : [-1e5, -1e5, 0], [0, 0, fullCylinder(running)]];
    plots.forEach((plot, number) => plot.draw(train.history, ranges[number]));
    places.draw(train);
  }
  desk.show();
  at("brake-word").textContent = train.ended ? "New run" : applied ? "Release" : "Brake";
  at("brake").setAttribute("aria-pressed", String(!train.ended && applied));
  const since = begun && `, ${Math.abs(train.distance - begun.distance).toFixed(0)} m and ${(train.time - begun.time).toFixed(1)} s since braking`;
  at("state").textContent = `${inKmh(train.speed)}${since ?? ""}`;
  at("gauges").textContent = live.looked === null ? gauges(train) : vehicleWords(train, live.looked);
  at("part").disabled = train.ended || train.parted || train.vehicles < 2;
  if (!train.ended) showDoing();
}

// The driver's instruments: pressures at the head, forces of the drives, place, gradient, limit.
function gauges(train) {
  const bar = (name) => `${(train.pressure(name)[0] / 1e5).toFixed(1)} bar`, { consist, front, controls } = train;
  const parts = [`pipe ${bar("pipe_pressure")}`, `cylinders ${bar("cylinder_pressure")}`];
  if (DATA.outputs.includes("main_reservoir_pressure") && train.pressure("main_reservoir_pressure")[0] > 0) parts.push(`main reservoir ${bar("main_reservoir_pressure")}`);
  for (const [name, word] of Object.entries(WARNINGS)) if (DATA.outputs.includes(name) && train.output(name)[0]) parts.push(word);
  if (controls.traction) parts.push(`motors ${(train.output("traction_force").reduce((a, b) => a + b, 0) / 1e3).toFixed(0)} kN`);
  const limit = consist.limitBetween(train.rear, front);
  parts.push(`${front.toFixed(0)} m`);
  if (!consist.line.isLevel) parts.push(`${(1e3 * consist.gradientAt(front)).toFixed(1)} ‰`);
  if (limit !== null) parts.push(`limit ${(3.6 * limit).toFixed(0)} km/h${Math.abs(train.speed) > limit + 0.1 ? ": too fast" : ""}`);
  return parts.join(" · ");
}

// The vehicle that is pointed at: name, mass, pressures, force of the coupler behind it.
function vehicleWords(train, number) {
  const { consist } = train, bar = (name) => `${(train.pressure(name)[number] / 1e5).toFixed(2)} bar`;
  const parts = [`${number + 1}: ${consist.nameOf(number)}`, `${(consist.columns["motion.mass"][number] / 1e3).toFixed(1)} t`];
  parts.push(`pipe ${bar("pipe_pressure")}`, `cylinders ${bar("cylinder_pressure")}`);
  if (number < train.vehicles - 1) parts.push(`coupler behind ${(train.output("coupler_force")[number] / 1e3).toFixed(0)} kN`);
  return parts.join(" · ");
}

// Shows a message on the present motion, until the final one.
function showDoing() {
  const { train } = live, stands = Math.abs(train.speed) < RESTS, parted = train.parted ? " It has parted in the middle." : "";
  const drives = train.levers.traction > 0, moves = drives ? "It drives." : train.plan.length ? "It rolls." : "It rolls. Press Brake.";
  const doing = (stands ? "It stands." : train.brakes ? "It brakes." : moves) + parted;
  if (doing !== live.doing) tell(doing); // once, for screen readers
  live.doing = doing;
}

function advance(time) {
  if (live.told) return;
  live.left += time;
  try {
    for (; live.left > 0.5 * STEP && !live.train.ended; live.left -= STEP) live.train.step();
  } catch (error) {
    live.told = true;
    return tell(error.message);
  }
  live.frames += 1;
  show(live.train.ended || live.frames % CHART_FRAMES === 0);
  if (live.train.ended) finish();
}

function finish() {
  const { train, before } = live;
  Object.assign(live, { told: true, doing: "" });
  tellEnd(train.sentence(), train.stopped && train.stopped.distance - train.begun.distance, before, live.settings);
  showLink();
}

// The address of the run; one of a user's train has its numbers.
function showLink() {
  const { train, settings } = live;
  if (!train) return;
  const own = settings.train === DATA.own || settings.train === live.opened?.name, words = new URLSearchParams();
  if (own) words.set("data", inLink(train.consist.text));
  else words.set("train", settings.train);
  words.set("speed", settings.speed);
  if (settings.place) words.set("place", settings.place);
  words.set("do", train.done.map((one) => one.join(":")).join(","));
  const link = `#${decodeURIComponent(words.toString().replaceAll("+", "%20"))}`;
  history.replaceState(null, "", link);
  return link;
}

function copied() {
  const link = showLink();
  if (link?.length > LONGEST_LINK) tell(`The link has ${link.length} letters, too many for some mail programs. Send this page instead if it carries the train.`);
}

// Plays the run of an address; its invalid parts are reported.
async function openLink(hash) {
  const refused = [];
  let plan = [], message = "";
  at("train").selectedIndex = 0;
  at("speed").value = "100";
  at("place").value = "";
  for (const [name, value] of new URLSearchParams(hash.slice(1))) {
    if (name === "do") {
      const done = value.split(",").filter(Boolean).map((one) => one.split(":"));
      plan = done.filter(isAction).map(([step, what, much]) => [Number(step), what, ...(isControl(what) ? [Number(much)] : [])]).sort(([a], [b]) => a - b);
      refused.push(...done.filter((one) => !isAction(one)).map((one) => one.join(":")));
    } else if (name === "data") message = await Consist.from(fromLink(value)).then(add, (error) => `The link has a train that cannot be read. ${error.message}`);
    else if (SETTINGS.includes(name) && takes(name, value)) at(name).value = value;
    else refused.push(`${name}=${value}`);
  }
  markRun(hash);
  try {
    refused.push(...((await start(plan)) ?? []).map((one) => one.join(":")));
  } catch (error) {
    message ||= error.message;
  }
  if (refused.length) tell(`The link has ${refused.join(" and ")}, which this page does not know; it is left out.`);
  else if (message) tell(message);
}

const isControl = (name) => name in INPUT && (name in DATA.controls || name in DATA.equipment);

// Returns whether words are a step and a word, which may be a notch, or a step, a control and its value [%].
function isAction([step, what, much]) {
  return /^\d{1,6}$/.test(step) && (isControl(what) ? /^\d{1,3}$/.test(much) && Number(much) <= INPUT[what].most : Boolean(what) && much === undefined);
}

// Adds a train of a file or of a link to the choice, and chooses it.
function add(consist) {
  while (consist.name in DATA.consists && DATA.consists[consist.name] !== consist.text) consist.name += " (opened)";
  live.opened = consist;
  if (![...at("train").options].some(({ value }) => value === consist.name)) at("train").append(new Option(consist.name, consist.name));
  at("train").value = consist.name;
  return "";
}

async function openFile(file) {
  const before = at("train").value;
  try {
    const consist = await consistOfFile(file);
    await consist.asText();
    add(consist);
    await start();
  } catch (error) {
    at("train").value = before;
    tell(`${file.name} cannot be opened. ${error.message}`);
    live.stop();
  }
}

function listRuns() {
  addRuns(DATA.presets, openLink);
  const other = besides(/live-train\.html$/, "live.html");
  if (other) addRun("One vehicle", other);
}

// The history as rows of a table, the first with the heads.
function table() {
  const { history, vehicles } = live.train, numbers = Array.from({ length: vehicles }, (_, i) => i + 1);
  const each = { pipe: "pipe pressure # [Pa]", cylinder: "cylinder pressure # [Pa]", force: "coupler force # [N]" };
  const heads = ["time [s]", "distance of the head [m]", "speed of the head [km/h]"];
  for (const [name, text] of Object.entries(each)) heads.push(...numbers.slice(0, history[0][name].length).map((number) => text.replace("#", number)));
  return [heads, ...history.map((point) => [point.time, point.distance, point.speed, ...Object.keys(each).flatMap((name) => [...point[name]])])];
}

function listenToFiles() {
  at("file").addEventListener("change", () => at("file").files[0] && openFile(at("file").files[0]));
  addEventListener("dragover", (event) => event.preventDefault());
  addEventListener("drop", (event) => {
    event.preventDefault();
    if (event.dataTransfer.files[0]) openFile(event.dataTransfer.files[0]);
  });
}

// Begins a run with other settings; an invalid number is replaced by the previous one.
function startWith(name) {
  if (takes(name, at(name).value)) return void restart();
  const typed = at(name).value || "no number";
  at(name).value = live.settings[name];
  tell(`${name} must be ${taken(name)}; got ${typed}. It stays as it was.`);
}

function listen() {
  for (const name of Object.keys(DATA.consists)) at("train").append(new Option(name, name));
  for (const name of SETTINGS) at(name).addEventListener("change", () => startWith(name));
  at("part").addEventListener("click", () => act("part"));
  for (const name of ["pointermove", "pointerleave"])
    at("train-view").addEventListener(name, (event) => { live.looked = name === "pointermove" && live.train ? vehicleAt(event, live.train.vehicles) : null; });
  const redraw = () => live.train && show();
  onDesk({ press: pressBrake, restart, openLink, showLink: copied, redraw, file: ["train.csv", table] });
  listenToFiles();
}

listen();
listRuns();
if (innerWidth >= 900) at("own").open = true;
at("about").textContent = `bogie-braking ${DATA.version}; block trains: wagons of 80 t, screw couplers; two cells of the pipe a vehicle.`;
live.ready = openLink(location.hash);
