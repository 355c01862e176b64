// The desk of a train: the handle of the driver's valve by its notches, a lever for each control that the train has, keys.

const WORDS = { traction: "traction", dynamic_brake: "dynamic brake", bail_off: "bail off" };
const controlWord = (name) => WORDS[name] ?? name.replaceAll("_", " ");
const NOTCH = 10; // of a lever's key [%]

class TrainDesk {
  // act: called with a notch, or with a control and its value [%].
  constructor(act) {
    this.act = act;
    this.keys();
    addEventListener("keydown", (event) => this.key(event));
  }

  keys() {
    const [less, more] = DATA.valveKeys[2].split(" ");
    at("valve-keys").innerHTML = `<kbd>${less}</kbd> <kbd>${more}</kbd> <kbd>backspace</kbd>`;
    at("valve-keys").title = "towards release, towards emergency, emergency: keys by their places on a US keyboard";
  }

  // The notches and levers of a train; those that it lacks are left out.
  begin(train) {
    this.train = train;
    at("valve").replaceChildren(...Object.keys(train.notches).map((name) => this.notch(name)));
    at("levers").replaceChildren(...Object.keys(train.controls).map((name) => this.lever(name)));
    at("no-levers").hidden = Object.keys(train.controls).length > 0;
  }

  notch(name) {
    const button = Object.assign(document.createElement("button"), { type: "button", textContent: name });
    button.addEventListener("click", () => this.act(name));
    return button;
  }

  lever(name) {
    const { whole, text, most } = INPUT[name], caps = DATA.controls[name]?.caps;
    const label = document.createElement("label"), slider = document.createElement("input"), value = document.createElement("output");
    Object.assign(slider, { id: `lever-${name}`, type: "range", min: 0, max: most, step: whole ? 1 : 5, value: 0, title: text });
    slider.addEventListener("input", () => this.act(name, Number(slider.value)));
    label.append(controlWord(name), " ");
    for (const cap of caps ? caps.split(" ") : []) label.append(Object.assign(document.createElement("kbd"), { textContent: cap }), " ");
    label.append(value, slider);
    return label;
  }

  show() {
    const { train } = this;
    for (const button of at("valve").children) button.setAttribute("aria-pressed", String(button.textContent === train.valve));
    for (const [name, value] of Object.entries(train.levers)) {
      const slider = at(`lever-${name}`);
      slider.value = value;
      slider.previousSibling.value = INPUT[name].whole ? INPUT[name].choices[value] : `${value} %`;
    }
  }

  key(event) {
    const { train } = this, { code, target } = event;
    if (!train || event.ctrlKey || event.metaKey || event.altKey || target.closest("select, [type=number]")) return;
    const [release, apply] = DATA.valveKeys, notches = Object.keys(train.notches);
    if (code === release || code === apply) {
      const next = notches.indexOf(train.valve) + (code === apply ? 1 : -1);
      if (next >= 0 && next < notches.length) this.act(notches[next]);
    } else if (code === "Backspace") this.act(train.notchOf(EMERGENCY));
    else this.move(code);
  }

  // Moves the lever of a key by a notch, or to its other value if it has one key.
  move(code) {
    const { train } = this;
    for (const [name, { less, more }] of Object.entries(DATA.controls)) {
      if (!(name in train.levers) || (code !== less && code !== more) || !code) continue;
      const { whole, most } = INPUT[name], before = train.levers[name];
      const value = less ? before + (code === more ? 1 : -1) * (whole ? 1 : NOTCH) : most - before;
      this.act(name, Math.max(0, Math.min(most, value)));
    }
  }
}
