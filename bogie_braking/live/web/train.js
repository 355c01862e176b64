// A train: the C of its FMU, whose arrays are views into its memory, and a driver who moves the controls of the desk.

const AROUND = 101325; // pressure outside [Pa]
const STEP = 0.02; // of a run [s]; a link counts in it
const KEPT = 5, LONGEST_RUN = 3600; // steps between points of the history; [s]
const RESTS = 0.01; // at lower speeds the train is at rest [m/s]
const RUNNING = 1, OVERCHARGE = 2, SERVICE = 3, EMERGENCY = 4, CONTINUOUS = 6; // positions of the driver's valve
// Inputs by name; unit: that of a lever, 1 of an integer, otherwise %; most: the end of the lever in this unit.
const INPUT = Object.fromEntries(DATA.inputs.map((input) => [input.name, { ...input, unit: input.whole ? 1 : 100, most: input.most * (input.whole ? 1 : 100) }]));

class Train {
  static async create(module, consist) {
    const system = new Proxy({}, { get: () => () => 8 }), { numbers } = consist; // WASI: no file exists
    const { exports } = await WebAssembly.instantiate(module, { wasi_snapshot_preview1: system });
    exports._initialize();
    const place = exports.malloc(8 * numbers.length), count = BigInt(numbers.length);
    new Float64Array(exports.memory.buffer, place, numbers.length).set(numbers);
    const wrong = exports.train_wrong(place, count);
    if (wrong) {
      const [text] = new TextDecoder().decode(new Uint8Array(exports.memory.buffer, wrong, 200)).split("\0");
      throw new Error(`These numbers make no train of this version: ${text} cannot be.`);
    }
    const self = exports.train_create(place, count);
    if (!self) throw new Error("There is no memory for the train.");
    consist.lay();
    return new Train(exports, self, consist);
  }

  constructor(exports, self, consist) {
    Object.assign(this, { exports, self, consist, vehicles: consist.vehicles, views: {}, room: exports.malloc(8) });
    const names = Object.keys({ ...DATA.controls, ...DATA.equipment }), known = DATA.inputs.filter(({ name }) => names.includes(name));
    known.sort((a, b) => names.indexOf(a.name) - names.indexOf(b.name));
    this.notches = consist.notches; // from release to emergency, with position and step of the valve
    this.controls = Object.fromEntries(known.map((input) => [input.name, consist.owners(input)]).filter(([, owners]) => owners.length));
  }

  // A view of an input or output; those of a memory that has grown are made again.
  array(which, row) {
    const { memory } = this.exports, before = this.views[which + row];
    if (before?.buffer === memory.buffer) return before;
    const place = this.exports[`train_${which}`](this.self, row, this.room);
    const count = Number(new DataView(memory.buffer).getBigInt64(this.room, true));
    return (this.views[which + row] = new Float64Array(memory.buffer, place, count));
  }

  input(name) { return this.array("input", DATA.inputs.findIndex((input) => input.name === name)); }
  output(name) { return this.array("output", DATA.outputs.indexOf(name)); }
  pressure(name) { return Float32Array.from(this.output(name), (pressure) => pressure - AROUND); }

  // The first notch of a position; of service the one of most.
  notchOf(position) {
    const those = Object.keys(this.notches).filter((name) => this.notches[name][0] === position);
    return those.sort((a, b) => this.notches[b][1] - this.notches[a][1])[0];
  }

  get fullService() { return this.notchOf(SERVICE) ?? this.notchOf(CONTINUOUS); }
  get released() { return [RUNNING, OVERCHARGE].includes(this.notches[this.valve][0]); }

  // plan: later actions, as [step, name, value]; name: a notch, "part", or a control with its value; `act` ends it.
  begin(speed, place = 0, plan = []) {
    this.exports.train_begin(this.self, 0, speed, place, this.consist.columns["valve.running"][0], AROUND);
    const couplings = Array(this.vehicles - 1).fill(0), levers = Object.fromEntries(Object.keys(this.controls).map((name) => [name, 0]));
    Object.assign(this, { steps: 0, plan: [...plan], done: [], history: [], begun: null, stopped: null, valve: this.notchOf(RUNNING), parted: false, levers });
    Object.assign(this, { pushed: [...couplings], pulled: [...couplings] });
    this.keep();
  }

