// Plays the stops of a case: its controls, and all views that follow its clock.

class Comparison extends Player {
  constructor(stops) {
    super(["Play", "Pause"], (seconds) => this.goOn(seconds));
    Object.assign(this, { stops, time: 0 });
    at("case").addEventListener("change", () => this.choose());
    at("time").addEventListener("input", () => this.go(Number(at("time").value)));
    for (const button of document.querySelectorAll("#scores button"))
      button.addEventListener("click", () => {
        at("case").value = button.dataset.case;
        this.choose();
        at("player").scrollIntoView();
        at("play").focus({ preventScroll: true });
      });
    document.addEventListener("keydown", (event) => this.key(event));
    new ResizeObserver(() => this.draw()).observe(at("tracks"));
    look.changed = () => this.legend();
    this.choose();
  }

  // Begins with the selected case of the list.
  choose() {
    const name = DATA.cases[Number(at("case").value)], own = this.stops.filter((stop) => stop.case === name);
    this.latest = Math.max(...own.map(({ end }) => end));
    const far = Math.max(...own.map(({ way, ideal }) => Math.max(way.at(-1), ideal ?? 0)));
    const fastest = Math.max(...own.map(({ speed }) => Math.max(...speed)));
    this.tracks = own.map((stop, number) => new Track(stop, far, number === 0));
    this.charts = own.map((stop) => new StopChart(stop, this.latest, fastest, (time) => this.go(time)));
    at("tracks").replaceChildren(...this.tracks.map(({ element }) => element));
    at("charts").replaceChildren(...this.charts.map(({ element }) => element));
    document.querySelectorAll("#scores tbody").forEach((one, number) => {
      if (String(number) === at("case").value) one.setAttribute("aria-current", "true");
      else one.removeAttribute("aria-current");
    });
    at("time").max = Math.ceil(10 * this.latest) / 10;
    this.legend();
    this.stop();
    this.go(0);
  }

  legend() {
    const names = ["vehicle", ...this.stops[0].wheel.map((_, number) => `wheels of wheelset ${number + 1}`), "reading of its sensor"];
    at("legend").replaceChildren(...names.map((name, number) => {
      const item = document.createElement("span"), sample = document.createElement("canvas");
      item.append(sample, name);
      at("legend").append(item);
      const { context, width, height } = sharp(sample), last = number === names.length - 1;
      const colours = number === 0 ? "ink" : last ? "soft" : this.stops[0].colours[number - 1];
      const dashes = number === 0 ? [] : last ? [1, 3] : DASHES[(number - 1) % DASHES.length];
      stroke(context, [[0, height / 2], [width, height / 2]], colours, number === 0 ? 2.2 : 1.6, dashes);
      return item;
    }));
    this.draw();
  }

  key(event) {
    if (event.ctrlKey || event.altKey || event.metaKey || event.target.closest("select, input")) return;
    const steps = { ArrowLeft: -1, ArrowRight: 1 };
    if (event.key in steps && !event.target.closest(".wide")) this.go(this.time + steps[event.key]);
    else if (event.key === " " && !event.target.closest("button")) at("play").click();
    else return;
    event.preventDefault();
  }

  begin() {
    if (this.time >= this.latest) this.go(0);
  }

  goOn(seconds) {
    this.tell(this.time, this.time + seconds);
    this.go(this.time + seconds);
    if (this.time >= this.latest) this.stop();
  }

  // Announces the vehicles that came to rest in between, for screen readers.
  tell(before, now) {
    const ended = this.tracks.filter(({ stop }) => before < stop.end && stop.end <= now);
    if (ended.length) at("told").textContent = ended.map(({ stop }) => `${stop.controller}: ${!stop.judged ? DATA.notJudged : stop.distance === null ? DATA.noEnd : `${stop.distance.toFixed(0)} m`}`).join("; ");
  }

  go(time) {
    this.time = Math.min(Math.max(time, 0), this.latest);
    at("time").value = this.time;
    at("time").setAttribute("aria-valuetext", `${this.time.toFixed(1)} seconds`);
    at("clock").textContent = `${this.time.toFixed(1)} of ${this.latest.toFixed(1)} s`;
    this.draw();
  }

  draw() {
    for (const one of [...this.tracks, ...this.charts]) one.draw(this.time);
  }
}

// Promise that tests wait for.
globalThis.comparison = stopsOf(DATA).then((stops) => new Comparison(stops)).catch((error) => {
  at("clock").textContent = "This browser cannot unpack the stops; take a newer one.";
  throw error;
});
