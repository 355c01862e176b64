// Plays the stops of a case: its clock, its controls, and what follows them.

const DATA = JSON.parse(document.getElementById("data").textContent);
const field = (name) => document.getElementById(name);

class Player {
  constructor(stops) {
    Object.assign(this, { stops, time: 0, last: null });
    field("play").addEventListener("click", () => this.toggle());
    field("case").addEventListener("change", () => this.choose());
    field("time").addEventListener("input", () => this.go(Number(field("time").value)));
    for (const button of document.querySelectorAll("#scores button"))
      button.addEventListener("click", () => {
        field("case").value = button.dataset.case;
        this.choose();
        field("player").scrollIntoView();
        field("play").focus({ preventScroll: true });
      });
    document.addEventListener("keydown", (event) => this.key(event));
    new ResizeObserver(() => this.draw()).observe(field("tracks"));
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.legend());
    this.choose();
  }

  // Begins with the case that the list says.
  choose() {
    const name = DATA.cases[Number(field("case").value)], own = this.stops.filter((stop) => stop.case === name);
    this.latest = Math.max(...own.map(({ end }) => end));
    const far = Math.max(...own.map(({ way, ideal }) => Math.max(way.at(-1), ideal ?? 0)));
    const fastest = Math.max(...own.map(({ speed }) => Math.max(...speed)));
    this.tracks = own.map((stop, number) => new Track(stop, far, number === 0));
    this.charts = own.map((stop) => new StopChart(stop, this.latest, fastest, (time) => this.go(time)));
    field("tracks").replaceChildren(...this.tracks.map(({ element }) => element));
    field("charts").replaceChildren(...this.charts.map(({ element }) => element));
    document.querySelectorAll("#scores tbody").forEach((one, number) => {
      if (String(number) === field("case").value) one.setAttribute("aria-current", "true");
      else one.removeAttribute("aria-current");
    });
    field("time").max = Math.ceil(10 * this.latest) / 10;
    this.legend();
    this.stop();
    this.go(0);
  }

  legend() {
    const names = ["machine", ...this.stops[0].wheel.map((_, number) => `wheels of wheelset ${number + 1}`), "what its sensor shows"];
    field("legend").replaceChildren(...names.map((name, number) => {
      const item = document.createElement("span"), sample = document.createElement("canvas");
      item.append(sample, name);
      field("legend").append(item);
      const { context, width, height } = sharp(sample), last = number === names.length - 1;
      context.strokeStyle = number === 0 || last ? colour(last ? "soft" : "ink") : wheelColour(number - 1);
      context.lineWidth = number === 0 ? 2.2 : 1.6;
      context.setLineDash(number === 0 ? [] : last ? [1, 3] : DASHES[(number - 1) % 4]);
      context.beginPath();
      context.moveTo(0, height / 2);
      context.lineTo(width, height / 2);
      context.stroke();
      return item;
    }));
    this.draw();
  }

  key(event) {
    if (event.ctrlKey || event.altKey || event.metaKey || event.target.closest("select, input")) return;
    const steps = { ArrowLeft: -1, ArrowRight: 1 };
    if (event.key in steps && !event.target.closest(".wide")) this.go(this.time + steps[event.key]);
    else if (event.key === " " && !event.target.closest("button")) this.toggle();
    else return;
    event.preventDefault();
  }

  toggle() {
    if (this.last !== null) return this.stop();
    if (this.time >= this.latest) this.go(0);
    this.last = performance.now();
    field("play").textContent = "Pause";
    requestAnimationFrame((now) => this.advance(now));
  }

  stop() {
    this.last = null;
    field("play").textContent = "Play";
  }

  advance(now) {
    if (this.last === null) return;
    const time = this.time + (Math.max(now - this.last, 0) / 1e3) * Number(field("pace").value);
    this.last = Math.max(now, this.last);
    this.tell(this.time, time);
    this.go(time);
    if (this.time >= this.latest) this.stop(); else requestAnimationFrame((next) => this.advance(next));
  }

  // Says which machines came to rest in between, for who does not see them.
  tell(before, now) {
    const ended = this.tracks.filter(({ stop }) => before < stop.end && stop.end <= now);
    if (ended.length) field("told").textContent = ended.map(({ stop }) => `${stop.controller}: ${!stop.judged ? DATA.notJudged : stop.distance === null ? DATA.noEnd : `${stop.distance.toFixed(0)} m`}`).join("; ");
  }

  go(time) {
    this.time = Math.min(Math.max(time, 0), this.latest);
    field("time").value = this.time;
    field("time").setAttribute("aria-valuetext", `${this.time.toFixed(1)} seconds`);
    field("clock").textContent = `${this.time.toFixed(1)} of ${this.latest.toFixed(1)} s`;
    this.draw();
  }

  draw() {
    for (const one of [...this.tracks, ...this.charts]) one.draw(this.time);
  }
}

// What tests wait for.
globalThis.comparison = stopsOf(DATA).then((stops) => new Player(stops)).catch((error) => {
  field("clock").textContent = "This browser cannot unpack the stops; take a newer one.";
  throw error;
});
