// A run of one machine: the driver's controls become inputs of the kernel, step by step, and its outputs a history.

const PERIOD = 5e-3; // between looks at the controls, and of the wheel-slide protection [s]
const WINDOW = 30; // of the history [s]
const KEPT = 10; // every so many steps one point of the history

class Simulation {
  // machine and protection, with its thresholds and sensor: as page.py writes them.
  constructor(kernel, machine, protection) {
    Object.assign(this, { kernel, machine, protection });
    this.controls = { handle: 0, friction: 0.3, protection: true };
    this.count = machine.wheelsets.length;
  }

  // values: start values of the kernel, level and initial_speed among them.
  restart(values) {
    const off = Object.fromEntries(this.each("pressure_demand").map((name) => [name, 0]));
    this.kernel.start({ ...values, ...off });
    this.steps = 0;
    this.patches = [];
    this.history = [];
    this.ended = "";
    this.sentences = [];
    this.guard = new SlideProtection(this.protection.thresholds);
    this.encoders = this.machine.wheelsets.map(() => new Encoder(this.protection.sensor));
    this.valves = Array(this.count).fill(APPLY);
    this.keep();
  }

  each(name) {
    return Array.from({ length: this.count }, (_, number) => `${name}_${number + 1}`);
  }

  read(name) {
    return this.each(name).map((one) => this.kernel.get(one));
  }

  get time() {
    return this.steps * PERIOD;
  }

  // Leaves on the rail: friction [1] over some metres, counted from the front axle.
  addPatch(ahead, length, friction) {
    const begin = this.kernel.get("distance") + this.machine.wheelsets[0].along + ahead;
    this.patches.push({ begin, end: begin + length, friction });
  }

  frictionAt(place) {
    const patch = this.patches.find(({ begin, end }) => place >= begin && place < end);
    return Math.min(this.controls.friction, patch?.friction ?? Infinity);
  }

  // Goes on by some seconds, or to the end of the run; a sentence then says why.
  advance(seconds) {
    const last = this.steps + Math.round(seconds / PERIOD);
    try {
      while (!this.ended && this.steps < last) this.step();
    } catch (error) {
      if (!(error instanceof KernelError)) throw error;
      this.ended = error.message;
    }
    this.sentences.push(...this.kernel.journal());
  }

  step() {
    const { handle, protection } = this.controls;
    const speeds = this.read("rotation").map(
      (rotation, i) => this.machine.wheelsets[i].radius * this.encoders[i].angularVelocity(this.time, rotation));
    const commands = this.guard.step(this.time, speeds);
    this.valves = protection ? commands : commands.map(() => APPLY);
    const inputs = {}, distance = this.kernel.get("distance");
    this.machine.wheelsets.forEach((wheelset, number) => {
      inputs[`pressure_demand_${number + 1}`] = this.machine.fullPressure * Math.max(0, -handle);
      inputs[`traction_torque_${number + 1}`] = this.machine.fullTraction * Math.max(0, handle);
      inputs[`valve_${number + 1}`] = this.valves[number];
      inputs[`friction_${number + 1}`] = this.frictionAt(distance + wheelset.along);
    });
    this.kernel.set(inputs);
    this.kernel.step(this.time, PERIOD);
    this.steps += 1;
    if (this.steps % KEPT === 0) this.keep();
  }

  // One point of the history: speeds [km/h], slips [%], pressures [kPa], wheel loads of an axle [kN].
  keep() {
    const speed = this.kernel.get("speed");
    this.history.push({
      time: this.time,
      speed: 3.6 * speed,
      wheels: this.read("angular_velocity").map((omega, i) => 3.6 * omega * this.machine.wheelsets[i].radius),
      slip: this.read("slip_ratio").map((ratio) => 100 * ratio),
      pressure: this.read("cylinder_pressure").map((pressure) => pressure / 1e3),
      load: this.read("axle_load").map((load) => load / 1e3),
    });
    while (this.history[0].time < this.time - WINDOW) this.history.shift();
  }
}

// How many times faster than real time a level runs here: a stop by full brake on dry rail, the least of three.
async function timesRealTime(module, machine, protection, level) {
  const simulation = new Simulation(await Kernel.create(module, machine.variables), machine, protection);
  let best = 0;
  for (let run = 0; run < 3; run += 1) {
    simulation.restart({ level, initial_speed: 25 });
    simulation.controls.handle = -1;
    const begin = performance.now();
    simulation.advance(5);
    best = Math.max(best, 5e3 / (performance.now() - begin));
  }
  return best;
}
