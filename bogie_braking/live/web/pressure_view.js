// Pressures over time and along the train as colours: the head is above, the time to the right.

// Colours from no pressure to the full one (cividis, as in the figures of the scenarios), each as red, green, blue.
const SHADES = [[0, 34, 78], [53, 69, 108], [102, 105, 112], [148, 142, 119], [200, 184, 102], [254, 232, 56]];

function shade(share) {
  const place = Math.max(0, Math.min(1, share)) * (SHADES.length - 1), below = Math.min(Math.floor(place), SHADES.length - 2);
  return SHADES[below].map((value, i) => value + (place - below) * (SHADES[below + 1][i] - value));
}

class PressureView {
  // name: of the pressures of a point of the history; most: that of the last colour [Pa].
  constructor(canvas, title, name, most) {
    Object.assign(this, { canvas, title, name, most, image: document.createElement("canvas") });
  }

  draw(history) {
    const { context, width, height } = sharp(this.canvas), box = { left: 44, right: width - 52, top: 24, bottom: height - 20 };
    const last = history.at(-1).time, first = Math.max(0, last - WINDOW), span = Math.min(WINDOW, Math.max(SHORTEST, last));
    const shown = history.slice(history.findIndex(({ time }) => time >= first)), n = shown[0][this.name].length;
    const axes = new Axes(context, box, [first, span], [n, 0]), { image } = this;
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
    const data = new ImageData(shown.length, n);
    shown.forEach((point, column) => point[this.name].forEach((pressure, row) => {
      data.data.set([...shade(pressure / this.most), 255], 4 * (row * shown.length + column));
    }));
    return data;
  }

  // The colours with their pressures, right of the picture.
  scale(context, box) {
    const count = 40, tall = (box.bottom - box.top) / count;
    for (let i = 0; i < count; i += 1) {
      context.fillStyle = `rgb(${shade((i + 0.5) / count).join(" ")})`;
      context.fillRect(box.right + 10, box.bottom - (i + 1) * tall, 10, tall + 1);
    }
    Object.assign(context, { fillStyle: look.soft, textAlign: "left" });
    for (let bar = 0; bar <= this.most / 1e5; bar += 1) context.fillText(`${bar}`, box.right + 24, box.bottom - (bar * 1e5 / this.most) * (box.bottom - box.top) + 4);
  }
}
