// The leading wheelset on its rails, viewed from the rear: profiles, contacts, wheel loads Q and lateral forces Y.

const TOUCHES = 0.03; // gap up to which profiles are drawn as touching [mm]
const HALVES = 330; // width of both wheels and of their displacements [mm]
const FORCE = { Q: 0.15, Y: 0.6 }; // length of an arrow [mm for each kN]

class SectionView {
  constructor(canvas) {
    this.canvas = canvas;
  }

  draw({ machine, kernel }) {
    const { context, width, height } = sharp(this.canvas);
    for (const [side, name] of [[1, "left"], [-1, "right"]]) {
      const values = Object.fromEntries(
        ["wheel_load", "lateral_force", "wheel_rise"].map((one) => [one, kernel.get(`${one}_1_${name}`)]));
      const scale = Math.min(width / HALVES, height / 100), middle = width / 2 - side * 0.25 * width;
      const view = { context, scale, x: (y) => middle - side * scale * y, z: (z) => height * 0.52 - scale * z, side };
      this.side(view, machine, 1e3 * kernel.get("lateral_1"), values);
      context.fillStyle = look.ink;
      context.textAlign = "center";
      const { wheel_load: load, lateral_force: lateral } = values;
      context.fillText(`${name}: Q ${(load / 1e3).toFixed(0)} kN, Y ${(lateral / 1e3).toFixed(1)} kN`, middle, height - 8);
    }
    context.textAlign = "left";
    const shift = 1e3 * kernel.get("lateral_1"), words = `${Math.abs(shift).toFixed(2)} mm to the ${shift < 0 ? "right" : "left"}`;
    const scale = width < 500 ? "" : `; Y drawn ${FORCE.Y / FORCE.Q} times as long as Q`;
    context.fillText(`wheelset 1 from behind, ${words}${scale}`, 4, 13);
  }

  // Profiles are measured outwards; a displacement to the left moves the left wheel outwards.
  side(view, machine, lateral, { wheel_load: load, lateral_force: force, wheel_rise: rise }) {
    const shift = 1e3 * machine.aside + view.side * lateral;
    const over = machine.wheel.map(([y, z]) => [y + shift, z]);
    const gaps = over.map(([y, z]) => z - heightAt(machine.rail, y)), least = Math.min(...gaps);
    const wheel = over.map(([y, z]) => [y, z + (load > 0 ? -least : 1e3 * rise)]);
    this.filled(view, machine.rail, look.rail, -30);
    this.filled(view, wheel, look.car, 34);
    if (load <= 0) return;
    wheel.forEach(([y, z], number) => {
      if (gaps[number] - least < TOUCHES) this.dot(view, y, z);
    });
    const place = wheel[gaps.indexOf(least)];
    this.arrow(view, place, [0, (FORCE.Q * load) / 1e3], look.first, "Q");
    this.arrow(view, place, [(FORCE.Y * force) / 1e3, 0], look.fourth, "Y");
  }

  filled({ context, x, z }, points, colour, to) {
    context.beginPath();
    for (const [y, height] of points) context.lineTo(x(y), z(height));
    context.lineTo(x(points.at(-1)[0]), z(to));
    context.lineTo(x(points[0][0]), z(to));
    context.closePath();
    context.fillStyle = colour;
    context.fill();
    context.strokeStyle = look.ink;
    context.lineWidth = 1.2;
    context.stroke();
  }

  dot({ context, x, z }, y, height) {
    context.fillStyle = look.fourth;
    context.beginPath();
    context.arc(x(y), z(height), 3, 0, 2 * Math.PI);
    context.fill();
  }

  arrow({ context, x, z }, [y, height], [along, up], colour, name) {
    const from = [x(y), z(height)], to = [x(y + along), z(height + up)];
    const length = Math.hypot(to[0] - from[0], to[1] - from[1]);
    if (length < 2) return;
    const unit = [(to[0] - from[0]) / length, (to[1] - from[1]) / length], tip = Math.min(7, length);
    context.strokeStyle = context.fillStyle = colour;
    context.lineWidth = 2;
    context.beginPath();
    context.moveTo(...from);
    context.lineTo(...to);
    context.stroke();
    context.beginPath();
    context.moveTo(...to);
    for (const sign of [1, -1])
      context.lineTo(to[0] - tip * (unit[0] - sign * 0.5 * unit[1]), to[1] - tip * (unit[1] + sign * 0.5 * unit[0]));
    context.fill();
    context.fillText(name, to[0] + 8, to[1] + 4);
  }
}

// Height of a profile by linear interpolation, points in the order of y; outside them nothing.
function heightAt(points, y) {
  if (y < points[0][0] || y > points.at(-1)[0]) return -Infinity;
  const share = ((y - points[0][0]) / (points.at(-1)[0] - points[0][0])) * (points.length - 1);
  const number = Math.min(Math.floor(share), points.length - 2);
  return points[number][1] + (share - number) * (points[number + 1][1] - points[number][1]);
}
