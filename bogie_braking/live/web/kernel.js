// The kernel of the FMUs, compiled to WebAssembly: variables by name, steps, messages.

const WARNING = 1; // kernel.h: from 2 on a call was refused or failed

// Unpacks and compiles a module; every kernel of it shares its code.
async function loadModule(packed) {
  return WebAssembly.compile(await unpacked(packed));
}

class SimulationError extends Error {}

class Kernel {
  static async create(module, names) {
    const file = new OneFile(), system = file.system(() => exports.memory);
    const { exports } = await WebAssembly.instantiate(module, { wasi_snapshot_preview1: system });
    exports._initialize();
    return new Kernel(exports, names, file);
  }

  constructor(exports, names, file) {
    Object.assign(this, { exports, file });
    this.places = new Map(names.map((name, place) => [name, place]));
    this.self = exports.kernel_create();
    this.room = exports.malloc(8);
    this.path = exports.malloc(PLACE.length + 1);
    new TextEncoder().encodeInto(`${PLACE}\0`, new Uint8Array(exports.memory.buffer, this.path, PLACE.length + 1));
  }

  set(values) {
    for (const [name, value] of Object.entries(values))
      this.check(this.exports.kernel_set(this.self, this.places.get(name), value));
  }

  get(name) {
    this.check(this.exports.kernel_get(this.self, this.places.get(name), this.room));
    return this.memory.getFloat64(this.room, true);
  }

  get memory() {
    const { buffer } = this.exports.memory; // a new one after the memory has grown
    if (this.numbers?.buffer !== buffer) this.numbers = new DataView(buffer);
    return this.numbers;
  }

  // Resets to the start values, then sets some others and initialises; texts: contents of files, by the variable that
  // names the file.
  start(values, texts = {}) {
    this.exports.kernel_reset(this.self);
    this.set(values);
    for (const [name, text] of Object.entries(texts)) {
      this.file.write(text);
      this.check(this.exports.kernel_set_text(this.self, this.places.get(name), this.path));
    }
    this.check(this.exports.kernel_initialise(this.self, 0));
  }

  step(time, size) {
    this.check(this.exports.kernel_step(this.self, time, size));
  }

  // Messages since the last call.
  messages() {
    const messages = [];
    while (this.exports.kernel_hear(this.self, this.room)) {
      const place = this.memory.getUint32(this.room + 4, true); // after the status
      const bytes = new Uint8Array(this.exports.memory.buffer, place);
      messages.push(new TextDecoder().decode(bytes.slice(0, bytes.indexOf(0))));
    }
    return messages;
  }

  check(status) {
    if (status > WARNING) throw new SimulationError(this.messages().at(-1) ?? `The kernel answered ${status}.`);
  }
}
