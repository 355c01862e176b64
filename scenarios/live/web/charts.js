// Charts of a history over time, drawn anew for each frame; the run before lies below as a pale line.

const SHORTEST = 30, WINDOW = 90; // of the time axis [s]

class Chart {
  // lines: label, colour (of `look` where it is a name of it), number of its dashes where it is not heavy, and a function
  // from a point of the history to its value; least: range of values at least shown.
  constructor(canvas, title, lines, least) {
    Object.assign(this, { canvas, title, lines, least });
  }

  // before: the run before, of which the first line is shown: its history, words on it, and the shift [s] that makes both
  // brake at one time.
  draw(history, before = null) {
    const { context, width, height } = sharp(this.canvas);
    const box = { left: 44, right: width - 8, top: 24, bottom: height - 20 };
    const last = history.at(-1).time, first = Math.max(0, last - WINDOW);
    const end = before ? before.history.at(-1).time + before.shift : 0;
    const span = Math.min(WINDOW, Math.max(SHORTEST, last, end));
    const [low, high] = this.range(history);
    const x = (time) => box.left + ((time - first) / span) * (box.right - box.left);
    const y = (value) => box.bottom - ((value - low) / (high - low)) * (box.bottom - box.top);
    this.axes(context, box, first, span, low, high, x, y);
    if (before) this.pale(context, box, before, (time) => x(time + before.shift), y);
    this.lines.forEach(({ value }, number) => {
      this.style(context, number);
      context.beginPath();
      for (const point of history) if (point.time >= first) context.lineTo(x(point.time), y(value(point)));
      context.stroke();
    });
    context.setLineDash([]);
  }

  style(context, number) {
    const { colour, heavy, dashes } = this.lines[number];
    context.strokeStyle = look[colour] ?? colour;
    context.lineWidth = heavy ? 3 : 1.7;
    context.setLineDash(heavy ? [] : DASHES[dashes % DASHES.length]);
  }

  pale(context, box, before, x, y) {
    const { value } = this.lines[0], inside = before.history.filter((point) => x(point.time) >= box.left && x(point.time) <= box.right);
    if (!inside.length) return;
    context.save();
    Object.assign(context, { strokeStyle: look.soft, fillStyle: look.soft, lineWidth: 5, globalAlpha: 0.4 });
    context.beginPath();
    for (const point of inside) context.lineTo(x(point.time), y(value(point)));
    context.stroke();
    context.globalAlpha = 1;
    const middle = inside[Math.floor(0.6 * inside.length)], room = context.measureText(before.words).width;
    context.fillText(before.words, Math.max(x(middle.time) - 8 - room, box.left), y(value(middle)) + 18);
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

  axes(context, box, first, span, low, high, x, y) {
    Object.assign(context, { lineWidth: 1, strokeStyle: look.grid, fillStyle: look.soft, textAlign: "right" });
    for (let step = roundStep(high - low, 4), value = Math.ceil(low / step) * step; value <= high; value += step) {
      context.beginPath();
      context.moveTo(box.left, y(value));
      context.lineTo(box.right, y(value));
      context.stroke();
      context.fillText(`${+value.toFixed(6)}`, box.left - 5, y(value) + 4);
    }
    context.textAlign = "center";
    for (let time = Math.ceil(first / 10) * 10; time <= first + span; time += 10)
      context.fillText(`${time} s`, Math.min(x(time), box.right - 12), box.bottom + 15);
    context.textAlign = "left";
    context.fillStyle = look.ink;
    context.fillText(this.title, 4, 13);
    this.legend(context, box);
  }

  legend(context, box) {
    let right = box.right;
    context.textAlign = "right";
    for (let number = this.lines.length - 1; number >= 0; number -= 1) {
      const { label } = this.lines[number], begin = right - context.measureText(label).width - 22;
      context.fillText(label, right, 13);
      this.style(context, number);
      context.beginPath();
      context.moveTo(begin, 9);
      context.lineTo(begin + 18, 9);
      context.stroke();
      right = begin - 8;
    }
    context.setLineDash([]);
    context.textAlign = "left";
  }
}
