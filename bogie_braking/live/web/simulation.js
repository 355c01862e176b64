// A run of one vehicle: the driver's controls become inputs of the kernel, step by step, and its outputs a history.

const PERIOD = DATA.period; // sampling interval of the controls and of the wheel-slide protection [s]
const KEPT = 10; // steps between points of the history
const LONGEST_RUN = 1200; // [s]
const LEAVES = { ahead: 25, length: 100, friction: 0.05 }; // [m], [1]

class Simulation {
  // machine and sensor: as page.py writes them.
  constructor(kernel, machine, sensor) {
    Object.assign(this, { kernel, machine });
    this.count = machine.wheelsets.length;
    this.guard = kernel.guard ??= new SlideProtection(kernel, sensor, machine.wheelsets.map(({ radius }) => radius));
  }

  // values: start values of the kernel, level and initial_speed among them. texts: contents of files, by variable.
  // controls: lever from -1 (drives) to 1 (brakes fully), friction, protection, uneven (share by which the first
  // wheelset's shoes differ), gradient (0 if a line's file has it). plan: later actions, as [step, control, value];
  // `act` ends it.
  restart(values, texts, controls, plan = []) {
    const off = Object.fromEntries(this.each("pressure_demand").map((name) => [name, 0]));
    this.controls = { lever: 0, friction: 0.3, protection: true, uneven: 0, gradient: 0, ...controls };
    this.kernel.start({ ...values, ...off, gradient: this.controls.gradient }, texts);
    Object.assign(this, { steps: 0, patches: [], history: [], ended: "", lifted: false, messages: [], done: [], plan: [...plan] });
    this.stop = new Stop(this.count);
    this.guard.begin(PERIOD);
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

  // An action of the user; the rest of the plan is dropped.
  act(name, value) {
    this.plan = [];
    this.apply(name, value);
  }

  apply(name, value) {
    const last = this.done.at(-1);
    if (last && last[0] === this.steps && last[1] === name && name !== "leaves") this.done.pop();
    this.done.push([this.steps, name, value]);
    if (name === "leaves") this.addPatch(LEAVES.ahead, LEAVES.length, LEAVES.friction);
    else this.controls[name] = value;
  }

  // Leaves on the rail: friction [1] over some metres, measured from the front axle.
  addPatch(ahead, length, friction) {
    const begin = this.kernel.get("distance") + this.machine.wheelsets[0].along + ahead;
    this.patches.push({ begin, end: begin + length, friction });
  }

  frictionAt(place) {
    const patch = this.patches.find(({ begin, end }) => place >= begin && place < end);
    return Math.min(this.controls.friction, patch?.friction ?? Infinity);
  }

  // Advances by some seconds, or to the end of the run, which returns a message.
  advance(seconds) {
    const last = this.steps + Math.round(seconds / PERIOD);
    try {
      while (!this.ended && this.steps < last) this.step();
    } catch (error) {
      if (!(error instanceof SimulationError)) throw error;
      this.ended = error.message;
    }
    const heard = this.kernel.messages();
    this.messages.push(...heard);
    this.lifted ||= heard.some((sentence) => sentence.includes("came off its rail"));
  }

  step() {
    while (this.plan.length && this.plan[0][0] <= this.steps) this.apply(...this.plan.shift().slice(1));
    const { lever, protection } = this.controls;
    const commands = this.guard.step(this.time, this.read("rotation"));
    this.valves = protection ? commands : commands.map(() => APPLY);
    this.stop.follow(this.time, this.kernel, this.valves, lever > 0);
    this.kernel.set(this.inputs());
    this.kernel.step(this.time, PERIOD);
    this.steps += 1;
    if (this.steps % KEPT === 0) this.keep();
    const stands = this.stop.ended && this.time > this.stop.ended.time + SWAYS;
    if (stands) {
      this.stop.slides = Math.abs(this.kernel.get("speed")) > RESTS;
      this.ended = this.stop.sentence(PERIOD);
    } else if (this.time > LONGEST_RUN) this.ended = `The run ends after ${LONGEST_RUN} s.`;
  }

  inputs() {
    const { lever } = this.controls, { fullPressure, fullTraction } = this.machine, inputs = { gradient: this.controls.gradient };
    const distance = this.kernel.get("distance");
    this.machine.wheelsets.forEach((wheelset, number) => {
      inputs[`pressure_demand_${number + 1}`] = fullPressure * Math.max(0, lever);
      inputs[`traction_torque_${number + 1}`] = fullTraction * Math.max(0, -lever);
      inputs[`valve_${number + 1}`] = this.valves[number];
      inputs[`friction_${number + 1}`] = this.frictionAt(distance + wheelset.along);
    });
    const share = this.kernel.get("cylinder_pressure_1") / fullPressure;
    inputs.yaw_torque_1 = this.controls.uneven * this.machine.fullYaw * share;
    return inputs;
  }

  // One point of the history: speeds [km/h], slips [%], pressures [kPa], wheel loads of an axle [kN].
  keep() {
    this.history.push({
      time: this.time,
      distance: this.kernel.get("distance"),
      lever: this.controls.lever,
      speed: 3.6 * this.kernel.get("speed"),
      wheels: this.read("angular_velocity").map((omega, i) => 3.6 * omega * this.machine.wheelsets[i].radius),
      slip: this.read("slip_ratio").map((ratio) => 100 * ratio),
      pressure: this.read("cylinder_pressure").map((pressure) => pressure / 1e3),
      load: this.read("axle_load").map((load) => load / 1e3),
      valve: [...this.valves],
    });
  }

  // The history as rows of a table for other programs, the first with the heads.
  table() {
    const numbers = Array.from({ length: this.count }, (_, i) => i + 1);
    const each = { wheels: "wheel speed # [km/h]", slip: "slip # [%]", pressure: "cylinder pressure # [kPa]", load: "axle load # [kN]",
      valve: "valve # (0 apply 1 hold 2 vent)" };
    const heads = ["time [s]", "distance [m]", "speed [km/h]", "lever (1 full brake)"];
    for (const text of Object.values(each)) heads.push(...numbers.map((number) => text.replace("#", number)));
    const rows = this.history.map((point) => [
      point.time, point.distance, point.speed, point.lever, ...Object.keys(each).flatMap((name) => point[name])]);
    return [heads, ...rows];
  }
}
