// The sensors of the wheels and the wheel-slide protection: brake_controller/sensors.py (without errors of the teeth) and
// wheel_slide.py in the page's language, line by line; a test holds them to the same commands. A page cannot run Python,
// and a controller has no equations that C could be made from.

class Encoder {
  // sensor: of page.py.
  constructor({ pulses, gate, resolution, lowest_frequency }) {
    Object.assign(this, { pulses, gate, resolution, lowestFrequency: lowest_frequency });
    Object.assign(this, { time: null, place: 0, edge: 0, edgeTime: -Infinity, mean: 0, passages: [] });
    this.pitch = (2 * Math.PI) / pulses;
  }

  angularVelocity(time, rotation) {
    if (this.time === null) {
      this.place = Math.abs(rotation) / this.pitch;
      this.edge = Math.floor(this.place);
    } else if (time > this.time) this.turn(time, this.place + Math.abs(rotation - this.rotation) / this.pitch);
    Object.assign(this, { time, rotation });
    const age = time - this.edgeTime - this.resolution;
    const reading = Math.min(this.mean, 1 / Math.max(age, this.resolution));
    return reading >= this.lowestFrequency ? reading * this.pitch : 0;
  }

  turn(time, place) {
    const edge = Math.floor(place);
    if (edge > this.edge) {
      const passage = { start: this.time, begin: this.place, end: time, place, first: this.edge + 1 };
      passage.firstTime = this.timeOf(passage.first, passage);
      this.passages.push(passage);
      Object.assign(this, { edge, edgeTime: this.timeOf(edge, passage) });
      this.mean = this.meanOfEdges();
    }
    this.place = place;
  }

  meanOfEdges() {
    const since = this.edgeTime - this.gate, passages = this.passages;
    while (passages.length > 1 && passages[1].firstTime <= since) passages.shift();
    const oldest = passages[0];
    if (oldest.firstTime > since) return 0;
    const share = Math.min(1, (since - oldest.start) / (oldest.end - oldest.start));
    const before = Math.max(oldest.first, Math.floor(oldest.begin + share * (oldest.place - oldest.begin)));
    return (this.edge - before) / (this.edgeTime - this.timeOf(before, oldest));
  }

  timeOf(edge, passage) {
    const share = (edge - passage.begin) / (passage.place - passage.begin);
    const time = passage.start + share * (passage.end - passage.start);
    return Math.floor(time / this.resolution) * this.resolution;
  }
}

const APPLY = 0, HOLD = 1, VENT = 2;
const ROLLING = 0.3, SPEEDING = 0.6, GAIN = 0.02, TOGETHER = 0.02, SHORTEST_RELEASE = 0.25, LONGEST_RELEASE = 0.8;
const FREELY_BRAKED = 0.3, SHORTEST_BETWEEN = 0.5, LEAST_DECELERATION = 0.1;
const SETTLING = 0.5, KEEPING = 1, SECOND_LOOK = 1.5;
const RECENT = 5, JUMP = 4, JUMPING = 150, STAYING = 0.3, STAYS = 0.5, BLIND = 1, BLIND_ABOVE = 3;
const AGREES = 0.05, AGREEING = 2;

class SlideProtection {
  constructor(parameters) {
    Object.assign(this, { parameters, time: null, wheels: [], reference: 0, deceleration: 0, evident: false });
    Object.assign(this, { gained: false, looks: 0, synchronisedAt: 0, synchronisedSpeed: 0, keptAt: 0, keptSpeed: 0 });
    Object.assign(this, { released: null, actedAt: -Infinity, evidentAt: -Infinity });
  }

  step(time, speeds) {
    if (this.time === null) {
      this.wheels = speeds.map(() => ({
        reading: 0, speed: 0, acceleration: 0, calmSpeed: 0, calmAcceleration: 0, lowest: 0,
        turnsSince: null, ventsSince: null, speedsUp: false, blockedUntil: -Infinity,
        believed: true, recent: [], changedAt: -Infinity, others: 0, agreesSince: null,
      }));
    }
    const size = this.time === null ? 0 : time - this.time;
    this.time = time;
    this.wheels.forEach((wheel, number) => {
      this.believe(wheel, speeds[number], size);
      this.filter(wheel, speeds[number], size);
    });
    const fastest = this.wheels[this.chosen(Math.max)];
    if (this.evident) this.slide(size, fastest);
    else this.roll(size, fastest);
    const commands = this.wheels.map((wheel, number) => (wheel.believed ? this.command(number) : null));
    const most = Math.max(APPLY, ...commands);
    return commands.map((command) => command ?? most);
  }

