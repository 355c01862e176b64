// The speed of a train over the place of its front, with limits of speed, and the height of the line below.

const BEHIND = 1500, AHEAD = 2500, PITCH = 120; // shown of the line [m]; number of places whose height is drawn
const TALL = 34; // of the height of the line [pixels]

class PlaceView {
  constructor(canvas) {
    this.canvas = canvas;
  }

  draw({ consist, history, front }) {
    const { context, width, height } = sharp(this.canvas), box = { left: 44, right: width - 8, top: 24, bottom: height - 24 - TALL };
    const first = Math.max(front - BEHIND, Math.min(history[0].front, front)), span = Math.max(AHEAD, front + AHEAD - first);
    const speeds = history.map(({ speed }) => Math.abs(speed)), limits = consist.limits.map(([, , speed]) => 3.6 * speed);
    const axes = new Axes(context, box, [first, span], [0, 1.05 * Math.max(20, ...limits, speeds.reduce((a, b) => Math.max(a, b), 0))]);
    Object.assign(context, { fillStyle: look.ink, textAlign: "left" });
    context.fillText("speed over place [km/h], gradient below", 4, 13);
    axes.draw(height - 4, " m", roundStep(span, width / 80));
    this.ground(axes, consist, height - 20);
    this.limits(axes, consist.limits);
    axes.line(history.filter((point) => point.front >= first).map((point) => [point.front, Math.abs(point.speed)]), "ink", 3);
  }

  limits(axes, limits) {
    const { context, first, span, box } = axes;
    for (const [begin, end, speed] of limits) {
      const [from, to] = [Math.max(begin, first), Math.min(end, first + span)];
      if (from >= to) continue;
      axes.line([[from, 3.6 * speed], [to, 3.6 * speed]], "signal", 2, DASHES[1]);
      Object.assign(context, { fillStyle: look.signal, textAlign: "left" });
      context.fillText(`limit ${(3.6 * speed).toFixed(0)}`, Math.min(axes.x(from) + 4, box.right - 50), axes.y(3.6 * speed) - 4);
    }
  }

  // The height of the line as a band, and its gradients [per mille].
  ground({ context, box, first, span }, consist, base) {
    const pitch = span / PITCH, places = Array.from({ length: PITCH + 1 }, (_, i) => first + i * pitch);
    const steep = places.map((place) => consist.gradientAt(place)), heights = [0];
    for (let i = 1; i <= PITCH; i += 1) heights.push(heights[i - 1] + (steep[i - 1] + steep[i]) / 2 * pitch);
    const low = Math.min(...heights), range = Math.max(Math.max(...heights) - low, 20);
    const at = (place) => box.left + ((place - first) / span) * (box.right - box.left);
    context.fillStyle = look.rail;
    context.beginPath();
    context.moveTo(box.left, base);
    places.forEach((place, i) => context.lineTo(at(place), base - 4 - (TALL - 14) * (heights[i] - low) / range));
    context.lineTo(box.right, base);
    context.fill();
    if (consist.line.isLevel) return;
    Object.assign(context, { fillStyle: look.ink, textAlign: "center" });
    for (const share of [0.1, 0.3, 0.5, 0.7, 0.9]) {
      const place = first + share * span;
      context.fillText(`${(1e3 * consist.gradientAt(place)).toFixed(1)} ‰`, at(place), base - 6);
    }
  }
}
