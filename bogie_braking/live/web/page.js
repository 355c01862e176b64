// The page itself: controls, frames, and the final message.

const CHART_FRAMES = 4; // charts are drawn once in this many frames
const STARTS = ["machine", "level", "speed", "mass", "gradient", "curve", "wave"]; // settings that restart the run
const IN_SPACE = ["curve", "wave", "uneven"]; // effective at level 3 alone
const UNITS = { speed: "km/h", mass: "t" }; // of numbers that are typed
const ACTS = ["lever", "friction", "protection", "uneven"]; // controls that act during a run

const live = Object.assign(new Player(["go on", "pause"], goOn), { modules: {}, kernels: {}, frames: 0, before: null, turn: 0 });

async function kernelOf(name) {
  const { module, variables } = DATA.machines[name];
  live.modules[name] ??= loadModule(module);
  live.kernels[name] ??= await Kernel.create(await live.modules[name], variables);
  return live.kernels[name];
}

const valueOf = (name) => (at(name).type === "checkbox" ? String(Number(at(name).checked)) : at(name).value);

function show(name, value) {
  if (at(name).type === "checkbox") at(name).checked = value === true || String(value) === "1";
  else at(name).value = value;
}

// Values of the page's controls, as in a link.
function settingsOf() {
  return Object.fromEntries(Object.keys(DATA.defaults).map((name) => [name, valueOf(name)]));
}

// Begins a run with the settings of the controls; plan: the actions of a link. If another run is requested while its
// kernel is compiled, only the later one begins.
async function restart(plan = []) {
  const turn = (live.turn += 1);
  const settings = settingsOf(), machine = DATA.machines[settings.machine], spatial = settings.level === "3";
  const kernel = await kernelOf(settings.machine);
  if (turn !== live.turn) return;
  keepBefore();
  const simulation = new Simulation(kernel, machine, DATA.sensor), gradient = Number(settings.gradient) / 1000;
  const values = { level: Number(settings.level), initial_speed: Number(settings.speed) / 3.6 };
  if (settings.mass !== "") values[machine.mass.variable] = 1000 * Number(settings.mass);
  const wave = spatial ? { lateral_irregularity: Number(settings.wave) / 1e3 } : {};
  const texts = spatial ? { [DATA.lineVariable]: lineText(settings.curve, gradient) } : {};
  const controls = Object.fromEntries(["friction", "protection", "uneven"].map((name) => [name, inside(name, settings[name])]));
  at("messages").replaceChildren();
  simulation.restart({ ...values, ...wave }, texts, { ...controls, gradient: spatial ? 0 : gradient }, plan);
  if (machine !== live.simulation?.machine) live.charts = chartsOf(machine.wheelsets.length);
  Object.assign(live, { simulation, settings, left: 0, busy: 0, simulated: 0, told: false, doing: "" });
  live.line = { gradient, words: wordsOnLine(settings, spatial), plan: spatial ? curvesOf(settings.curve) : [] };
  at("mass").placeholder = +(machine.mass.value / 1000).toFixed(3);
  at("mass-label").textContent = `${machine.mass.body} mass`;
  show("lever", 0);
  for (const name of IN_SPACE) at(name).disabled = !spatial;
  at("section-box").hidden = !spatial;
  showControls();
  showDoing();
  live.play();
  draw();
  if (!plan.length) showLink();
}

// The file of the line: rows as written by page.py, with a gradient [1].
function lineText(radius, gradient) {
  const [heads, ...rows] = DATA.curves[radius].rows;
  return [`${heads},gradient`, ...rows.map((row) => `${row},${gradient}`)].join("\n") + "\n";
}

// Returns the rows of the line as numbers: distance, curvature, cant; none if it is straight.
function curvesOf(radius) {
  const [, ...rows] = DATA.curves[radius].rows;
  return radius === "0" ? [] : rows.map((row) => row.split(",").map(Number));
}

function wordsOnLine({ gradient, curve }, spatial) {
  const slope = Number(gradient) === 0 ? [] : [`${Math.abs(gradient)} ‰ ${gradient > 0 ? "uphill" : "downhill"}`];
  const { cant } = DATA.curves[curve];
  if (spatial && curve !== "0") slope.push(`curve of ${curve} m, cant ${(1e3 * cant).toFixed(0)} mm`);
  return slope.join("; ");
}