  get time() { return this.steps * STEP; }
  get speed() { return this.output("speed")[0]; }
  get distance() { return this.output("distance")[0]; }
  get front() { return this.distance - this.consist.columns["frame.centre"][0]; }
  get rear() { return this.output("distance").at(-1) - this.consist.columns["frame.length"].at(-1) / 2; }
  get ended() { return (this.stopped !== null && !this.plan.length) || this.time > LONGEST_RUN; }
  get brakes() {
    const lever = Object.entries(this.levers).some(([name, value]) => value > 0 && (DATA.controls[name]?.brakes ?? false));
    return lever || this.parted || !this.released;
  }

  act(name, value) {
    this.plan = [];
    if (name !== this.valve && (!(name in this.levers) || this.levers[name] !== value)) this.apply(name, value);
  }

  apply(name, value) {
    const last = this.done.at(-1);
    if (last && last[0] === this.steps && last[1] === name && name in this.levers) this.done.pop();
    this.done.push(name in this.levers ? [this.steps, name, value] : [this.steps, name]);
    if (name === "part") this.part();
    else if (Object.hasOwn(this.notches, name)) this.drive(name);
    else this.set(name, value);
    if (!this.brakes) {
      this.begun = this.stopped = null;
      this.pushed.fill(0);
      this.pulled.fill(0);
    } else if (!this.begun && Math.abs(this.speed) > RESTS) this.begun = { time: this.time, distance: this.distance, speed: this.speed };
  }

  drive(name) {
    this.valve = name;
    [this.input("driver_position")[0], this.input("driver_step")[0]] = this.notches[name];
  }

  // A control of the desk, on all vehicles that have the equipment.
  set(name, value) {
    this.levers[name] = value;
    for (const owner of this.controls[name]) this.input(name)[owner] = value / INPUT[name].unit;
  }

  part() {
    this.parted = true;
    const middle = Math.floor(this.vehicles / 2) - 1;
    this.input("coupling_closed")[middle] = 0;
    this.input("hose_state")[middle] = 2;
  }

  step() {
    while (this.plan.length && this.plan[0][0] <= this.steps) this.apply(...this.plan.shift().slice(1));
    if (this.exports.train_go(this.self, STEP)) throw new Error("The train came to no finite state.");
    this.steps += 1;
    const force = this.output("coupler_force");
    for (let i = 0; i < force.length; i += 1) {
      if (-force[i] > this.pushed[i]) this.pushed[i] = -force[i];
      if (force[i] > this.pulled[i]) this.pulled[i] = force[i];
    }
    if (this.steps % KEPT === 0) this.keep();
    if (this.begun && !this.stopped && Math.abs(this.speed) < RESTS) this.stopped = { time: this.time, distance: this.distance };
  }

  keep() {
    const point = { time: this.time, speed: 3.6 * this.speed, distance: this.distance, front: this.front };
    this.history.push({ ...point, pipe: this.pressure("pipe_pressure"), cylinder: this.pressure("cylinder_pressure"), force: Float32Array.from(this.output("coupler_force")) });
  }

  // The final message.
  sentence() {
    if (!this.stopped) return `The run ends after ${LONGEST_RUN} s.`;
    const { begun, stopped } = this, kilo = (forces) => `${(Math.max(0, ...forces) / 1e3).toFixed(0)} kN`;
    return `The head stopped in ${(stopped.distance - begun.distance).toFixed(1)} m and ${(stopped.time - begun.time).toFixed(1)} s from `
      + `${(3.6 * begun.speed).toFixed(0)} km/h; couplers were pushed by ${kilo(this.pushed)} and pulled by ${kilo(this.pulled)} at most.`;
  }
}
