// Rolling charts: the last seconds of a history, drawn anew for each frame.

const DASHES = [[], [6, 3], [2, 2], [8, 3, 2, 3]]; // told apart without colours, too
const INK = "#333333", GRID = "#dddddd";

class Chart {
  // lines: label, colour, and a function from a point of the history to its value; least: range of values at least shown.
  constructor(canvas, title, lines, least) {
    Object.assign(this, { canvas, title, lines, least });
  }

  draw(history) {
    const { context, width, height } = sharp(this.canvas);
    const box = { left: 44, right: width - 8, top: 22, bottom: height - 20 };
    const last = history.at(-1).time, first = Math.max(0, last - WINDOW);
    const [low, high] = this.range(history);
    const x = (time) => box.left + ((time - first) / WINDOW) * (box.right - box.left);
    const y = (value) => box.bottom - ((value - low) / (high - low)) * (box.bottom - box.top);
    this.axes(context, box, first, low, high, x, y);
    this.lines.forEach(({ colour, value, heavy }, number) => {
      context.strokeStyle = colour;
      context.lineWidth = heavy ? 2.5 : 1.5;
      context.setLineDash(heavy ? [] : DASHES[number % DASHES.length]);
      context.beginPath();
      for (const point of history) context.lineTo(x(point.time), y(value(point)));
      context.stroke();
    });
    context.setLineDash([]);
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

  axes(context, box, first, low, high, x, y) {
    context.lineWidth = 1;
    context.strokeStyle = GRID;
    context.fillStyle = INK;
    context.textAlign = "right";
    for (let step = roundStep(high - low, 4), value = Math.ceil(low / step) * step; value <= high; value += step) {
      context.beginPath();
      context.moveTo(box.left, y(value));
      context.lineTo(box.right, y(value));
      context.stroke();
      context.fillText(`${+value.toFixed(6)}`, box.left - 5, y(value) + 4);
    }
    context.textAlign = "center";
    for (let time = Math.ceil(first / 10) * 10; time <= first + WINDOW; time += 10)
      context.fillText(`${time} s`, Math.min(x(time), box.right - 12), box.bottom + 15);
    context.textAlign = "left";
    context.fillText(this.title, 4, 13);
    this.legend(context, box);
  }

  legend(context, box) {
    let right = box.right;
    context.textAlign = "right";
    for (let number = this.lines.length - 1; number >= 0; number -= 1) {
      const { label, colour, heavy } = this.lines[number], begin = right - context.measureText(label).width - 22;
      context.fillText(label, right, 13);
      context.strokeStyle = colour;
      context.lineWidth = heavy ? 2.5 : 1.5;
      context.setLineDash(heavy ? [] : DASHES[number % DASHES.length]);
      context.beginPath();
      context.moveTo(begin, 9);
      context.lineTo(begin + 18, 9);
      context.stroke();
      right = begin - 8;
    }
    context.setLineDash([]);
  }
}
