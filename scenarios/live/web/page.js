// The page itself: controls, the loop of frames, and what is told at the end.

const CHART_FRAMES = 4; // charts are drawn in one frame of so many
const STARTS = ["machine", "level", "speed", "gradient", "curve", "wave"]; // settings that begin a run anew
const ACTS = ["lever", "friction", "protection", "uneven"]; // controls that act while it goes

const live = { modules: {}, kernels: {}, simulation: null, running: true, frames: 0, busy: 0, simulated: 0, still: 0, before: null };

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

// What the page's controls say, as a link has it.
function settingsOf() {
  return Object.fromEntries(Object.keys(DATA.defaults).map((name) => [name, valueOf(name)]));
}

// Begins a run with what the controls say; plan: what a link does in it.
async function restart(plan = []) {
  const settings = settingsOf(), machine = DATA.machines[settings.machine], spatial = settings.level === "3";
  const kernel = await kernelOf(settings.machine);
  keepBefore();
  const simulation = new Simulation(kernel, machine, DATA.protection), gradient = Number(settings.gradient) / 1000;
  const values = { level: Number(settings.level), initial_speed: Number(settings.speed) / 3.6 };
  const wave = spatial ? { lateral_irregularity: Number(settings.wave) / 1e3 } : {};
  const texts = spatial ? { [DATA.lineVariable]: lineText(settings.curve, gradient) } : {};
  const controls = Object.fromEntries(["friction", "protection", "uneven"].map((name) => [name, inside(name, settings[name])]));
  at("sentences").replaceChildren();
  at("result").textContent = `It rolls at ${settings.speed} km/h. Press Brake.`;
  simulation.restart({ ...values, ...wave }, texts, { ...controls, gradient: spatial ? 0 : gradient }, plan);
  if (machine !== live.simulation?.machine) live.charts = chartsOf(machine.wheelsets.length);
  Object.assign(live, { simulation, settings, running: true, left: 0, busy: 0, simulated: 0, still: 0, told: false });
  live.line = { gradient, words: wordsOnLine(settings, spatial) };
  show("lever", 0);
  at("in-space").disabled = !spatial;
  at("section-box").hidden = !spatial;
  at("pause").textContent = "pause";
  showControls();
}

// The file of the line: rows as page.py writes them, with a gradient [1].
function lineText(radius, gradient) {
  const [heads, ...rows] = DATA.curves[radius].rows;
  return [`${heads},gradient`, ...rows.map((row) => `${row},${gradient}`)].join("\n") + "\n";
}

function wordsOnLine({ gradient, curve }, spatial) {
  const slope = Number(gradient) === 0 ? [] : [`${Math.abs(gradient)} ‰ ${gradient > 0 ? "uphill" : "downhill"}`];
  const { cant } = DATA.curves[curve];
  if (spatial && curve !== "0") slope.push(`a curve of ${curve} m to the left, cant ${(1e3 * cant).toFixed(0)} mm`);
  return slope.join("; ");
}

// A run that came to its end stays as a pale line.
function keepBefore() {
  const { simulation } = live;
  if (!simulation?.stop.ended) return;
  const { history, stop } = simulation;
  live.before = asBefore(history, stop.begun.time, stop.distance);
}

// A person moves a control: it acts at once, and the rest of a link's plan is dropped.
function act(name) {
  live.simulation.act(name, name === "leaves" ? 1 : inside(name, valueOf(name)));
  if (live.simulation.steps === 0 && name in live.settings) live.settings[name] = valueOf(name);
  live.still = 0;
  showControls();
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
  at("brake-word").textContent = over ? "Again" : lever > 0 ? "Release" : "Brake";
  at("brake").setAttribute("aria-pressed", String(!over && lever > 0));
  if (lever > 0 && !live.told) at("result").textContent = "It brakes.";
}

// The large button, and the space bar: brakes, releases, begins anew with the lever back.
function pressBrake() {
  if (live.simulation.ended) return void restart();
  show("lever", Number(at("lever").value) > 0 ? 0 : 100);
  act("lever");
}

function chartsOf(count) {
  const numbers = Array.from({ length: count }, (_, number) => number);
  const colours = count > 2 ? DATA.colours : [DATA.colours[0], DATA.colours[3]];
  const each = (name) => numbers.map((n) => ({ label: `${n + 1}`, colour: colours[n], dashes: n, value: (point) => point[name][n] }));
  const vehicle = { label: "vehicle", colour: "ink", heavy: true, value: (point) => point.speed };
  return [
    new Chart(at("chart-speed"), "speed [km/h]", [vehicle, ...each("wheels")], [0, 10]),
    new Chart(at("chart-slip"), "slip [%]", each("slip"), [-2, 10]),
    new Chart(at("chart-pressure"), "cylinder pressure [kPa]", each("pressure"), [0, 400]),
    new Chart(at("chart-load"), "axle load [kN]", each("load"), [0, 10]),
  ];
}

