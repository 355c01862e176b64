// Stops over time, unpacked, and their values at an instant.

class Stop {
  // about: of the page's data; next(): the next column of numbers, each the sum of all differences up to it.
  constructor(about, next, { wheelsets, units }) {
    Object.assign(this, about);
    const each = (unit) => Array.from({ length: wheelsets }, () => next(unit));
    this.time = next(units.time);
    this.way = next(units.distance);
    this.speed = next(units.speed);
    [this.wheel, this.shown, this.effort, this.valve] = [units.speed, units.speed, 1, 1].map(each);
    this.end = this.time.at(-1);
    this.colours = wheelColours(wheelsets);
    this.rolled = this.wheel.map((speed) => this.integral(speed));
  }

  // Distance that a wheel has rolled at each instant [m].
  integral(speed) {
    let sum = 0;
    return speed.map((one, place) => {
      if (place) sum += ((one + speed[place - 1]) / 2) * (this.time[place] - this.time[place - 1]);
      return sum;
    });
  }

  // All numbers at a time, linear between two samples; valves are constant until the second of them.
  at(time) {
    let low = 0, high = this.time.length - 1;
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (this.time[middle] <= time) low = middle; else high = middle;
    }
    const share = Math.min(Math.max((time - this.time[low]) / (this.time[high] - this.time[low] || 1), 0), 1);
    const between = (column) => column[low] + share * (column[high] - column[low]);
    const [speed, wheel] = [between(this.speed), this.wheel.map(between)];
    return {
      speed, wheel, way: between(this.way), ended: time >= this.end,
      effort: this.effort.map(between), rolled: this.rolled.map(between), valve: this.valve.map((one) => one[high]),
      locked: wheel.map((one) => one < 0.005 && speed > DATA.lockAbove),
    };
  }
}

// All stops of the page, in the order of its data.
async function stopsOf(data) {
  const differences = Array.from(new Int16Array(await unpacked(data.histories)));
  let place = 0;
  return data.stops.map((about) => {
    const next = (unit) => {
      let sum = 0;
      const column = differences.slice(place, place + about.samples).map((one) => (sum += one) * unit);
      place += about.samples;
      return column;
    };
    return new Stop(about, next, data);
  });
}