// A run that came to its end stays as a pale line.
function keepBefore() {
  const { simulation } = live;
  if (!simulation?.stop.ended) return;
  const { history, stop } = simulation;
  live.before = asBefore(history, stop.begun.time, stop.distance, live.settings);
}

// The user moves a control: it acts at once, and the rest of a link's plan is dropped. Before the first run it is a setting.
function act(name) {
  if (!live.simulation) return void restart();
  live.simulation.act(name, name === "leaves" ? 1 : inside(name, valueOf(name)));
  if (live.simulation.steps === 0 && name in live.settings) live.settings[name] = valueOf(name);
  showControls();
  draw();
}

// A link's plan moves the controls, too.
function followPlan() {
  const { controls } = live.simulation;
  for (const name of ACTS) {
    const value = name === "lever" || name === "uneven" ? Math.round(100 * controls[name]) : controls[name];
    show(name, value);
  }
  showControls();
}

function showControls() {
  const lever = Number(at("lever").value), { fullPressure, fullTraction } = live.simulation.machine;
  const words = lever > 0 ? `brakes: ${((lever / 100) * fullPressure / 1e3).toFixed(0)} kPa demanded`
    : lever < 0 ? `drives: ${((-lever / 100) * fullTraction / 1e3).toFixed(1)} kN.m a wheelset` : "rolls";
  at("lever-value").textContent = words;
  at("lever").setAttribute("aria-valuetext", words);
  at("friction-value").value = Number(at("friction").value).toFixed(2);
  at("gradient-value").value = `${at("gradient").value} ‰`;
  at("uneven-value").value = `${at("uneven").value} %`;
  const over = Boolean(live.simulation.ended);
  at("brake-word").textContent = over ? "New run" : lever > 0 ? "Release" : "Brake";
  at("brake").setAttribute("aria-pressed", String(!over && lever > 0));
}

// Shows a message on the present motion, until the final one.
function showDoing() {
  const { simulation } = live, { lever } = simulation.controls, { stop } = simulation, speed = simulation.kernel.get("speed");
  const stands = Math.abs(speed) < RESTS, faster = stop.begun && Math.abs(speed) > Math.abs(stop.begun.speed) + MOVES;
  const doing = stop.ended || (stands && lever > 0) ? "It stands, braked."
    : lever > 0 ? (faster ? "The brake does not hold it: it gets faster." : "It brakes.")
    : lever < 0 ? "It drives."
    : stands ? "It stands. The lever drives it, too." : simulation.plan.length ? "It rolls." : "It rolls. Press Brake.";
  if (doing !== live.doing) at("result").textContent = doing; // once, for screen readers
  live.doing = doing;
}

// The large button, and the space bar: brakes, releases, begins a run with the same start.
function pressBrake() {
  if (!live.simulation) return;
  if (live.simulation.ended) {
    for (const name of Object.keys(live.settings)) show(name, live.settings[name]);
    return void restart();
  }
  show("lever", Number(at("lever").value) > 0 ? 0 : 100);
  act("lever");
}

function chartsOf(count) {
  const numbers = Array.from({ length: count }, (_, number) => number);
  const colours = wheelColours(count);
  const each = (name) => numbers.map((n) => ({ label: `${n + 1}`, colour: colours[n], dashes: n, value: (point) => point[name][n] }));
  const vehicle = { label: "vehicle", colour: "ink", heavy: true, value: (point) => point.speed };
  return [
    new Chart(at("chart-speed"), "speed [km/h]", [vehicle, ...each("wheels")], [0, 10]),
    new Chart(at("chart-slip"), "slip [%]", each("slip"), [-2, 10]),
    new Chart(at("chart-pressure"), "cylinder pressure [kPa]", each("pressure"), [0, 400]),
    new Chart(at("chart-load"), "axle load [kN]", each("load"), [0, 10]),
  ];
}

// One frame of a run that has not ended.
function goOn(seconds) {
  const { simulation } = live;
  if (simulation.ended) return;
  const begin = performance.now(), planned = simulation.plan.length;
  live.left += seconds;
  const whole = Math.floor(live.left / PERIOD) * PERIOD;
  live.left -= whole;
  simulation.advance(whole);
  live.busy += (performance.now() - begin) / 1e3;
  live.simulated += whole;
  if (simulation.plan.length < planned) followPlan();
  for (const sentence of simulation.messages.splice(0)) tell(sentence);
  if (!simulation.ended) showDoing();
  else finish();
  live.frames += 1;
  if (live.frames % 30 === 0) showCost();
  draw(Boolean(simulation.ended) || live.frames % CHART_FRAMES === 0);
}

