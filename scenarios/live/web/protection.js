// Wheel-slide protection: brake_controller/wheel_slide.py in the page's language, line by line; a test holds both to the
// same commands. A page cannot run Python, and a controller has no equations that C could be made from.

const APPLY = 0, HOLD = 1, VENT = 2;
const ROLLING = 0.3, SHORTEST_RELEASE = 0.25, LONGEST_RELEASE = 0.8, FREELY_BRAKED = 0.3;
const SHORTEST_BETWEEN = 0.5, LEAST_DECELERATION = 0.1;

class SlideProtection {
  constructor(parameters) {
    Object.assign(this, { parameters, time: null, wheels: [], released: null, actedAt: -Infinity });
  }

  step(time, speeds) {
    if (this.time === null) this.start(time, speeds);
    const size = time - this.time;
    this.time = time;
    if (size > 0) this.observe(size, speeds);
    return this.wheels.map((_, number) => this.command(number));
  }

  start(time, speeds) {
    this.time = this.synchronisedAt = time;
    this.wheels = speeds.map((speed) => ({
      speed, acceleration: 0, ventsSince: null, speedsUp: false, blockedUntil: -Infinity,
    }));
    this.reference = this.synchronisedSpeed = Math.max(...speeds);
    this.deceleration = this.parameters.first_deceleration;
  }

  observe(size, speeds) {
    const share = size / (size + this.parameters.filter_time);
    this.wheels.forEach((wheel, number) => {
      const change = share * (speeds[number] - wheel.speed);
      wheel.speed += change;
      wheel.acceleration += share * (change / size - wheel.acceleration);
    });
    const fastest = Math.max(...this.wheels.map((wheel) => wheel.speed));
    this.reference = Math.max(fastest, this.reference - this.believedDeceleration() * size, 0);
    const caughtUp = this.wheels.filter((wheel) => this.hasCaughtUp(wheel)).map((wheel) => wheel.speed);
    if (caughtUp.length) this.synchronise(Math.max(...caughtUp));
    else if (this.isQuiet() && this.reference === fastest) this.synchronise(fastest);
  }

  believedDeceleration() {
    const largest = this.parameters.largest_deceleration;
    if (this.isQuiet()) return largest;
    if (this.time - this.actedAt < FREELY_BRAKED) return this.deceleration;
    const fastest = this.wheels.reduce((one, other) => (other.speed > one.speed ? other : one));
    return Math.max(this.deceleration, Math.min(-fastest.acceleration, largest));
  }

  isQuiet() {
    return this.time - this.actedAt > this.parameters.synchronising_period;
  }

  hasCaughtUp(wheel) {
    if (wheel.ventsSince === null) return false;
    wheel.speedsUp ||= wheel.acceleration > 2 * ROLLING;
    const longEnough = wheel.speedsUp ? SHORTEST_RELEASE : LONGEST_RELEASE;
    return wheel.acceleration < ROLLING && this.time - wheel.ventsSince > longEnough;
  }

  synchronise(speed) {
    const elapsed = this.time - this.synchronisedAt;
    if (elapsed > SHORTEST_BETWEEN) {
      const measured = (this.synchronisedSpeed - speed) / elapsed;
      this.deceleration = Math.min(Math.max(measured, LEAST_DECELERATION), this.parameters.largest_deceleration);
      this.synchronisedAt = this.time;
      this.synchronisedSpeed = speed;
    }
    this.reference = speed;
    this.released = null;
  }

  command(number) {
    const { slowest, watchdog } = this.parameters, wheel = this.wheels[number];
    if (this.reference < slowest || this.time < wheel.blockedUntil) {
      wheel.ventsSince = null;
      return APPLY;
    }
    const command = this.isReleased(number) ? VENT : this.bySlip(wheel);
    if (command !== APPLY) this.actedAt = this.time;
    if (command !== VENT) wheel.ventsSince = null;
    else if (wheel.ventsSince === null) Object.assign(wheel, { ventsSince: this.time, speedsUp: false });
    else if (this.time - wheel.ventsSince > watchdog) {
      wheel.blockedUntil = this.time + watchdog;
      return APPLY;
    }
    return command;
  }

  bySlip(wheel) {
    const p = this.parameters, scale = Math.max(this.reference, p.least_slip / p.upper_slip);
    let slip = (this.reference - wheel.speed) / scale;
    slip += (p.lead_time * (-this.deceleration - wheel.acceleration)) / scale;
    return slip > p.upper_slip ? VENT : slip < p.lower_slip ? APPLY : HOLD;
  }

  isReleased(number) {
    const late = this.time - this.synchronisedAt > this.parameters.synchronising_period;
    if (this.released === null && late && !this.isQuiet()) {
      const speeds = this.wheels.map((wheel) => wheel.speed);
      this.released = speeds.indexOf(Math.max(...speeds));
    }
    return this.released === number;
  }
}
