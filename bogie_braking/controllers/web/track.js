// One rail, on which the vehicle of a controller brakes; all rails of a case have one scale.

const RADIUS = 11, WHEEL = 2 * RADIUS + 8, RAIL = 68, MARGIN = 14; // [pixels]
const SLOWER = 10; // factor by which drawn wheels turn more slowly
const VALVES = ["applies", "holds", "vents"];

class Track {
  constructor(stop, far, first) {
    Object.assign(this, { stop, far, first });
    this.element = document.createElement("section");
    this.element.className = "track";
    const line = document.createElement("div"), name = document.createElement("h3");
    line.className = "line";
    name.textContent = stop.controller;
    this.state = document.createElement("p");
    line.append(name, this.state);
    this.canvas = document.createElement("canvas");
    this.canvas.setAttribute("role", "img");
    this.element.setAttribute("aria-label", stop.controller);
    this.element.append(line, this.canvas);
  }

  draw(time) {
    const now = this.stop.at(time), { context, width } = sharp(this.canvas);
    const begin = MARGIN + WHEEL * now.wheel.length;
    const x = (way) => begin + (way / this.far) * (width - begin - MARGIN);
    this.rail(context, x, width, now);
    context.fillStyle = look.soft;
    context.fillRect(x(now.way) - WHEEL * (now.wheel.length - 0.5), RAIL - RADIUS - 1, WHEEL * (now.wheel.length - 1), 2);
    now.wheel.forEach((_, number) => this.wheel(context, x(now.way) - WHEEL * (number + 0.5), number, now));
    this.state.textContent = this.words(now);
    this.canvas.setAttribute("aria-label", this.described(now));
  }

  words({ speed, way, locked, ended }) {
    const { distance, end, message } = this.stop;
    if (ended) return distance === null ? message : `${DATA.end} after ${distance.toFixed(1)} m, ${end.toFixed(1)} s`;
    const those = locked.flatMap((one, number) => (one ? [number + 1] : []));
    const locks = those.length ? `, wheelset${those.length > 1 ? "s" : ""} ${those.join(", ")} locked` : "";
    return `${speed.toFixed(1)} m/s, ${way.toFixed(0)} m${locks}`;
  }

  described(now) {
    const valves = now.valve.map((one, number) => `valve ${number + 1} ${VALVES[one]} at ${now.effort[number].toFixed(0)} ${DATA.effortUnit}`);
    return `${this.words(now)}; ${valves.join(", ")}`;
  }

  rail(context, x, width, now) {
    context.fillStyle = look.edge;
    context.fillRect(0, RAIL, width, 3);
    context.fillStyle = look.ink;
    context.fillRect(x(0), RAIL, x(now.way) - x(0), 3);
    context.textAlign = "center";
    context.fillStyle = look.soft;
    for (let step = roundStep(this.far, width < 600 ? 3 : 8), way = 0; way <= this.far; way += step) {
      context.fillRect(x(way), RAIL + 3, 1, 4);
      context.fillText(`${way} m`, Math.min(x(way), width - 22), RAIL + 18);
    }
    if (this.stop.ideal === null) return;
    const ideal = x(this.stop.ideal);
    stroke(context, [[ideal, this.first ? 14 : 4], [ideal, RAIL]], "ink", 1, [4, 3]);
    if (this.first) context.fillText("ideal", Math.min(ideal, width - 18), 11);
  }

  wheel(context, x, number, now) {
    const y = RAIL - RADIUS, angle = now.rolled[number] / DATA.radius / SLOWER;
    context.lineWidth = 2.5;
    context.strokeStyle = context.fillStyle = now.locked[number] ? look.signal : look[this.stop.colours[number]];
    context.beginPath();
    context.arc(x, y, RADIUS - 1, 0, 2 * Math.PI);
    context.stroke();
    if (now.locked[number]) context.fill();
    const rim = [x + (RADIUS - 1) * Math.cos(angle), y + (RADIUS - 1) * Math.sin(angle)];
    if (!now.locked[number]) stroke(context, [[x, y], rim], context.strokeStyle, 2.5);
    this.brake(context, x, number, now);
  }

  // A cylinder filled by its pressure, or a motor by its torque, and above it the action of its valve.
  brake(context, x, number, { effort, valve }) {
    const [width, top, bottom] = [14, 24, 42], share = Math.min(effort[number] / DATA.fullEffort, 1);
    context.lineWidth = 1;
    context.fillStyle = look.soft;
    context.strokeStyle = look.soft;
    context.fillRect(x - width / 2, bottom - share * (bottom - top), width, share * (bottom - top));
    context.strokeRect(x - width / 2, top, width, bottom - top);
    context.fillStyle = look.ink;
    context.beginPath();
    const [up, half] = [20, 5];
    if (valve[number] === 1) context.rect(x - half, up - 2 * half, 2 * half, 2 * half);
    else for (const [aside, above] of [[-half, 0], [half, 0], [0, 2 * half]])
      context.lineTo(x + aside, valve[number] === 2 ? up - above : up - 2 * half + above);
    context.fill();
  }
}
