// The clock of a page: while it runs, `advance` is called in each frame with the seconds since the last, times the pace.

const LONGEST_FRAME = 0.1; // a page that was inactive does not catch up [s]

class Player {
  // words: of the button while the clock stands, and while it runs.
  constructor(words, advance) {
    Object.assign(this, { words, advance, running: false });
    at("play").addEventListener("click", () => (this.running ? this.stop() : this.play()));
  }

  // Called before the clock runs.
  begin() {}

  play() {
    this.begin();
    cancelAnimationFrame(this.next);
    this.last = performance.now();
    this.running = true;
    at("play").textContent = this.words[1];
    this.next = requestAnimationFrame((now) => this.frame(now));
  }

  stop() {
    this.running = false;
    at("play").textContent = this.words[0];
  }

  frame(now) {
    if (!this.running) return;
    const seconds = Math.min(Math.max(now - this.last, 0) / 1e3, LONGEST_FRAME);
    this.last = Math.max(now, this.last);
    this.next = requestAnimationFrame((next) => this.frame(next));
    this.advance(seconds * Number(at("pace").value));
  }
}
