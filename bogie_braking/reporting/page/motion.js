// Draws a recorded motion: the vehicle in 3D and its wheels on the rails' heads, at the instant of the time bar.
// Coordinates as in the model: x ahead, y to the left, z above the rails, turned by Rz(yaw) Rx(roll) Ry(pitch).

(() => {
  const data = DATA, space = at("space"), section = at("section"), bar = at("time"), factor = at("exaggeration");
  const SLEEPER_DISTANCE = 0.6, RIM = 24, HALF_TREAD = 0.065, GREY = "#777777";
  const STRAIGHTEST = 1e5; // a curve of a longer radius is called straight [m]

  // Series come as base64 of 32-bit floats.
  const unpacked = (value) => {
    if (typeof value === "string" && value.length > 0)
      return new Float32Array(Uint8Array.from(atob(value), (letter) => letter.charCodeAt(0)).buffer);
    return value;
  };
  const unpack = (part, texts = ["text"]) => {
    for (const [name, value] of Object.entries(part)) if (!texts.includes(name)) part[name] = unpacked(value);
  };
  [data, data.rails, ...data.bodies, ...data.wheelsets, ...data.wheelsets.flatMap((one) => one.wheels)].forEach(
    (part) => unpack(part));

  // -- geometry ----------------------------------------------------------------------------------------------------

  const placed = (centre, [roll, pitch, yaw]) => {
    const [cr, sr, cp, sp, cy, sy] = [roll, pitch, yaw].flatMap((angle) => [Math.cos(angle), Math.sin(angle)]);
    return ([x, y, z]) => {
      const [a, c] = [cp * x + sp * z, cp * z - sp * x];
      const [b, d] = [cr * y - sr * c, sr * y + cr * c];
      return [centre[0] + cy * a - sy * b, centre[1] + sy * a + cy * b, centre[2] + d];
    };
  };

  // Corner n of a box has the bits of n as its sides; its faces as triangles, its edges as pairs of corners.
  const corners = ([low, high]) =>
    [...Array(8).keys()].map((n) => [0, 1, 2].map((axis) => ((n >> axis) & 1 ? high : low)[axis]));
  const BOX_FACES = [[0, 1, 3], [0, 3, 2], [4, 5, 7], [4, 7, 6], [0, 1, 5], [0, 5, 4], [2, 3, 7], [2, 7, 6],
    [0, 2, 6], [0, 6, 4], [1, 3, 7], [1, 7, 5]];
  const BOX_EDGES = [0, 1, 2].flatMap((axis) =>
    [...Array(8).keys()].filter((n) => !((n >> axis) & 1)).map((n) => [n, n | (1 << axis)]));

  // A wheel is a cylinder: two rims of RIM points, inner and outer, and their centres.
  const wheelPoints = (side, half, radius) => {
    const points = [];
    for (const y of [half - HALF_TREAD, half + HALF_TREAD]) {
      for (let n = 0; n < RIM; n++) {
        const angle = (2 * Math.PI * n) / RIM;
        points.push([radius * Math.sin(angle), side * y, radius * Math.cos(angle)]);
      }
      points.push([0, side * y, 0]);
    }
    return points;
  };
  const wheelFaces = (first) => [...Array(RIM).keys()].flatMap((n) => {
    const [a, b, c, d] = [n, (n + 1) % RIM, n + RIM + 1, ((n + 1) % RIM) + RIM + 1].map((point) => first + point);
    return [[a, b, c], [b, d, c], [a, b, first + RIM], [c, d, first + 2 * RIM + 1]];
  });

  const columns = (points) => [0, 1, 2].map((axis) => points.map((point) => (point ? point[axis] : null)));
  const lines = (pieces) => pieces.flatMap((piece) => [...piece, null]);
  const mesh = (name, faces, color, opacity) => {
    const [i, j, k] = columns(faces);
    return { type: "mesh3d", name, i, j, k, color, opacity, flatshading: true, hoverinfo: "name", x: [], y: [], z: [] };
  };
  const strokes = (name, color, width) => ({
    type: "scatter3d", mode: "lines", name, line: { color, width }, hoverinfo: "name", connectgaps: false,
    x: [], y: [], z: [],
  });

  // -- the vehicle at one instant -----------------------------------------------------------------------------------

  const bodyAt = (body, frame, factor) => {
    const [x, y, z] = body.centre;
    const moved = [x, y + factor * body.lateral[frame], z + factor * body.bounce[frame]];
    const angles = [body.roll, body.pitch, body.yaw].map((angle) => factor * angle[frame]);
    return corners(body.box).map(placed(moved, angles)).map(canted(frame, x));
  };
  const wheelsetAt = (one, frame, factor) => {
    const centre = [one.along, factor * one.lateral[frame], one.radius + factor * one.bounce[frame]];
    const angles = [factor * one.roll[frame], one.rotation[frame], factor * one.yaw[frame]];
    const own = placed(centre, angles), tilt = canted(frame, one.along), half = one.half_distance;
    const place = (point) => tilt(own(point));
    const marks = [1, -1].map((side) => {
      const outside = side * (half + HALF_TREAD + 0.005);
      return [[0, outside, 0], [0, outside, one.radius]].map(place);
    });
    const axle = [[0, half, 0], [0, -half, 0]].map(place);
    const wheels = [1, -1].flatMap((side) => wheelPoints(side, half, one.radius)).map(place);
    return { wheels, strokes: [axle, ...marks] };
  };

  const valueAt = (places, values, place) => {
    const pitch = places[1] - places[0], last = places.length - 1;
    const share = Math.min(Math.max((place - places[0]) / pitch, 0), last), n = Math.min(Math.floor(share), last - 1);
    return values[n] + (share - n) * (values[n + 1] - values[n]);
  };
  const railPoint = (side, x, frame, factor) => {
    const { distance, lateral, left, right, curvature } = data.rails, here = data.distance[frame], place = here + x;
    const [aside, above] = [lateral, side > 0 ? left : right].map((values) => valueAt(distance, values, place));
    const bend = (x * x * (2 * valueAt(distance, curvature, here) + valueAt(distance, curvature, place))) / 6;
    return [x, side * data.wheelsets[0].half_distance + factor * (aside + bend), factor * above];
  };
  // The cross-section at x, turned by the cant there about the track's axis: the right rail rises where it is positive.
  const canted = (frame, x) => {
    const { distance, cant } = data.rails, sine = valueAt(distance, cant, data.distance[frame] + x) / data.gauge;
    const cosine = Math.sqrt(1 - sine * sine);
    return ([ahead, y, z]) => [ahead, cosine * y + sine * z, cosine * z - sine * y];
  };
  const trackAt = (frame, factor) => {
    const reach = data.half_length, steps = Math.ceil(reach / 0.25);
    const along = [...Array(2 * steps + 1).keys()].map((n) => (n / steps - 1) * reach);
    const rails = [1, -1].map((side) => along.map((x) => canted(frame, x)(railPoint(side, x, frame, factor))));
    const sleepers = [], first = Math.ceil((data.distance[frame] - reach) / SLEEPER_DISTANCE);
    for (let n = first; n * SLEEPER_DISTANCE <= data.distance[frame] + reach; n++) {
      const x = n * SLEEPER_DISTANCE - data.distance[frame];
      const [left, right] = [1, -1].map((side) => railPoint(side, x, frame, factor));
      sleepers.push([[x, left[1] + 0.4, left[2] - 0.05], [x, right[1] - 0.4, right[2] - 0.05]].map(canted(frame, x)));
    }
    return { rails, sleepers };
  };

  const pointsAt = (frame, factor) => {
    const bodies = data.bodies.map((body) => bodyAt(body, frame, factor));
    const wheelsets = data.wheelsets.map((one) => wheelsetAt(one, frame, factor));
    const track = trackAt(frame, factor);
    const edges = bodies.flatMap((body) => BOX_EDGES.map((edge) => edge.map((corner) => body[corner])));
    return [...bodies, ...wheelsets.map((one) => one.wheels), lines([...edges, ...wheelsets.flatMap((one) => one.strokes)]),
      lines(track.rails), lines(track.sleepers)];
  };

  // -- both views -----------------------------------------------------------------------------------------------------

  const vehicleTraces = () => [
    ...data.bodies.map((body) => mesh(body.text, BOX_FACES, "#bbbbbb", 0.35)),
    ...data.wheelsets.map((one, n) =>
      mesh(one.text, [...wheelFaces(0), ...wheelFaces(2 * RIM + 2)], data.colours[n % data.colours.length], 0.8)),
    strokes("edges, axles, marks on the wheels", "#111111", 4),
    strokes("rails", GREY, 6),
    strokes("sleepers", "#cccccc", 3),
  ];
  const spaceLayout = () => {
    const reach = data.half_length, top = Math.max(...data.bodies.map((body) => body.centre[2] + body.box[1][2])) + 0.5;
    const axis = (title, range) => ({ title: { text: title, font: { size: 11 } }, range, autorange: false });
    const across = data.wheelsets[0].half_distance + 1;
    const ratio = { x: 1.6, y: (1.6 * across) / reach, z: (0.8 * (top + 0.5)) / reach };
    // A narrow window, and a vehicle as wide as long, ask for more distance, or axes are cut.
    const away = (0.8 + 0.32 * ratio.y) * Math.max(1.1, 580 / space.clientWidth);
    return {
      showlegend: false, margin: { l: 0, r: 0, t: 0, b: 0 },
      scene: {
        xaxis: axis("ahead [m]", [-reach, reach]), yaxis: axis("to the left [m]", [-across, across]),
        zaxis: axis("above rails [m]", [-0.5, top]),
        aspectmode: "manual", aspectratio: ratio,
        camera: { eye: { x: 1.35 * away, y: -1.6 * away, z: 0.65 * away }, center: { x: 0.25 * (1 - ratio.y), y: 0, z: -0.15 } },
      },
    };
  };

  // A wheel over its rail viewed along the track, in mm from the y = 0 of the rail; right in the plot is right of the
  // track.
  const wheelOverRail = (one, wheel, frame) => {
    const { side, radius, wheel_half_distance: half } = wheel, roll = one.roll[frame];
    const [c, s] = [Math.cos(roll), Math.sin(roll)];
    const height = wheel.rise[frame] - side * half * s + radius * c;
    const points = wheel.wheel.map(([y, z]) => {
      const below = radius - z / 1e3, outward = side * (half + y / 1e3);
      return [outward * c + below * s + one.offset[frame] - side * wheel.rail_half_distance, outward * s - below * c + height];
    });
    return { x: points.map((point) => -1e3 * point[0]), y: points.map((point) => 1e3 * point[1]) };
  };
  const sectionTraces = () => data.wheelsets[0].wheels.flatMap((wheel, n) => {
    const axes = n ? { xaxis: "x2", yaxis: "y2" } : {};
    const rail = { x: wheel.rail.map(([y]) => -wheel.side * y), y: wheel.rail.map(([, z]) => z) };
    const line = { mode: "lines", hovertemplate: "%{x:.2f} mm, %{y:.2f} mm<extra>%{fullData.name}</extra>", ...axes };
    return [
      { ...line, name: `${wheel.text} rail`, line: { color: "#aaaaaa", width: 6 }, ...rail },
      { ...line, name: `${wheel.text} wheel`, line: { color: data.colours[0], width: 2 }, x: [], y: [] },
    ];
  });
  const sectionLayout = () => {
    const axis = (text, range, more) =>
      ({ title: { text, font: { size: 11 } }, range, zeroline: false, constrain: "domain", ...more });
    const across = (more) => axis("to the right [mm]", [-60, 60], more);
    const above = (wheel, more) => axis(`${wheel.text}: up [mm]`, [-30, 15], more);
    const [left, right] = data.wheelsets[0].wheels;
    return {
      showlegend: false, margin: { l: 50, r: 10, t: 30, b: 40 }, grid: { rows: 2, columns: 1, pattern: "independent" },
      xaxis: across({ title: { text: "" } }), yaxis: above(left, { scaleanchor: "x" }),
      xaxis2: across(), yaxis2: above(right, { scaleanchor: "x2" }),
    };
  };
  // Without the sign of a value that rounds to 0.
  const shown = (value, digits) => (Math.round(value * 10 ** digits) / 10 ** digits + 0).toFixed(digits);
  const forces = (wheel, frame) =>
    `${wheel.text}: Q ${shown(wheel.load[frame] / 1e3, 1)} kN, Y ${shown(wheel.lateral_force[frame] / 1e3, 1)} kN`;

  const lineAt = (place) => {
    const [curvature, cant, gradient] = ["curvature", "cant", "gradient"].map(
      (name) => valueAt(data.rails.distance, data.rails[name], place));
    const radius = Math.abs(1 / curvature), hand = curvature > 0 ? "left" : "right";
    const plan = radius < STRAIGHTEST ? `curve to the ${hand} of ${shown(radius, 0)} m` : "straight";
    return `${plan}, cant ${shown(1e3 * cant, 0)} mm, gradient ${shown(1e3 * gradient, 1)} \u2030`;
  };

  const draw = () => {
    const frame = Number(bar.value), times = Number(factor.value);
    const [x, y, z] = [0, 1, 2].map((axis) => pointsAt(frame, times).map((points) => columns(points)[axis]));
    Plotly.restyle(space, { x, y, z });
    at("instant").textContent = `${shown(data.time[frame], 2)} s, ${shown(data.speed[frame], 2)} m/s, `
      + `${shown(data.distance[frame], 1)} m`;
    if (data.on_line) at("line").textContent = lineAt(data.distance[frame]);
    at("factor").textContent = `${times} times`;
    bar.setAttribute("aria-valuetext", at("instant").textContent);
    factor.setAttribute("aria-valuetext", at("factor").textContent);
    if (section) drawSection(frame);
  };
  const drawSection = (frame) => {
    const one = data.wheelsets[Number(at("wheelset").value)];
    const curves = one.wheels.map((wheel) => wheelOverRail(one, wheel, frame));
    // Without what a restyle does to axes and margins, which takes ten times as long.
    const atOnce = { transition: { duration: 0 }, frame: { duration: 0, redraw: false }, mode: "immediate" };
    Plotly.animate(section, { data: curves, traces: [1, 3] }, atOnce);
    at("forces").textContent = one.wheels.map((wheel) => forces(wheel, frame)).join("; ");
  };

  // -- playing ------------------------------------------------------------------------------------------------------

  const last = data.time.length - 1;
  let time = 0;
  const player = new Player(["Play", "Stop"], (seconds) => {
    time += seconds;
    while (Number(bar.value) < last && data.time[Number(bar.value)] < time) bar.value = Number(bar.value) + 1;
    draw();
    if (Number(bar.value) >= last) player.stop();
  });
  player.begin = () => {
    if (Number(bar.value) >= last) bar.value = 0;
    time = data.time[Number(bar.value)];
  };
  bar.max = last;
  factor.value = data.exaggeration;
  bar.addEventListener("input", () => { player.stop(); draw(); });
  factor.addEventListener("input", draw);

  const options = { responsive: true, displaylogo: false };
  const ready = [Plotly.newPlot(space, vehicleTraces(), spaceLayout(), options)];
  if (section) {
    at("wheelset").addEventListener("change", draw);
    ready.push(Plotly.newPlot(section, sectionTraces(), sectionLayout(), options));
  }
  Promise.all(ready).then(draw);
})();
