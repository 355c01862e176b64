// The sensors of the wheels and the wheel-slide protection: C linked with the kernel (brake_controller/rig/).

const APPLY = 0, VENT = 2; // of wheel_slide.h

class SlideProtection {
  // sensor: of page.py; radii: of the wheels [m].
  constructor(kernel, sensor, radii) {
    const { exports } = kernel, size = exports.wheel_slide_size(radii.length);
    Object.assign(this, { kernel, exports, sensor, radii, size });
    this.memory = exports.malloc(size);
    this.settings = exports.malloc(32); // an encoder_settings
    this.sensors = radii.map(() => exports.malloc(exports.encoder_size()));
    this.speeds = exports.malloc(8 * radii.length);
    this.valves = exports.malloc(4 * radii.length);
  }

  // Resets to the first sample; period: sampling interval [s].
  begin(period) {
    const { memory } = this.kernel, { pulses, gate, resolution, lowest_frequency } = this.sensor;
    memory.setInt32(this.settings, pulses, true);
    [gate, resolution, lowest_frequency].forEach((one, i) => memory.setFloat64(this.settings + 8 + 8 * i, one, true));
    this.sensors.forEach((one) => this.exports.encoder_begin(one, 0, 0));
    new Uint8Array(memory.buffer, this.memory, this.size).fill(0);
    this.exports.wheel_slide_start(this.memory, this.radii.length, period);
  }

  // Valve commands at a time [s] from the rotations of the wheels [rad].
  step(time, rotations) {
    const { exports, radii } = this, { memory } = this.kernel;
    const omegas = rotations.map((rotation, i) => exports.encoder_read(this.sensors[i], this.settings, time, rotation));
    omegas.forEach((omega, i) => memory.setFloat64(this.speeds + 8 * i, radii[i] * omega, true));
    exports.wheel_slide_step(this.memory, time, this.speeds, this.valves);
    return radii.map((_, i) => memory.getInt32(this.valves + 4 * i, true));
  }
}
