// Pressures over time and along the train as colours: the head is above, the time to the right.

// Colours from no pressure to the full one (cividis, as in the figures of the scenarios), each as red, green, blue.
const SHADES = [[0, 34, 78], [53, 69, 108], [102, 105, 112], [148, 142, 119], [200, 184, 102], [254, 232, 56]];

function shade(share) {
  const place = Math.max(0, Math.min(1, share)) * (SHADES.length - 1), below = Math.min(Math.floor(place), SHADES.length - 2);
  return SHADES[below].map((value, i) => value + (place - below) * (SHADES[below + 1][i] - value));
}

// The same as 256 pixels.
const PIXELS = new Uint32Array(Uint8ClampedArray.from(Array.from({ length: 256 }, (_, i) => [...shade(i / 255), 255]).flat()).buffer);

class PressureView {
  // name: of the pressures of a point of the history.
  constructor(canvas, title, name) {
    Object.assign(this, { canvas, title, name, image: document.createElement("canvas") });
  }

  // Pressures [Pa] of the first colour, which falls from `least` to `lowest` in whole bars with the pressures, and of the last.
  draw(history, [lowest, least, most]) {
    const { context, width, height } = sharp(this.canvas), box = { left: 44, right: width - 52, top: 24, bottom: height - 20 };
    const last = history.at(-1).time, first = Math.max(0, last - WINDOW), span = Math.min(WINDOW, Math.max(SHORTEST, last));
    const shown = history.slice(history.findIndex(({ time }) => time >= first)), n = shown[0][this.name].length;
    const axes = new Axes(context, box, [first, span], [n, 0]), { image } = this;
    const fallen = shown.reduce((low, point) => Math.min(low, ...point[this.name]), least);
    Object.assign(this, { low: Math.max(lowest, 1e5 * Math.floor(fallen / 1e5)), most });
    Object.assign(image, { width: shown.length, height: n });
    image.getContext("2d").putImageData(this.pixels(shown, n), 0, 0);
    context.imageSmoothingEnabled = false;
    context.drawImage(image, box.left, box.top, axes.x(last) - box.left, box.bottom - box.top);
    axes.times(box.bottom + 15, " s", roundStep(span, width / 80));
    Object.assign(context, { fillStyle: look.ink, textAlign: "left" });
    context.fillText(this.title, 4, 13);
    Object.assign(context, { fillStyle: look.soft, textAlign: "right" });
    context.fillText("head", box.left - 5, box.top + 10);
    context.fillText(`${n}`, box.left - 5, box.bottom);
    this.scale(context, box);
  }

  pixels(shown, n) {
    const image = new ImageData(shown.length, n), pixels = new Uint32Array(image.data.buffer), scale = 255 / (this.most - this.low);
    shown.forEach((point, column) => {
      const pressures = point[this.name];
      for (let row = 0; row < n; row += 1) pixels[row * shown.length + column] = PIXELS[Math.max(0, Math.min(255, Math.round(scale * (pressures[row] - this.low))))];
    });
    return image;
  }

  // The colours with their pressures, right of the plot.
  scale(context, box) {
    const count = 40, tall = (box.bottom - box.top) / count;
    for (let i = 0; i < count; i += 1) {
      context.fillStyle = `rgb(${shade((i + 0.5) / count).join(" ")})`;
      context.fillRect(box.right + 10, box.bottom - (i + 1) * tall, 10, tall + 1);
    }
    Object.assign(context, { fillStyle: look.soft, textAlign: "left" });
    const height = (bar) => box.bottom - ((1e5 * bar - this.low) / (this.most - this.low)) * (box.bottom - box.top);
    for (let bar = this.low / 1e5; bar <= this.most / 1e5; bar += 1) context.fillText(`${bar}`, box.right + 24, height(bar) + 4);
  }
}
