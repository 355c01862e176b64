// The train, and below it rows of bars: pressure of the pipe, of the cylinders, forces of the couplers. The head is on the right.

const PIPE = 5e5, CYLINDER = 3.8e5, COUPLER = 4e5; // full bars [Pa], [N]

// The vehicles themselves above their bars, the head another colour; x: left end of the vehicle with a number.
function drawWagons(context, n, x, wide) {
  for (let i = 0; i < n; i += 1) {
    context.fillStyle = i === 0 ? look.signal : look.frame;
    context.fillRect(x(i), i === 0 ? 4 : 7, wide, i === 0 ? 11 : 8);
    context.fillStyle = look.ink;
    for (const share of [0.25, 0.75]) context.fillRect(x(i) + share * wide - 1, 15, 2, 3);
  }
}

function drawTrain(canvas, train) {
  const { context, width, height } = sharp(canvas);
  const box = { left: 52, right: width - 10 }, size = (height - 102) / 3, n = train.vehicles;
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
  drawWagons(context, n, x, wide);
  const over = (name) => [...train.output(name)].map((pressure) => pressure - AROUND);
  row(0, "brake pipe [bar], the head on the right", over("pipe_pressure"), 1.1 * PIPE, () => look.pipe, [[0, "0"], [1 / 1.1, "5"]]);
  row(1, "brake cylinders [bar]", over("cylinder_pressure"), 1.1 * CYLINDER, () => look.signal, [[0, "0"], [1 / 1.1, "3.8"]]);
  const marks = [[0, "0"], [1, "+400"], [-1, "-400"]];
  row(2, "coupler forces [kN], pushed below 0", [...train.output("coupler_force")], COUPLER,
    (force) => (force < 0 ? look.leaf : look.pipe), marks, 0.5, wide / 2);
}
