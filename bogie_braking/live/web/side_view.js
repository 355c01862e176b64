// The vehicle from its left side, running to the right: bodies, turning wheels, axle loads, valves, rails with leaves.

const EXAGGERATED = 4; // bounce and pitch of the bodies
const SLEEPERS = 0.6, POSTS = 50; // along the track [m]
const FRAME = { size: 0.5, beyond: 0.6 }, CAR = { size: 2.6, beyond: 2.5 }; // height and what juts out, drawn [m]
const PANE = { pitch: 2, width: 1.3 }; // of windows, drawn [m]
const CAPTION = 20; // height of the caption above the vehicle [pixels]
const PLAN = { width: 110, length: 200 }; // of the track from above [pixels], [m]
const SMALLEST = 12; // a wheel that contains its number [pixels]
const VALVES = ["", "hold", "vent"]; // by command; "apply" needs no word

// Bodies that carry wheelsets are drawn as frames, bodies on frames as cars.
function shapeOf(body) {
  return body.carries.length ? FRAME : CAR;
}

// Returns whether a wheelset is locked while the vehicle moves.
function slides(kernel, number) {
  return kernel.get(`locked_${number}`) > 0.5;
}

// Returns the curvature at a place on the line, linear between its rows [1/m].
function curvatureAt(rows, place) {
  const after = rows.findIndex(([at]) => at > place);
  if (after <= 0) return after < 0 ? rows.at(-1)[1] : rows[0][1];
  const [from, first] = rows[after - 1], [to, last] = rows[after];
  return first + ((last - first) * (place - from)) / (to - from);
}

class SideView {
  constructor(canvas) {
    this.canvas = canvas;
  }

  // line: gradient [1] and the words on the line.
  draw(simulation, line) {
    const { context, width, height } = sharp(this.canvas), { machine, kernel } = simulation;
    const radius = machine.wheelsets[0].radius, rail = height - 50;
    const top = Math.max(...machine.bodies.map((body) => radius + body.height + shapeOf(body).size / 2)) + 0.2;
    const scale = Math.min(width / (2 * (machine.wheelsets[0].along + CAR.beyond + 0.7)), (rail - CAPTION) / top);
    const half = width / 2 / scale;
    const view = {
      context, scale, width, distance: kernel.get("distance"),
      x: (along) => width / 2 + scale * along,
      y: (above) => rail - scale * above,
    };
    context.save();
    context.translate(width / 2, rail);
    context.rotate(-Math.atan(line.gradient));
    context.translate(-width / 2, -rail);
    this.track(view, simulation, rail, half);
    for (const body of machine.bodies) {
      this.springs(view, body, machine, radius);
      this.body(view, body, simulation, radius);
    }
    machine.wheelsets.forEach((wheelset, number) => this.wheel(view, wheelset, number + 1, simulation));
    this.below(view, simulation, rail);
    context.restore();
    if (line.plan.length) this.plan(context, width / 2, height - 20, line.plan, view.distance, machine);
    Object.assign(context, { fillStyle: look.soft, textAlign: "left" });
    const drawn = `bounce and pitch drawn ${EXAGGERATED} times as large`;
    context.fillText(line.words && width < 500 ? line.words : [line.words, drawn].filter(Boolean).join("; "), 6, 14);
  }

  // The track from above, where the vehicle is: PLAN.length of it, in one scale, with the vehicle as a bar.
  plan(context, middle, y, rows, distance, { wheelsets }) {
    const scale = PLAN.width / PLAN.length, ends = [wheelsets[0].along, wheelsets.at(-1).along];
    const half = (way) => {
      const points = [[middle, y]];
      for (let at = 0, heading = 0, x = middle, place = y; Math.abs(at) < PLAN.length / 2; at += way) {
        heading += way * curvatureAt(rows, distance + at);
        x += way * scale * Math.cos(heading);
        place -= way * scale * Math.sin(heading);
        points.push([x, place]);
      }
      return points;
    };
    const ahead = half(1), behind = half(-1);
    const draw = (points, colour, wide) => {
      Object.assign(context, { strokeStyle: colour, lineWidth: wide });
      context.beginPath();
      for (const point of points) context.lineTo(...point);
      context.stroke();
    };
    draw([...behind.reverse(), ...ahead], look.steel, 2);
    draw([...behind.slice(Math.round(ends[1]) - 1), ...ahead.slice(0, Math.round(ends[0]) + 1)], look.fourth, 5);
    Object.assign(context, { fillStyle: look.soft, textAlign: "center" });
    context.fillText(`from above, ${PLAN.length} m`, middle, y + 16);
  }

