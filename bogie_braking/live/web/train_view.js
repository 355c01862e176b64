// The train, and below it rows of bars: pressure of the pipe, of the cylinders, forces of the couplers. The head is on the right.

const COUPLER = 4e5; // full bar [N], which grows with the forces
const fullCylinder = (running) => (running < 0 ? -running : 4.5e5); // full bar of the cylinders, by the charged pipe [Pa]

// The vehicles themselves above their bars, the head and those with motors in another colour; x: left end of the vehicle with a number.
function drawWagons(context, n, x, wide, powered) {
  for (let i = 0; i < n; i += 1) {
    const head = i === 0 || powered.includes(i);
    context.fillStyle = head ? look.signal : look.frame;
    context.fillRect(x(i), head ? 4 : 7, wide, head ? 11 : 8);
    context.fillStyle = look.ink;
    for (const share of [0.25, 0.75]) context.fillRect(x(i) + share * wide - 1, 15, 2, 3);
  }
}

// Left and right end of the train on a canvas [pixels].
const LEFT = 52, RIGHT = 10;

// The number of the vehicle at a pointer; null beside the train.
function vehicleAt({ offsetX, target }, n) {
  const share = (target.clientWidth - RIGHT - offsetX) / (target.clientWidth - RIGHT - LEFT);
  return share >= 0 && share < 1 ? Math.floor(share * n) : null;
}

function drawTrain(canvas, train) {
  const { context, width, height } = sharp(canvas);
  const box = { left: LEFT, right: width - RIGHT }, size = (height - 102) / 3, n = train.vehicles;
  const x = (i) => box.right - ((box.right - box.left) * (i + 1)) / n, wide = Math.max((box.right - box.left) / n - 1, 1);
  // title, values from the head on, full bar, colour by value, marks at shares of it; zero: share of the row below 0.
  const row = (number, title, values, most, colour, marks, zero = 0, offset = 0) => {
    const top = 42 + number * (size + 26), ground = top + size * (1 - zero), tall = size * (1 - zero);
    Object.assign(context, { fillStyle: look.ink, textAlign: "left" });
    context.fillText(title, box.left, top - 5);
    Object.assign(context, { fillStyle: look.soft, textAlign: "right" });
    for (const [share, mark] of marks) context.fillText(mark, box.left - 6, ground - tall * share + 4);
    values.forEach((value, i) => {
      const up = Math.max(-1, Math.min(1, value / most)) * tall;
      context.fillStyle = colour(value);
      context.fillRect(x(i) - offset, up >= 0 ? ground - up : ground, wide, Math.abs(up));
    });
    context.fillStyle = look.edge;
    context.fillRect(box.left, ground, box.right - box.left, 1);
  };
  drawWagons(context, n, x, wide, train.controls.traction ?? []);
  const full = Math.abs(train.consist.running), sign = Math.sign(train.consist.running), pipe = train.pressure("pipe_pressure");
  row(0, `${sign < 0 ? "vacuum in the " : ""}brake pipe [bar], the head on the right`, pipe.map((pressure) => sign * pressure), 1.1 * full,
    () => look.pipe, [[0, "0"], [1 / 1.1, `${+(full / 1e5).toFixed(1)}`]]);
  const cylinder = fullCylinder(train.consist.running), mark = sign < 0 ? 0.5e5 : 3.8e5;
  row(1, "brake cylinders [bar]", train.pressure("cylinder_pressure"), cylinder, () => look.signal, [[0, "0"], [mark / cylinder, `${mark / 1e5}`]]);
  const most = Math.max(COUPLER, 1e5 * Math.ceil(Math.max(0, ...train.pushed, ...train.pulled) / 1e5)), kilo = most / 1e3;
  const marks = [[0, "0"], [1, `+${kilo}`], [-1, `-${kilo}`]];
  row(2, "coupler forces [kN], pushed below 0", [...train.output("coupler_force")], most,
    (force) => (force < 0 ? look.leaf : look.pipe), marks, 0.5, wide / 2);
  drawExtremes(context, train, x, wide, { ground: height - size / 2 - 8, tall: size / 2, most });
}

// Largest tension and compression of each coupling since the brake application, as marks beside its bar.
function drawExtremes(context, { pulled, pushed }, x, wide, { ground, tall, most }) {
  context.fillStyle = look.ink;
  for (const [forces, sign] of [[pulled, -1], [pushed, 1]])
    forces.forEach((force, i) => force > 0.01 * most && context.fillRect(x(i) - wide / 2, ground + (sign * force * tall) / most - 1, wide, 2));
}
