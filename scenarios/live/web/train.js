// A train on a page: the C of its FMU, a driver's valve, and what happens along it.

const DATA = JSON.parse(document.getElementById("data").textContent);
const AROUND = 101325, FULL = 3.8e5, RUNNING = 5e5, LONGEST_STEP = 0.05, MOST_FORCE = 4e5;
const VALVE = { running: [1, 0], "first step": [3, 0], "half service": [3, 0.4], "full service": [3, 1], emergency: [4, 0], overcharge: [2, 0] };
const INPUT = { position: 0, step: 1, coupled: 5, joined: 6 };
const OUTPUT = { distance: 0, speed: 1, pipe: 3, cylinder: 4, force: 7 };

// A train of numbers that Python has written; arrays are views into its memory.
class Train {
  static async create(module, numbers) {
    const system = new Proxy({}, { get: () => () => 8 });
    const { exports } = await WebAssembly.instantiate(module, { wasi_snapshot_preview1: system });
    exports._initialize();
    const place = exports.malloc(8 * numbers.length);
    new Float64Array(exports.memory.buffer, place, numbers.length).set(numbers);
    const self = exports.train_create(place, BigInt(numbers.length));
    if (!self) throw new Error("The train could not be made.");
    return new Train(exports, self, numbers[0]);
  }

  constructor(exports, self, vehicles) {
    Object.assign(this, { exports, self, vehicles });
    this.room = exports.malloc(8);
  }

  array(which, row) {
    const place = this.exports[`train_${which}`](this.self, row, this.room);
    const count = Number(new DataView(this.exports.memory.buffer).getBigInt64(this.room, true));
    return new Float64Array(this.exports.memory.buffer, place, count);
  }

  input(name) { return this.array("input", INPUT[name]); }
  output(name) { return this.array("output", OUTPUT[name]); }
  begin(speed) { this.exports.train_begin(this.self, 0, speed, 0, RUNNING + AROUND, AROUND); }

  drive(name) {
    [this.input("position")[0], this.input("step")[0]] = VALVE[name];
  }

  part() {
    const middle = Math.floor(this.vehicles / 2) - 1;
    this.input("coupled")[middle] = 0;
    this.input("joined")[middle] = 2;
  }

  advance(time) {
    if (this.exports.train_go(this.self, time)) throw new Error("The train came to no finite state.");
  }
}

async function unpacked(text) {
  const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  const plain = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Response(plain).arrayBuffer();
}

// ---- the picture ----

// Rows of bars along the train: pressure of the pipe, of cylinders, forces of couplers.
function draw(canvas, train) {
  const { context, width, height } = sharp(canvas);
  const box = { left: 52, right: width - 10 }, rows = [0.05, 0.37, 0.69].map((share) => share * height), size = 0.24 * height;
  const n = train.vehicles, x = (i) => box.right - ((box.right - box.left) * (i + 1)) / n;
  const wide = Math.max((box.right - box.left) / n - 1, 1);
  const bars = (row, values, most, colour, offset = 0) => values.forEach((value, i) => {
    const tall = Math.max(-1, Math.min(1, value / most)) * size;
    context.fillStyle = colour(value);
    context.fillRect(x(i) - offset, tall >= 0 ? rows[row] + size - tall : rows[row] + size, wide, Math.abs(tall));
  });
  const label = (row, text, marks) => {
    context.fillStyle = "#333333";
    context.fillText(text, box.left, rows[row] - 4);
    for (const [share, mark] of marks) context.fillText(mark, 6, rows[row] + size * (1 - share) + 4);
  };
  bars(0, [...train.output("pipe")].map((p) => p - AROUND), RUNNING * 1.1, () => "#0072b2");
  label(0, "pressure in the pipe [bar]; the head is on the right", [[0, "0"], [1 / 1.1, "5.0"]]);
  bars(1, [...train.output("cylinder")].map((p) => p - AROUND), FULL * 1.1, () => "#d55e00");
  label(1, "pressure in the cylinders [bar]", [[0, "0"], [1 / 1.1, "3.8"]]);
  rows[2] -= size / 2 - 6;
  bars(2, [...train.output("force")], 2 * MOST_FORCE, (force) => (force < 0 ? "#e69f00" : "#56b4e9"), wide / 2);
  label(2, "", [[0, "0"], [0.5, "+400"], [-0.5, "-400"]]);
  context.fillText("forces of couplers [kN]: pulled above, pushed below", box.left, rows[2] + size * 0.42);
}

// ---- the page ----

const live = { running: true, train: null, time: 0, module: null };
const element = (id) => document.getElementById(id);

async function start() {
  live.module ??= await WebAssembly.compile(await unpacked(DATA.module));
  const numbers = new Float64Array(await unpacked(DATA.consists[element("consist").value]));
  const train = await Train.create(live.module, numbers);
  train.begin(Number(element("speed").value) / 3.6);
  Object.assign(live, { train, time: 0 });
  press("running");
  show();
}

function press(name) {
  live.train.drive(name);
  for (const button of element("valve").children) button.setAttribute("aria-pressed", button.textContent === name);
}

function show() {
  const { train } = live;
  draw(element("train-view"), train);
  const speed = train.output("speed")[0], force = [...train.output("force")];
  const pushed = force.length ? -Math.min(...force) / 1e3 : 0;
  element("state").textContent = `${live.time.toFixed(1)} s, ${(3.6 * speed).toFixed(1)} km/h, ${train.output("distance")[0].toFixed(0)} m; `
    + `couplers pushed by ${Math.max(pushed, 0).toFixed(0)} kN at most now`;
}

function advance(time) {
  for (let left = time; left > 1e-9; left -= LONGEST_STEP) live.train.advance(Math.min(left, LONGEST_STEP));
  live.time += time;
  show();
}

let before = null;
function frame(now) {
  if (live.running && live.train && before !== null) advance(Math.min((now - before) / 1e3, 0.1) * Number(element("pace").value));
  before = now;
  requestAnimationFrame(frame);
}

for (const name of Object.keys(VALVE)) {
  const button = document.createElement("button");
  Object.assign(button, { type: "button", textContent: name });
  button.addEventListener("click", () => press(name));
  element("valve").append(button);
}
for (const name of Object.keys(DATA.consists)) element("consist").append(new Option(name, name));
for (const id of ["consist", "speed", "restart"]) element(id).addEventListener(id === "restart" ? "click" : "change", start);
element("part").addEventListener("click", () => live.train.part());
element("pause").addEventListener("click", () => {
  live.running = !live.running;
  element("pause").textContent = live.running ? "pause" : "go on";
});
element("about").textContent = `bogie-braking ${DATA.version}; wagons of 80 t, screw couplers, two cells of the pipe a vehicle.`;
live.ready = start().then(() => requestAnimationFrame(frame));