  track({ context, x, scale, width, distance }, { patches, machine }, rail, half) {
    context.fillStyle = look.ground;
    const first = Math.ceil((distance - half) / SLEEPERS);
    for (let number = first; number * SLEEPERS < distance + half; number += 1)
      context.fillRect(x(number * SLEEPERS - distance) - 0.12 * scale, rail + 5, 0.24 * scale, 6);
    context.fillStyle = look.steel;
    context.fillRect(-width, rail, 3 * width, 5);
    context.fillStyle = look.leaf;
    for (const { begin, end } of patches) {
      const from = Math.max(0, x(begin - distance)), to = Math.min(width, x(end - distance));
      if (to > from) context.fillRect(from, rail - 5, to - from, 9);
    }
    context.fillStyle = look.soft;
    context.textAlign = "center";
    const reach = machine.wheelsets[0].along + CAR.beyond + 1.5; // posts behind the vehicle are hidden
    for (let post = Math.ceil((distance - half) / POSTS) * POSTS; post < distance + half; post += POSTS) {
      if (Math.abs(post - distance) < reach) continue;
      context.fillRect(x(post - distance) - 1, rail - 1.4 * scale, 2, 1.4 * scale);
      context.fillText(`${post} m`, x(post - distance), rail - 1.4 * scale - 4);
    }
  }

  body({ context, x, y, scale }, body, { machine, kernel }, radius) {
    const motion = (name) => (body.motions[name] ? kernel.get(body.motions[name]) : 0);
    const { size, beyond } = shapeOf(body), carried = body.carries.map((number) => machine.wheelsets[number]);
    const places = (carried.length ? carried : machine.wheelsets).map(({ along }) => along);
    const length = Math.max(...places) - Math.min(...places) + 2 * beyond;
    context.save();
    context.translate(x(body.along), y(radius + body.height + EXAGGERATED * motion("bounce")));
    context.rotate(EXAGGERATED * motion("pitch"));
    Object.assign(context, { fillStyle: carried.length ? look.frame : look.car, strokeStyle: look.ink, lineWidth: 1 });
    context.beginPath();
    context.roundRect((-length / 2) * scale, (-size / 2) * scale, length * scale, size * scale, 0.15 * scale);
    context.fill();
    context.stroke();
    if (!carried.length) this.windows(context, length, size, scale);
    context.restore();
  }

  windows(context, length, size, scale) {
    context.fillStyle = look.window;
    const count = Math.floor(length / PANE.pitch) - 1;
    for (let number = 0; number < count; number += 1) {
      const middle = (number - (count - 1) / 2) * PANE.pitch;
      context.fillRect((middle - PANE.width / 2) * scale, (-0.3 * size) * scale, PANE.width * scale, 0.3 * size * scale);
    }
  }

  springs({ context, x, y }, body, machine, radius) {
    Object.assign(context, { strokeStyle: look.steel, lineWidth: 4 });
    for (const number of body.carries) {
      const place = x(machine.wheelsets[number].along);
      context.beginPath();
      context.moveTo(place, y(radius));
      context.lineTo(place, y(radius + body.height));
      context.stroke();
    }
  }

  wheel({ context, x, y, scale }, { along, radius }, number, { kernel }) {
    const locked = slides(kernel, number), angle = kernel.get(`rotation_${number}`), size = radius * scale;
    context.save();
    context.translate(x(along), y(radius));
    Object.assign(context, { fillStyle: locked ? look.signal : look.paper, strokeStyle: look.ink, lineWidth: Math.max(2, 0.06 * scale) });
    context.beginPath();
    context.arc(0, 0, size, 0, 2 * Math.PI);
    context.fill();
    context.stroke();
    context.rotate(angle);
    Object.assign(context, { strokeStyle: locked ? look.paper : look.ink, lineWidth: 1.5 });
    context.beginPath();
    for (let spoke = 0; spoke < 6; spoke += 1) {
      context.moveTo(0, 0);
      context.lineTo(size * Math.cos((spoke * Math.PI) / 3), size * Math.sin((spoke * Math.PI) / 3));
    }
    context.stroke();
    context.restore();
    if (size >= SMALLEST) this.number(context, x(along), y(radius), number);
  }

  number(context, x, y, number) {
    Object.assign(context, { fillStyle: look.paper, strokeStyle: look.ink, lineWidth: 1, textAlign: "center" });
    context.beginPath();
    context.arc(x, y, 9, 0, 2 * Math.PI);
    context.fill();
    context.stroke();
    context.fillStyle = look.ink;
    context.fillText(`${number}`, x, y + 4);
  }

  // Below each wheelset its load, and what its valve or its brake does; where there is little room, by turns in two lines.
  below({ context, x, scale, width }, simulation, rail) {
    const narrow = scale * simulation.machine.wheelsets[0].radius < SMALLEST;
    context.textAlign = "center";
    simulation.read("axle_load").forEach((load, number) => {
      const place = x(simulation.machine.wheelsets[number].along), size = `${(load / 1e3).toFixed(narrow ? 0 : 1)} kN`;
      const locked = slides(simulation.kernel, number + 1);
      const words = [locked ? "locked" : "", VALVES[simulation.valves[number]]].filter(Boolean).join(", ");
      context.fillStyle = look.ink;
      if (narrow) {
        const text = [`${number + 1}: ${size}`, words].filter(Boolean).join(", "), half = context.measureText(text).width / 2 + 4;
        context.fillText(text, Math.min(Math.max(place, half), width - half), rail + (number % 2 ? 42 : 26));
        return;
      }
      context.fillText(size, place, rail + 26);
      context.fillStyle = look.signal;
      context.fillText(words, place, rail + 42);
    });
  }
}
