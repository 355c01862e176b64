// A train: the C of its FMU, whose arrays are views into its memory, and a driver who moves the valve.

const AROUND = 101325, RUNNING = 5e5; // pressures: outside [Pa], and of the pipe above it
const STEP = 0.02; // of a run [s]; a link counts in it
const KEPT = 5, LONGEST_RUN = 1200; // steps between points of the history; [s]
const RESTS = 0.01; // at lower speeds the train is at rest [m/s]
// Names of the driver's positions, with position and step of the valve.
const VALVE = { running: [1, 0], "first step": [3, 0], "half service": [3, 0.4], "full service": [3, 1], emergency: [4, 0], overcharge: [2, 0] };
const BRAKING = ["first step", "half service", "full service", "emergency", "part"];
const RELEASES = ["running", "overcharge"];

class Train {
  static async create(module, numbers) {
    const system = new Proxy({}, { get: () => () => 8 }); // WASI: no file exists
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

  input(name) { return this.array("input", DATA.inputs.indexOf(name)); }
  output(name) { return this.array("output", DATA.outputs.indexOf(name)); }

  // plan: later actions, as [step, name], name of VALVE or "part"; `act` ends it.
  begin(speed, plan = []) {
    this.exports.train_begin(this.self, 0, speed, 0, RUNNING + AROUND, AROUND);
    Object.assign(this, { steps: 0, plan: [...plan], done: [], history: [], begun: null, stopped: null, pushed: 0, pulled: 0, valve: "running", parted: false });
    this.keep();
  }

  get time() { return this.steps * STEP; }
  get speed() { return this.output("speed")[0]; }
  get distance() { return this.output("distance")[0]; }
  get ended() { return this.stopped !== null || this.time > LONGEST_RUN; }

  act(name) {
    this.plan = [];
    this.apply(name);
  }

  apply(name) {
    this.done.push([this.steps, name]);
    if (name === "part") this.part();
    else this.drive(name);
    if (RELEASES.includes(name) && !this.parted) Object.assign(this, { begun: null, pushed: 0, pulled: 0 });
    if (!this.begun && BRAKING.includes(name) && this.speed > RESTS) this.begun = { time: this.time, distance: this.distance, speed: this.speed };
  }

  drive(name) {
    this.valve = name;
    [this.input("driver_position")[0], this.input("driver_step")[0]] = VALVE[name];
  }

  part() {
    this.parted = true;
    const middle = Math.floor(this.vehicles / 2) - 1;
    this.input("coupling_closed")[middle] = 0;
    this.input("hose_state")[middle] = 2;
  }

  step() {
    while (this.plan.length && this.plan[0][0] <= this.steps) this.apply(this.plan.shift()[1]);
    if (this.exports.train_go(this.self, STEP)) throw new Error("The train came to no finite state.");
    this.steps += 1;
    for (const force of this.output("coupler_force")) {
      this.pushed = Math.max(this.pushed, -force);
      this.pulled = Math.max(this.pulled, force);
    }
    if (this.steps % KEPT === 0) this.keep();
    if (this.begun && !this.stopped && this.speed < RESTS) this.stopped = { time: this.time, distance: this.distance };
  }

  keep() {
    this.history.push({ time: this.time, speed: 3.6 * this.speed, distance: this.distance });
  }

  // The final message.
  sentence() {
    if (!this.stopped) return `The run ends after ${LONGEST_RUN} s.`;
    const { begun, stopped } = this, kilo = (force) => `${(force / 1e3).toFixed(0)} kN`;
    return `The head stopped in ${(stopped.distance - begun.distance).toFixed(1)} m and ${(stopped.time - begun.time).toFixed(1)} s from `
      + `${(3.6 * begun.speed).toFixed(0)} km/h; couplers were pushed by ${kilo(this.pushed)} and pulled by ${kilo(this.pulled)} at most.`;
  }
}