function goOn(seconds) {
  const { simulation } = live, begin = performance.now(), planned = simulation.plan.length;
  live.left += Number(at("pace").value) * Math.min(seconds, LONGEST_FRAME);
  const whole = Math.floor(live.left / PERIOD) * PERIOD;
  live.left -= whole;
  simulation.advance(whole);
  live.busy += (performance.now() - begin) / 1e3;
  live.simulated += whole;
  if (simulation.plan.length < planned) followPlan();
  for (const sentence of simulation.sentences.splice(0)) tell(sentence);
  if (!live.told && (simulation.stop.ended || simulation.ended)) finish();
  if (simulation.ended) showControls();
}

// What the run came to, beside the run before; the address becomes its link.
function finish() {
  const { simulation, before } = live, { stop } = simulation;
  live.told = true;
  tellEnd(stop.ended ? stop.sentence(PERIOD) : simulation.ended, stop.ended && stop.distance, before);
  showLink();
}

function showLink() {
  const hash = writeLink(live.settings, live.simulation.done);
  history.replaceState(null, "", document.body.className ? `${hash}&embed=1` : hash);
}

function tell(sentence) {
  at("sentences").prepend(Object.assign(document.createElement("li"), { textContent: sentence }));
}

function showCost() {
  if (live.simulated < 1) return;
  const times = live.simulated / live.busy;
  at("cost").textContent = `${times.toFixed(0)} times real time on this machine`;
}

function draw() {
  const { simulation, before } = live, { time, kernel, stop } = simulation;
  live.side.draw(simulation, live.line);
  if (!at("section-box").hidden) live.section.draw(simulation);
  if (live.frames % CHART_FRAMES === 0) {
    const beside = before && stop.begun ? { ...before, shift: stop.begun.time - before.begun } : null;
    live.charts.forEach((chart, number) => chart.draw(simulation.history, number === 0 ? beside : null));
  }
  const now = stop.ended ?? { time, distance: kernel.get("distance") };
  const since = stop.begun && `, ${(now.distance - stop.begun.distance).toFixed(0)} m and ${(now.time - stop.begun.time).toFixed(1)} s since braking`;
  at("state").textContent = `${(3.6 * kernel.get("speed")).toFixed(1)} km/h${since ?? ""}`;
}

function frame(now) {
  const seconds = (now - (live.last ?? now)) / 1e3;
  live.last = now;
  live.frames += 1;
  if (live.simulation) {
    const moves = live.running && !live.simulation.ended;
    if (moves) goOn(seconds);
    if (live.frames % 30 === 0) showCost();
    // What stands still is drawn on a little, until charts have had their turn, and then costs nothing.
    live.still = moves ? 0 : live.still + 1;
    if (live.still <= CHART_FRAMES) draw();
  }
  requestAnimationFrame(frame);
}

// Plays the run of an address.
async function openLink(hash) {
  const { settings, plan, sentences } = readLink(hash.replace(/^#/, ""));
  for (const [name, value] of Object.entries(settings)) show(name, value);
  await restart(plan);
  sentences.forEach(tell);
  markRun(hash);
}

function listRuns() {
  addRuns(DATA.presets, openLink);
  const train = besides(/live\.html$/, "train.html");
  if (train) addRun("A train's pipe empties", `${train}#do=50:emergency`).target = "_top";
}

function fillChoices() {
  for (const [name, { title }] of Object.entries(DATA.machines)) at("machine").append(new Option(title, name));
  for (const radius of Object.keys(DATA.curves))
    at("curve").append(new Option(radius === "0" ? "straight" : `curve of ${radius} m`, radius));
}

async function share() {
  showLink();
  try {
    await navigator.clipboard.writeText(location.href);
    at("share").textContent = "link copied";
  } catch {
    at("share").textContent = "the link is the address above";
  }
  setTimeout(() => { at("share").textContent = "copy link"; }, 3000);
}

function listen() {
  for (const name of ACTS) at(name).addEventListener("input", () => act(name));
  for (const name of STARTS) at(name).addEventListener("change", () => restart());
  for (const event of ["resize", "click"]) addEventListener(event, () => { live.still = 0; });
  addEventListener("hashchange", () => openLink(location.hash));
  onBrake(pressBrake);
  onPause(live);
  at("leaves").addEventListener("click", () => act("leaves"));
  at("restart").addEventListener("click", () => restart());
  at("share").addEventListener("click", share);
  at("table").addEventListener("click", () => save("run.csv", live.simulation.table()));
  look.changed = () => { live.still = 0; };
}

function begin() {
  fillChoices();
  listRuns();
  listen();
  if (new URLSearchParams(location.hash.slice(1)).has("embed")) document.body.className = "embedded";
  if (document.body.className || innerWidth < 900) at("more").open = false;
  live.side = new SideView(at("side"));
  live.section = new SectionView(at("section"), DATA.colours);
  at("about").textContent = `bogie-braking ${DATA.version}, after Y. A. Handoko (2006).`;
  at("about").title = Object.values(DATA.machines).map(({ title, guid }) => `model of the ${title}: ${guid}`).join("\n");
  requestAnimationFrame(frame);
  return openLink(location.hash);
}

live.ready = begin();