  // The wheels whose sensors are believed; all, where none is.
  get seen() {
    const seen = this.wheels.filter((wheel) => wheel.believed);
    return seen.length ? seen : this.wheels;
  }

  // The number of the wheelset that `choose`, Math.max or Math.min, takes by its speed.
  chosen(choose) {
    const seen = this.seen, speeds = seen.map((wheel) => wheel.calmSpeed);
    return this.wheels.indexOf(seen[speeds.indexOf(choose(...speeds))]);
  }

  believe(wheel, speed, size) {
    const believed = this.wheels.filter((one) => one.believed && one !== wheel);
    if (size === 0 || !believed.length) return;
    const others = Math.max(...believed.map((one) => one.calmSpeed));
    if (wheel.turnsSince === null) {
      const running = this.wheels.filter((one) => one.turnsSince !== null).map((one) => one.turnsSince);
      wheel.believed = !(running.length && this.time - Math.min(...running) > BLIND && others > BLIND_ABOVE);
      return;
    }
    if (!wheel.believed) {
      this.agree(wheel, speed, others);
      return;
    }
    if (speed !== wheel.reading || speed === 0 || !wheel.recent.length) {
      Object.assign(wheel, { changedAt: this.time, others });
    }
    const before = wheel.recent;
    wheel.recent = [...before, speed].slice(-RECENT);
    const change = Math.abs(Math.max(...wheel.recent) - Math.max(...before));
    const jumps = before.length === RECENT && change > JUMP + JUMPING * size;
    const stays = this.time - wheel.changedAt > STAYING && Math.abs(others - wheel.others) > STAYS;
    if (!jumps && !stays) return;
    Object.assign(wheel, { believed: false, agreesSince: null });
    this.released = null;
    this.evident = this.evident && this.time - this.evidentAt > (RECENT + 0.5) * size;
  }

  agree(wheel, speed, others) {
    if (speed === wheel.reading || Math.abs(wheel.calmSpeed - others) > AGREES * others) wheel.agreesSince = null;
    else if (wheel.agreesSince === null) wheel.agreesSince = this.time;
    else if (this.time - wheel.agreesSince > AGREEING) Object.assign(wheel, { believed: true, recent: [] });
  }

  filter(wheel, speed, size) {
    const p = this.parameters;
    if (wheel.turnsSince === null) {
      wheel.turnsSince = speed > 0 ? this.time : null;
      wheel.speed = wheel.calmSpeed = wheel.lowest = speed;
    } else if (size > 0) {
      let change = ((speed - wheel.speed) * size) / (size + p.filter_time);
      wheel.speed += change;
      wheel.acceleration += ((change / size - wheel.acceleration) * size) / (size + p.slope_time);
      const share = size / (size + p.calm_time);
      change = (Math.max(speed, wheel.reading) - wheel.calmSpeed) * share;
      wheel.calmSpeed += change;
      wheel.calmAcceleration += (change / size - wheel.calmAcceleration) * share;
    }
    wheel.reading = speed;
  }

  roll(size, fastest) {
    const p = this.parameters, before = this.reference;
    this.reference = Math.max(fastest.calmSpeed, before - p.largest_deceleration * size);
    this.keep(this.reference);
    const apart = Math.max(p.evident_slip * this.reference, p.least_evident_slip);
    const together = Math.max(TOGETHER * this.reference, p.least_evident_slip);
    const judged = this.seen.filter((wheel) => this.isJudged(wheel));
    const behind = judged.map((wheel) => this.reference - wheel.calmSpeed);
    if (behind.length && (Math.max(...behind) > apart || Math.min(...behind) > together)) {
      this.evident = this.gained = true;
      this.evidentAt = this.time;
      this.looks = 0;
      this.measure(this.reference);
    }
  }

