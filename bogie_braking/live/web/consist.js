// A consist on a line as the numbers of TrainDynamics.fmu (layout.py), with names and limits of speed beside them.

// Text in base64 of deflated bytes, which `unpacked` reads; in a link with letters that addresses leave as they are.
async function packed(bytes) {
  const stream = new Blob([bytes]).stream().pipeThrough(new CompressionStream("deflate"));
  const small = new Uint8Array(await new Response(stream).arrayBuffer());
  return btoa(Array.from(small, (byte) => String.fromCharCode(byte)).join(""));
}

const inLink = (text) => text.replaceAll("+", "-").replaceAll("/", "_").replaceAll("=", "");
const fromLink = (text) => text.replaceAll("-", "+").replaceAll("_", "/");

class Consist {
  // about: name, and if known vehicles (pairs of name and count), limits (first and last place [m], speed [m/s]), and notches.
  constructor(numbers, about, text) {
    Object.assign(this, { numbers, text, name: String(about.name), limits: about.limits ?? [], notches: about.notches ?? DATA.notches });
    this.names = (about.vehicles ?? []).flatMap(([name, count]) => Array(count).fill(String(name)));
  }

  // Returns the consist that carried_train.py or `asText` packed.
  static async from(text) {
    const bytes = await unpacked(text), [count] = new Float64Array(bytes, 0, 1), end = 8 * (count + 1);
    const about = JSON.parse(new TextDecoder().decode(bytes.slice(end)));
    if (about.layout !== DATA.mark) throw new Error("It was made by another version of bogie-braking. Make it again.");
    return new Consist(new Float64Array(bytes, 8, count), about, text);
  }

  async asText() {
    const { numbers, name } = this, about = new TextEncoder().encode(JSON.stringify({ name, layout: DATA.mark }));
    this.text ??= await packed(new Blob([Float64Array.of(numbers.length, ...numbers), about]));
    return this.text;
  }

  // Finds the columns of all groups in numbers that train_wrong has checked.
  lay() {
    const [[, , head]] = DATA.layout;
    this.counts = Object.fromEntries([["one", 1], ...head.map((name, place) => [name, this.numbers[place]])]);
    this.counts.couplings = this.counts.vehicles - 1;
    this.columns = {};
    let place = 0;
    for (const [group, of, fields] of DATA.layout)
      for (const field of fields) {
        this.columns[`${group}.${field}`] = this.numbers.subarray(place, place + this.counts[of]);
        place += this.counts[of];
      }
    const [distance, gradient] = ["distance", "gradient"].map((name) => this.columns[`point.${name}`]);
    this.running = this.columns["valve.running"][0] - this.columns["valve.around"][0]; // [Pa], below 0 of a vacuum
    this.line = { distance, gradient, begin: distance[0], end: distance.at(-1), isLevel: gradient.every((value) => value === 0) };
  }

  get vehicles() { return this.counts.vehicles; }

  // Place of the front at the start if none is given [m]: 0, or the begin of a line that is elsewhere.
  get start() {
    const { begin, end } = this.line;
    return begin < end && (begin > 0 || end < 0) ? begin : 0;
  }

  // Numbers of the owners of an input on which it has an effect.
  owners({ name, of }) {
    const all = Array.from({ length: of === "valves" ? 1 : this.counts[of] }, (_, number) => number), above = DATA.equipment[name];
    return above ? all.filter((number) => Object.entries(above).some(([field, value]) => this.columns[field][number] > value)) : all;
  }

  nameOf(vehicle) { return this.names[vehicle] ?? `vehicle ${vehicle + 1}`; }

  // Gradient at a place [1], linear between points and constant beyond them.
  gradientAt(place) {
    const { distance, gradient, begin, end } = this.line;
    if (place <= begin || place >= end) return place <= begin ? gradient[0] : gradient.at(-1);
    let low = 0, high = distance.length - 1;
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (distance[middle] <= place) low = middle;
      else high = middle;
    }
    return gradient[low] + ((place - distance[low]) / (distance[high] - distance[low])) * (gradient[high] - gradient[low]);
  }

  // Least limit between two places [m/s]; null without one.
  limitBetween(rear, front) {
    const those = this.limits.filter(([begin, end]) => begin <= front && end >= rear).map(([, , speed]) => speed);
    return those.length ? Math.min(...those) : null;
  }
}
