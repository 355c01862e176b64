// Speeds over time of one stop, a line for each valve below, and a cursor that follows.

const STRIP = 7; // height of a valve's line [pixels]

class StopChart {
  // latest: end of the time axis [s]; fastest: of the speed axis [m/s]; seek: called with a time that is pointed at.
  constructor(stop, latest, fastest, seek) {
    Object.assign(this, { stop, latest, fastest });
    this.element = document.createElement("figure");
    this.element.style.margin = "0";
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

  // What does not move is drawn once, until the size or the colours change.
  draw(time) {
    const { context, width, height } = sharp(this.canvas), { left, right, top } = this.box(width, height);
    if (this.still.width !== this.canvas.width || this.still.height !== this.canvas.height || this.ink !== colour("ink")) this.drawStill(width, height);
    context.drawImage(this.still, 0, 0, width, height);
    const x = left + (Math.min(time, this.latest) / this.latest) * (right - left);
    context.fillStyle = colour("locked");
    context.fillRect(x - 0.75, top, 1.5, height - 20 - top);
  }

  drawStill(width, height) {
    this.ink = colour("ink");
    [this.still.width, this.still.height] = [this.canvas.width, this.canvas.height];
    const context = this.still.getContext("2d"), box = this.box(width, height);
    context.scale(this.still.width / width, this.still.height / height);
    context.font = "12px system-ui, sans-serif";
    const x = (time) => box.left + (time / this.latest) * (box.right - box.left);
    const y = (speed) => box.bottom - (Math.min(speed, 1.04 * this.fastest) / (1.04 * this.fastest)) * (box.bottom - box.top);
    this.axes(context, box, x, y, height);
    this.stop.shown.forEach((column, number) => this.line(context, x, y, column, wheelColour(number), [1, 3], 1));
    this.stop.wheel.forEach((column, number) => this.line(context, x, y, column, wheelColour(number), DASHES[number % 4], 1.6));
    this.line(context, x, y, this.stop.speed, this.ink, [], 2.2);
    this.stop.valve.forEach((column, number) => this.strip(context, x, column, box.bottom + 3 + STRIP * number));
  }

  axes(context, { left, right }, x, y, height) {
    context.lineWidth = 1;
    context.strokeStyle = colour("grid");
    context.fillStyle = colour("soft");
    context.textAlign = "right";
    for (let step = roundStep(this.fastest, 4), speed = 0; speed <= this.fastest; speed += step) {
      context.beginPath();
      context.moveTo(left, y(speed));
      context.lineTo(right, y(speed));
      context.stroke();
      context.fillText(`${speed}`, left - 5, y(speed) + 4);
    }
    context.textAlign = "center";
    for (let step = roundStep(this.latest, 6), time = 0; time <= this.latest; time += step) {
      context.fillText(`${+time.toFixed(6)}`, Math.min(x(time), right - 6), height - 5);
      context.fillRect(x(time), height - 20, 1, 4);
    }
  }

  line(context, x, y, column, stroke, dashes, thick) {
    context.strokeStyle = stroke;
    context.lineWidth = thick;
    context.setLineDash(dashes);
    context.beginPath();
    column.forEach((value, place) => context.lineTo(x(this.stop.time[place]), y(value)));
    context.stroke();
    context.setLineDash([]);
  }

  strip(context, x, column, top) {
    const { time } = this.stop, kinds = ["grid", "edge", "ink"];
    for (let place = 1, from = 0; place < time.length; place += 1) {
      if (place + 1 < time.length && column[place + 1] === column[place]) continue;
      context.fillStyle = colour(kinds[column[place]]);
      context.fillRect(x(time[from]), top, x(time[place]) - x(time[from]), STRIP - 2);
      from = place;
    }
  }
}
