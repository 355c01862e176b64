// Charts over time: axes and lines, and a chart of a history that is redrawn for each frame.

// A line through points [pixels]; colour: a name of `look` or a colour.
function stroke(context, points, colour, width, dashes = []) {
  Object.assign(context, { strokeStyle: look[colour] ?? colour, lineWidth: width, lineJoin: "round" });
  context.setLineDash(dashes);
  context.beginPath();
  for (const [x, y] of points) context.lineTo(x, y);
  context.stroke();
  context.setLineDash([]);
}

// Axes of a chart: a box of a canvas [pixels], the begin and the length of the time axis [s], the lowest and the
// highest value.
class Axes {
  constructor(context, box, [first, span], [low, high]) {
    Object.assign(this, { context, box, first, span, low, high });
  }

  x(time) { return this.box.left + ((time - this.first) / this.span) * (this.box.right - this.box.left); }
  y(value) { return this.box.bottom - ((value - this.low) / (this.high - this.low)) * (this.box.bottom - this.box.top); }

  // Both axes; base [pixels], unit and step [s] of the times.
  draw(base, unit, step) {
    this.values();
    this.times(base, unit, step);
  }

  // Rules across with their values.
  values() {
    const { context, box, low, high } = this;
    Object.assign(context, { fillStyle: look.soft, textAlign: "right" });
    for (let rise = roundStep(high - low, 4), value = Math.ceil(low / rise) * rise; value <= high; value += rise) {
      stroke(context, [[box.left, this.y(value)], [box.right, this.y(value)]], "grid", 1);
      context.fillText(`${+value.toFixed(6)}`, box.left - 5, this.y(value) + 4);
    }
  }

  // Times, or places, at `base` [pixels] with their unit, a step apart [s].
  times(base, unit, step) {
    const { context, box, first, span } = this;
    Object.assign(context, { fillStyle: look.soft, textAlign: "center" });
    for (let time = Math.ceil(first / step) * step; time <= first + span; time += step) {
      context.fillText(`${+time.toFixed(6)}${unit}`, Math.min(this.x(time), box.right - 12), base);
      context.fillRect(this.x(time), base - 15, 1, 4);
    }
    context.textAlign = "left";
  }

  // points: pairs of time [s] and value.
  line(points, ...style) {
    stroke(this.context, points.map(([time, value]) => [this.x(time), this.y(value)]), ...style);
  }
}

const SHORTEST = 30, WINDOW = 90; // of the time axis [s]

// The previous run lies below the present one as a pale line.
class Chart {
  // lines: label, colour, number of its dashes unless it is heavy, and a function from a point of the history to its
  // value; least: smallest range of shown values.
  constructor(canvas, title, lines, least) {
    Object.assign(this, { canvas, title, lines, least });
  }

  // before: the previous run, whose first line is shown: its history, its label, and the shift [s] that aligns the
  // brake applications of both.
  draw(history, before = null) {
    const { context, width, height } = sharp(this.canvas), box = { left: 44, right: width - 8, top: 24, bottom: height - 20 };
    const last = history.at(-1).time, first = Math.max(0, last - WINDOW);
    const end = before ? before.history.at(-1).time + before.shift : 0;
    const axes = new Axes(context, box, [first, Math.min(WINDOW, Math.max(SHORTEST, last, end))], this.range(history));
    axes.draw(box.bottom + 15, " s", 10);
    this.legend(context, box.right);
    if (before) this.pale(axes, before);
    const shown = history.filter(({ time }) => time >= first);
    for (const line of this.lines) axes.line(shown.map((point) => [point.time, line.value(point)]), line.colour, ...this.style(line));
  }

  // Width and dashes of a line.
  style({ heavy, dashes }) {
    return heavy ? [3] : [1.7, DASHES[dashes % DASHES.length]];
  }

  pale(axes, before) {
    const { context, box } = axes, [{ value }] = this.lines, time = (point) => point.time + before.shift;
    const inside = before.history.filter((point) => axes.x(time(point)) >= box.left && axes.x(time(point)) <= box.right);
    if (!inside.length) return;
    context.save();
    Object.assign(context, { fillStyle: look.soft, globalAlpha: 0.4 });
    axes.line(inside.map((point) => [time(point), value(point)]), "soft", 5);
    context.globalAlpha = 1;
    const middle = inside[Math.floor(0.6 * inside.length)], room = context.measureText(before.words).width;
    context.fillText(before.words, Math.max(axes.x(time(middle)) - 8 - room, box.left), axes.y(value(middle)) + 18);
    context.restore();
  }

  range(history) {
    let [low, high] = this.least;
    for (const point of history)
      for (const { value } of this.lines) {
        low = Math.min(low, value(point));
        high = Math.max(high, value(point));
      }
    return [low, high + 0.05 * (high - low)];
  }

  legend(context, right) {
    context.fillStyle = look.ink;
    context.fillText(this.title, 4, 13);
    for (const line of [...this.lines].reverse()) {
      const begin = right - context.measureText(line.label).width - 22;
      context.fillText(line.label, begin + 22, 13);
      stroke(context, [[begin, 9], [begin + 18, 9]], line.colour, ...this.style(line));
      right = begin - 8;
    }
  }
}