// Shows the result of the run, compared with the previous one; the address becomes its link.
function finish() {
  const { simulation, before } = live, { stop } = simulation;
  live.told = true;
  tellEnd(simulation.ended, stop.ended && stop.distance, before, live.settings);
  if (simulation.lifted) at("result").append(" A wheel came off its rail: see what happened, below.");
  showControls();
  showLink();
}

function showLink() {
  if (!live.simulation) return;
  const hash = writeLink(live.settings, live.simulation.done);
  history.replaceState(null, "", document.body.className ? `${hash}&embed=1` : hash);
}

function tell(sentence) {
  at("messages").prepend(Object.assign(document.createElement("li"), { textContent: sentence }));
}

function showCost() {
  if (live.simulated < 1) return;
  const times = live.simulated / live.busy;
  at("cost").textContent = `${times.toFixed(0)} times real time on this machine, in this browser`;
}

function draw(charts = true) {
  const { simulation, before } = live, { time, kernel, stop } = simulation;
  live.side.draw(simulation, live.line);
  if (!at("section-box").hidden) live.section.draw(simulation);
  if (charts) {
    const beside = before && stop.begun ? { ...before, shift: stop.begun.time - before.begun } : null;
    live.charts.forEach((chart, number) => chart.draw(simulation.history, number === 0 ? beside : null));
  }
  const now = stop.ended ?? { time, distance: kernel.get("distance") };
  const since = stop.begun && `, ${Math.abs(now.distance - stop.begun.distance).toFixed(0)} m and ${(now.time - stop.begun.time).toFixed(1)} s since braking`;
  at("state").textContent = `${inKmh(kernel.get("speed"))}${since ?? ""}`;
}

// Plays the run of an address.
async function openLink(hash) {
  const { settings, plan, messages } = readLink(hash.replace(/^#/, ""));
  for (const [name, value] of Object.entries(settings)) show(name, value);
  await restart(plan);
  messages.forEach(tell);
  markRun(hash);
}

function listRuns() {
  addRuns(DATA.presets, openLink);
  const train = besides(/live\.html$/, "live-train.html");
  if (train) addRun("A train's pipe empties", `${train}#do=50:emergency`).target = "_top";
}

function fillChoices() {
  for (const [name, { title }] of Object.entries(DATA.machines)) at("machine").append(new Option(title, name));
  for (const radius of Object.keys(DATA.curves))
    at("curve").append(new Option(radius === "0" ? "straight" : `${radius} m curve`, radius));
}

// Begins a run with other settings; an invalid number is replaced by the previous one.
function startWith(name) {
  if (name === "machine") show("mass", "");
  const given = at(name).validity?.badInput ? NaN : valueOf(name);
  if (takes(name, String(given))) return void restart();
  show(name, (live.settings ?? DATA.defaults)[name]);
  tell(`${name} must be ${taken(name)} ${UNITS[name] ?? ""}; got ${Number.isNaN(given) ? "no number" : given || "nothing"}. It stays as it was.`);
}

function listen() {
  for (const name of ACTS) at(name).addEventListener("input", () => act(name));
  for (const name of STARTS) at(name).addEventListener("change", () => startWith(name));
  at("leaves").addEventListener("click", () => act("leaves"));
  const redraw = () => live.simulation && draw(), table = () => live.simulation.table();
  onDesk({ press: pressBrake, restart, openLink, showLink, redraw, file: ["run.csv", table] });
}

function begin() {
  fillChoices();
  listRuns();
  listen();
  if (new URLSearchParams(location.hash.slice(1)).has("embed")) document.body.className = "embedded";
  if (document.body.className || innerWidth < 900) at("more").open = false;
  live.side = new SideView(at("side"));
  live.section = new SectionView(at("section"));
  at("about").textContent = `bogie-braking ${DATA.version}, after Y. A. Handoko (2006).`;
  at("about").title = Object.values(DATA.machines).map(({ title, guid }) => `model of the ${title}: ${guid}`).join("\n");
  return openLink(location.hash);
}

live.ready = begin();
