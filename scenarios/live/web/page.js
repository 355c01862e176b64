// The page itself: controls, the loop of frames, and what it costs.

const LONGEST_FRAME = 0.1; // a page that was asleep does not catch up [s]
const CHART_FRAMES = 4; // charts are drawn in one frame of so many
const PATCH = { ahead: 25, length: 40, friction: 0.05 };
const DATA = JSON.parse(document.getElementById("data").textContent);
const at = (name) => document.getElementById(name);

const live = { modules: {}, kernels: {}, simulation: null, running: true, frames: 0, busy: 0, simulated: 0, still: 0, costs: {} };

async function moduleOf(name) {
  live.modules[name] ??= await loadModule(DATA.machines[name].module);
  return live.modules[name];
}

async function choose(name) {
  const machine = DATA.machines[name], module = await moduleOf(name);
  live.kernels[name] ??= await Kernel.create(module, machine.variables);
  live.simulation = new Simulation(live.kernels[name], machine, DATA.protection);
  live.charts = chartsOf(machine.wheelsets.length);
  live.costs = {};
  restart();
  for (const level of [1, 2, 3]) live.costs[level] = await timesRealTime(module, machine, DATA.protection, level);
  showCosts();
}

function restart() {
  const wave = Number(at("rails").value) / 1e3;
  at("handle").value = 0;
  readControls();
  live.simulation.restart({
    level: Number(at("level").value),
    initial_speed: Number(at("speed").value) / 3.6,
    ...(at("level").value === "3" ? { lateral_irregularity: wave } : {}),
  });
  at("sentences").replaceChildren();
  live.left = live.busy = live.simulated = live.still = 0;
  const spatial = at("level").value === "3";
  at("section").hidden = !spatial;
  at("section-note").hidden = spatial;
  showCosts();
}

function readControls() {
  const handle = Number(at("handle").value) / 100, friction = Number(at("friction").value);
  Object.assign(live.simulation.controls, { handle, friction, protection: at("protection").checked });
  live.still = 0;
  const { fullPressure, fullTraction } = live.simulation.machine;
  at("handle-value").value = handle < 0
    ? `brake: ${((-handle * fullPressure) / 1e3).toFixed(0)} kPa demanded`
    : handle > 0 ? `traction: ${((handle * fullTraction) / 1e3).toFixed(1)} kN.m a wheelset` : "rolling";
  at("friction-value").value = friction.toFixed(2);
}

function chartsOf(count) {
  const numbers = Array.from({ length: count }, (_, number) => number);
  const colours = count > 2 ? DATA.colours : [DATA.colours[0], DATA.colours[3]];
  const each = (name) => numbers.map((n) => ({ label: `${n + 1}`, colour: colours[n], value: (point) => point[name][n] }));
  const train = { label: "vehicle", colour: INK, heavy: true, value: (point) => point.speed };
  return [
    new Chart(at("chart-speed"), "vehicle, wheels [km/h]", [train, ...each("wheels")], [0, 10]),
    new Chart(at("chart-slip"), "slip of the wheels [%]", each("slip"), [-2, 10]),
    new Chart(at("chart-pressure"), "cylinder pressure [kPa]", each("pressure"), [0, 400]),
    new Chart(at("chart-load"), "axle load [kN]", each("load"), [0, 10]),
  ];
}

// Times real time of each level, and what a millisecond costs; that which runs as it runs, once it has run a while.
function showCosts() {
  const now = Number(at("level").value);
  if (live.simulated > 1) live.costs[now] = live.simulated / live.busy;
  const rows = Object.entries(live.costs).map(([level, times]) => {
    const row = document.createElement("tr"), name = at("level").options[level - 1].text;
    row.className = Number(level) === now ? "now" : "";
    for (const text of [name, times.toFixed(0), `${(1e3 / times).toPrecision(2)} us`])
      row.append(Object.assign(document.createElement("td"), { textContent: text }));
    return row;
  });
  at("costs").tBodies[0].replaceChildren(...rows);
}

function goOn(seconds) {
  const { simulation } = live, begin = performance.now();
  live.left += Number(at("pace").value) * Math.min(seconds, LONGEST_FRAME);
  const whole = Math.floor(live.left / PERIOD) * PERIOD;
  live.left -= whole;
  simulation.advance(whole);
  live.busy += (performance.now() - begin) / 1e3;
  live.simulated += whole;
  for (const sentence of simulation.sentences.splice(0)) tell(sentence);
  if (simulation.ended && live.told !== simulation) {
    tell(`${simulation.ended} Start anew.`, "end");
    live.told = simulation;
  }
}

function tell(sentence, kind = "") {
  at("sentences").prepend(Object.assign(document.createElement("li"), { textContent: sentence, className: kind }));
}

function draw() {
  live.side.draw(live.simulation);
  if (at("level").value === "3") live.section.draw(live.simulation);
  if (live.frames % CHART_FRAMES === 0) for (const chart of live.charts) chart.draw(live.simulation.history);
  const { time, kernel } = live.simulation;
  at("state").textContent = `${time.toFixed(1)} s, ${(3.6 * kernel.get("speed")).toFixed(1)} km/h, ${kernel.get("distance").toFixed(0)} m`;
}

function frame(now) {
  const seconds = (now - (live.before ?? now)) / 1e3;
  live.before = now;
  live.frames += 1;
  if (live.simulation) {
    const moves = live.running && !live.simulation.ended;
    if (moves) goOn(seconds);
    if (live.frames % 30 === 0) showCosts();
    // What stands still is drawn on a little, until charts have had their turn, and then costs nothing.
    live.still = moves ? 0 : live.still + 1;
    if (live.still <= CHART_FRAMES) draw();
  }
  requestAnimationFrame(frame);
}

function begin() {
  for (const [name, { title }] of Object.entries(DATA.machines)) at("machine").append(new Option(title, name));
  live.side = new SideView(at("side"), DATA.colours);
  live.section = new SectionView(at("section"), DATA.colours);
  for (const name of ["handle", "friction", "protection"]) at(name).addEventListener("input", readControls);
  for (const event of ["resize", "click"]) addEventListener(event, () => { live.still = 0; });
  for (const name of ["level", "speed", "rails"]) at(name).addEventListener("change", restart);
  at("machine").addEventListener("change", () => choose(at("machine").value));
  at("restart").addEventListener("click", restart);
  at("patch").addEventListener("click", () => live.simulation.addPatch(PATCH.ahead, PATCH.length, PATCH.friction));
  at("pause").addEventListener("click", () => {
    live.running = !live.running;
    at("pause").textContent = live.running ? "pause" : "go on";
  });
  const guids = Object.values(DATA.machines).map(({ guid }) => guid).join(", ");
  at("about").textContent = `bogie-braking ${DATA.version}; models ${guids}. After Y. A. Handoko (2006).`;
  requestAnimationFrame(frame);
  return choose("bogie");
}

live.ready = begin();
