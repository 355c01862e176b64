// Speeds over time of one stop, a line for each valve below, and a cursor that follows.

const STRIP = 7; // height of a valve's line [pixels]

class StopChart {
  // latest: end of the time axis [s]; fastest: of the speed axis [m/s]; seek: called with the time under the pointer.
  constructor(stop, latest, fastest, seek) {
    Object.assign(this, { stop, latest, fastest });
    this.element = document.createElement("figure");
    const name = document.createElement("figcaption");
    name.textContent = `${stop.controller}: speeds [m/s] over time [s]`;
    this.canvas = document.createElement("canvas");
    this.canvas.setAttribute("role", "img");
    this.canvas.setAttribute("aria-label", this.described());
    this.element.append(name, this.canvas);
    this.still = document.createElement("canvas");
    const point = (event) => {
      if (event.type === "pointermove" && !event.buttons) return;
      const { left, right } = this.box(this.canvas.clientWidth, this.canvas.clientHeight);
      seek(((event.offsetX - left) / (right - left)) * this.latest);
    };
    this.canvas.addEventListener("pointerdown", point);
    this.canvas.addEventListener("pointermove", point);
  }

  described() {
    const { time, speed, wheel, end } = this.stop;
    const lasts = (column) => column.reduce((sum, one, place) =>
      sum + (place && one < 0.005 && speed[place] > DATA.lockAbove ? time[place] - time[place - 1] : 0), 0);
    const locks = wheel.map((column, number) => `wheelset ${number + 1} locked for ${lasts(column).toFixed(1)} s`);
    return `From ${speed[0].toFixed(1)} m/s, ${end.toFixed(1)} s; ${locks.join(", ")}.`;
  }

  box(width, height) {
    return { left: 34, right: width - 10, top: 8, bottom: height - 22 - STRIP * this.stop.wheel.length };
  }

  // The static part is drawn once, until the size or the colours change.
  draw(time) {
    const { context, width, height } = sharp(this.canvas), box = this.box(width, height);
    if (!this.canvas.width || !this.canvas.height) return; // it is not shown
    if (this.still.width !== this.canvas.width || this.still.height !== this.canvas.height || this.ink !== look.ink) this.drawStill(box, width, height);
    context.drawImage(this.still, 0, 0, width, height);
    context.fillStyle = look.signal;
    context.fillRect(this.axes.x(Math.min(time, this.latest)) - 0.75, box.top, 1.5, height - 20 - box.top);
  }

  drawStill(box, width, height) {
    this.ink = look.ink;
    [this.still.width, this.still.height] = [this.canvas.width, this.canvas.height];
    const context = this.still.getContext("2d"), { stop, fastest, latest } = this, { colours } = stop;
    context.scale(this.still.width / width, this.still.height / height);
    context.font = "12px system-ui, sans-serif";
    this.axes = new Axes(context, box, [0, latest], [0, 1.04 * fastest]);
    this.axes.draw(height - 5, "", roundStep(latest, 6));
    const line = (column, ...style) => this.axes.line(column.map((value, place) => [stop.time[place], Math.min(value, 1.04 * fastest)]), ...style);
    stop.shown.forEach((column, number) => line(column, colours[number], 1, [1, 3]));
    stop.wheel.forEach((column, number) => line(column, colours[number], 1.6, DASHES[number % DASHES.length]));
    line(stop.speed, "ink", 2.2);
    stop.valve.forEach((column, number) => this.strip(context, column, box.bottom + 3 + STRIP * number));
  }

  strip(context, column, top) {
    const { time } = this.stop, kinds = ["grid", "edge", "ink"];
    for (let place = 1, from = 0; place < time.length; place += 1) {
      if (place + 1 < time.length && column[place + 1] === column[place]) continue;
      context.fillStyle = look[kinds[column[place]]];
      const begin = this.axes.x(time[from]);
      context.fillRect(begin, top, this.axes.x(time[place]) - begin, STRIP - 2);
      from = place;
    }
  }
}
