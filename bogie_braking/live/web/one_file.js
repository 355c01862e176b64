// System calls of WebAssembly for reading one file (WASI preview 1): a kernel reads its line by them.

const PLACE = "/line.csv"; // of the file
const ROOM = 3, FILE = 4; // descriptors: the folder that is open from the start, and the file in it
const DONE = 0, NO_SUCH_DESCRIPTOR = 8, NO_SUCH_FILE = 44; // errno of WASI
const IS_FOLDER = 3, IS_FILE = 4;

class OneFile {
  constructor() {
    this.bytes = new Uint8Array(0);
    this.position = 0;
  }

  // text: contents of the file from now on.
  write(text) {
    this.bytes = new TextEncoder().encode(text);
  }

  // The functions for a module; memory: a function that returns its memory, which grows. Other functions return an
  // error.
  system(memory) {
    const view = () => new DataView(memory().buffer);
    const own = {
      fd_prestat_get: (descriptor, about) => {
        if (descriptor !== ROOM) return NO_SUCH_DESCRIPTOR;
        view().setUint8(about, 0);
        view().setUint32(about + 4, 1, true);
        return DONE;
      },
      fd_prestat_dir_name: (_, path) => {
        view().setUint8(path, "/".charCodeAt(0));
        return DONE;
      },
      path_open: (room, flags, path, length, more, rights, inherited, status, opened) => {
        const name = new TextDecoder().decode(new Uint8Array(memory().buffer, path, length));
        if (`/${name}` !== PLACE) return NO_SUCH_FILE;
        this.position = 0;
        view().setUint32(opened, FILE, true);
        return DONE;
      },
      fd_fdstat_get: (descriptor, about) => {
        if (descriptor !== ROOM && descriptor !== FILE) return NO_SUCH_DESCRIPTOR;
        new Uint8Array(memory().buffer, about, 24).fill(0);
        view().setUint8(about, descriptor === ROOM ? IS_FOLDER : IS_FILE);
        view().setBigUint64(about + 8, -1n, true); // all rights
        view().setBigUint64(about + 16, -1n, true);
        return DONE;
      },
      fd_read: (descriptor, parts, count, read) => {
        if (descriptor !== FILE) return NO_SUCH_DESCRIPTOR;
        let total = 0;
        for (let part = 0; part < count; part += 1) {
          const place = view().getUint32(parts + 8 * part, true), room = view().getUint32(parts + 8 * part + 4, true);
          const piece = this.bytes.subarray(this.position, this.position + room);
          new Uint8Array(memory().buffer, place, piece.length).set(piece);
          this.position += piece.length;
          total += piece.length;
        }
        view().setUint32(read, total, true);
        return DONE;
      },
      fd_close: () => DONE,
    };
    return new Proxy({}, { get: (_, name) => own[name] ?? (() => NO_SUCH_DESCRIPTOR) });
  }
}
