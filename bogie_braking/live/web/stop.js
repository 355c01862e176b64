// One stop, from the last move of the lever to braking until rest: distance, time, and locks of the wheelsets.

const RESTS = 0.01; // at lower speeds a vehicle is at rest [m/s]
const MOVES = 0.5; // at lower speeds braking begins no stop [m/s]
const SWAYS = 1.5; // simulated time after rest, for its bodies to come to rest [s]
const BRIEF = 0.05; // shorter locks are reported without their duration [s]

class Stop {
  // count: of wheelsets.
  constructor(count) {
    Object.assign(this, { begun: null, ended: null, slides: false });
    this.forget(count);
  }

  forget(count) {
    Object.assign(this, { vented: 0, before: [], locked: Array(count).fill(0) });
  }

  // Called before each step: present kernel and valves; whether the lever brakes.
  follow(time, kernel, valves, brakes) {
    if (this.ended) return;
    const speed = kernel.get("speed"), now = { time, speed, distance: kernel.get("distance") };
    if (!this.begun || !brakes) {
      this.begun = brakes && Math.abs(speed) > MOVES ? now : null;
      this.forget(valves.length);
      return;
    }
    if (speed * Math.sign(this.begun.speed) < RESTS) {
      this.ended = now;
      return;
    }
    this.locked = this.locked.map((steps, i) => steps + (kernel.get(`locked_${i + 1}`) > 0.5 ? 1 : 0));
    valves.forEach((valve, i) => { this.vented += valve === VENT && this.before[i] !== VENT ? 1 : 0; });
    this.before = [...valves];
  }

  get distance() {
    return Math.abs(this.ended.distance - this.begun.distance);
  }

  // The final message; period [s] of the recorded steps.
  sentence(period) {
    const seconds = this.ended.time - this.begun.time;
    const from = `${(3.6 * Math.abs(this.begun.speed)).toFixed(0)} km/h`;
    const vents = this.vented === 0 ? "" : this.vented === 1 ? " A valve let air out once." : ` Valves let air out ${this.vented} times.`;
    return `Stopped in ${this.distance.toFixed(1)} m and ${seconds.toFixed(1)} s from ${from}; ${this.lockedWords(period)}.${vents}`
      + (this.slides ? " It then slides back: the brake does not hold it." : "");
  }

  lockedWords(period) {
    const times = this.locked.map((steps, i) => [i + 1, steps * period]).filter(([, time]) => time > 0);
    if (!times.length) return "no wheelset locked";
    const lasts = (time) => (time < BRIEF ? "less than 0.1 s" : `${time.toFixed(1)} s`);
    const longest = lasts(Math.max(...times.map(([, time]) => time)));
    if (times.length === this.locked.length) return `all wheelsets locked, for up to ${longest}`;
    return times.map(([number, time]) => `wheelset ${number} locked for ${lasts(time)}`).join(", ");
  }
}
