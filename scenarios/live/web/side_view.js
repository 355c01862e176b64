// The machine from its left side, running to the right: bodies, turning wheels, axle loads, rails with patches.

const EXAGGERATED = 10; // bounce and pitch of the bodies
const SLEEPERS = 0.6, POSTS = 50; // along the track [m]
const FRAME = { size: 0.5, beyond: 0.6 }, CAR = { size: 2.6, beyond: 2.5 }; // height and what juts out, drawn [m]

// What carries wheelsets is drawn as a frame, what lies on frames as a car.
function shapeOf(body) {
  return body.carries.length ? FRAME : CAR;
}

class SideView {
  constructor(canvas, colours) {
    Object.assign(this, { canvas, colours });
  }

  draw(simulation) {
    const { context, width, height } = sharp(this.canvas), { machine, kernel } = simulation;
    const radius = machine.wheelsets[0].radius, rail = height - 46;
    const top = Math.max(...machine.bodies.map((body) => radius + body.height + shapeOf(body).size / 2)) + 0.3;
    const scale = Math.min(width / (2 * (machine.wheelsets[0].along + CAR.beyond + 0.7)), rail / top);
    const half = width / 2 / scale;
    const view = {
      context, scale, width, distance: kernel.get("distance"),
      x: (along) => width / 2 + scale * along,
      y: (above) => rail - scale * above,
    };
    this.track(view, simulation.patches, rail, half);
    for (const body of machine.bodies) {
      this.springs(view, body, machine, radius);
      this.body(view, body, simulation, radius);
    }
    machine.wheelsets.forEach((wheelset, number) => this.wheel(view, wheelset, number + 1, simulation));
    this.loads(view, simulation, rail);
  }

  track({ context, x, scale, width, distance }, patches, rail, half) {
    context.fillStyle = "#b9a48a";
    const first = Math.ceil((distance - half) / SLEEPERS);
    for (let number = first; number * SLEEPERS < distance + half; number += 1)
      context.fillRect(x(number * SLEEPERS - distance) - 0.12 * scale, rail + 5, 0.24 * scale, 6);
    context.fillStyle = "#777777";
    context.fillRect(0, rail, width, 5);
    context.fillStyle = this.colours[2];
    for (const { begin, end } of patches) {
      const from = Math.max(0, x(begin - distance)), to = Math.min(width, x(end - distance));
      if (to > from) context.fillRect(from, rail - 3, to - from, 8);
    }
    context.fillStyle = INK;
    context.textAlign = "center";
    for (let post = Math.ceil((distance - half) / POSTS) * POSTS; post < distance + half; post += POSTS) {
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
    context.fillStyle = carried.length ? "#56606b" : "#dfe7ee";
    context.strokeStyle = INK;
    context.lineWidth = 1;
    context.beginPath();
    context.roundRect((-length / 2) * scale, (-size / 2) * scale, length * scale, size * scale, 0.15 * scale);
    context.fill();
    context.stroke();
    context.restore();
  }

  springs({ context, x, y }, body, machine, radius) {
    context.strokeStyle = "#8a949e";
    context.lineWidth = 4;
    for (const number of body.carries) {
      const place = x(machine.wheelsets[number].along);
      context.beginPath();
      context.moveTo(place, y(radius));
      context.lineTo(place, y(radius + body.height));
      context.stroke();
    }
  }

  wheel({ context, x, y, scale }, { along, radius }, number, { kernel }) {
    const locked = kernel.get(`locked_${number}`) > 0.5, angle = kernel.get(`rotation_${number}`);
    context.save();
    context.translate(x(along), y(radius));
    context.fillStyle = locked ? this.colours[3] : "#ffffff";
    context.strokeStyle = INK;
    context.lineWidth = Math.max(2, 0.06 * scale);
    context.beginPath();
    context.arc(0, 0, radius * scale, 0, 2 * Math.PI);
    context.fill();
    context.stroke();
    context.rotate(angle);
    context.strokeStyle = locked ? "#ffffff" : INK;
    context.beginPath();
    for (let spoke = 0; spoke < 6; spoke += 1) {
      context.moveTo(0, 0);
      context.lineTo(radius * scale * Math.cos((spoke * Math.PI) / 3), radius * scale * Math.sin((spoke * Math.PI) / 3));
    }
    context.lineWidth = 1.5;
    context.stroke();
    context.restore();
  }

  loads({ context, x }, simulation, rail) {
    const narrow = simulation.count > 2 && this.canvas.clientWidth < 700;
    context.fillStyle = INK;
    context.textAlign = "center";
    simulation.read("axle_load").forEach((load, number) => {
      const place = x(simulation.machine.wheelsets[number].along);
      const locked = simulation.kernel.get(`locked_${number + 1}`) > 0.5, size = (load / 1e3).toFixed(narrow ? 0 : 1);
      context.fillText(`${size}${narrow ? "" : " kN"}`, place, rail + 26);
      if (locked) context.fillText("locked", place, rail + 41);
    });
    context.textAlign = "left";
    context.fillText(`axle loads${narrow ? " [kN]" : ""}; bounce and pitch drawn ${EXAGGERATED} times`, 6, 14);
  }
}