  keep(speed) {
    const known = this.keptSpeed > 0;
    if (known && this.time - this.keptAt < KEEPING) return;
    this.synchronisedAt = known ? this.keptAt : this.time;
    this.synchronisedSpeed = known ? this.keptSpeed : speed;
    Object.assign(this, { keptAt: this.time, keptSpeed: speed });
  }

  slide(size, fastest) {
    const falls = this.knownDeceleration(fastest);
    this.reference = Math.max(fastest.calmSpeed, this.reference - falls * size);
    this.seen.forEach((wheel) => this.lookForGain(wheel));
    const caughtUp = this.seen.filter((wheel) => this.hasCaughtUp(wheel)).map((wheel) => wheel.calmSpeed);
    if (caughtUp.length) this.synchronise(Math.max(...caughtUp));
    if (this.reference < this.parameters.slowest) Object.assign(this, { evident: false, released: null });
  }

  isJudged(wheel) {
    return wheel.turnsSince !== null && this.time - wheel.turnsSince > SETTLING;
  }

  knownDeceleration(fastest) {
    if (this.time - this.actedAt < FREELY_BRAKED) return this.deceleration;
    return Math.max(this.deceleration, this.believed(-fastest.calmAcceleration));
  }

  believed(deceleration) {
    return Math.min(Math.max(deceleration, LEAST_DECELERATION), this.parameters.largest_deceleration);
  }

  lookForGain(wheel) {
    const p = this.parameters;
    wheel.lowest = Math.min(wheel.lowest, wheel.calmSpeed);
    const gain = GAIN * Math.max(wheel.calmSpeed, p.least_slip / p.upper_slip);
    if (wheel.calmAcceleration > SPEEDING && wheel.calmSpeed - wheel.lowest > gain) this.gained = wheel.speedsUp = true;
  }

  hasCaughtUp(wheel) {
    if (wheel.ventsSince === null) return false;
    const longest = wheel.speedsUp ? SHORTEST_RELEASE : LONGEST_RELEASE;
    return wheel.calmAcceleration < ROLLING && this.time - wheel.ventsSince > longest;
  }

  synchronise(speed) {
    if (this.looks === 0 || this.time - this.synchronisedAt > SHORTEST_BETWEEN) {
      this.measure(speed);
      this.synchronisedAt = this.keptAt = this.time;
      this.synchronisedSpeed = this.keptSpeed = speed;
      this.looks += 1;
      const { least_slip: least, upper_slip: upper } = this.parameters;
      if (this.looks > 2 && speed > least / upper) Object.assign(this, { evident: this.gained, gained: false });
      for (const wheel of this.wheels) wheel.lowest = wheel.calmSpeed;
    }
    Object.assign(this, { reference: speed, released: null });
  }

  measure(speed) {
    const elapsed = Math.max(this.time - this.synchronisedAt, SHORTEST_BETWEEN);
    this.deceleration = this.believed((this.synchronisedSpeed - speed) / elapsed);
  }

  command(number) {
    const { slowest, watchdog } = this.parameters, wheel = this.wheels[number];
    const judged = this.evident && this.isJudged(wheel);
    if (!judged || this.reference < slowest || this.time < wheel.blockedUntil) {
      wheel.ventsSince = null;
      return APPLY;
    }
    const command = this.isReleased(number) ? VENT : this.bySlip(wheel);
    if (command !== APPLY) this.actedAt = this.time;
    if (command !== VENT) wheel.ventsSince = null;
    else if (wheel.ventsSince === null) {
      Object.assign(wheel, { ventsSince: this.time, speedsUp: false, lowest: wheel.calmSpeed });
    } else if (this.time - wheel.ventsSince > watchdog) {
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
    const due = this.looks === 0 ? 0 : this.looks === 1 ? SECOND_LOOK : this.parameters.synchronising_period;
    const late = this.time - this.synchronisedAt > due;
    if (this.released === null && late) this.released = this.chosen(this.looks ? Math.max : Math.min);
    return this.released === number;
  }
}
