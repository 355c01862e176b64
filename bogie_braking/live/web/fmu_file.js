// The train in a TrainDynamics.fmu: one file of the archive has its numbers (APPNOTE.TXT of PKWARE; sizes in 32 bits).

const LARGEST_FILE = 2 ** 26; // of a train's numbers [bytes]
const END = 0x06054b50, ENTRY = 0x02014b50, END_LENGTH = 22; // signatures; [bytes]
const NUMBERS = "resources/train.bin", DESCRIPTION = "modelDescription.xml";

// Yields name, method, sizes and place of each file of an archive.
function* filesOf(view) {
  let end = view.byteLength - END_LENGTH;
  while (end >= 0 && view.getUint32(end, true) !== END) end -= 1;
  if (end < 0) throw new Error("It is not an archive.");
  for (let place = view.getUint32(end + 16, true); view.getUint32(place, true) === ENTRY;) {
    const [nameLength, extra, comment] = [28, 30, 32].map((offset) => view.getUint16(place + offset, true));
    const name = new TextDecoder().decode(new Uint8Array(view.buffer, place + 46, nameLength));
    yield { name, method: view.getUint16(place + 10, true), packed: view.getUint32(place + 20, true), size: view.getUint32(place + 24, true), place: view.getUint32(place + 42, true) };
    place += 46 + nameLength + extra + comment;
  }
}

async function contentOf(view, { method, packed: length, size, place }) {
  if (size > LARGEST_FILE) throw new Error(`Its numbers must have at most ${LARGEST_FILE} bytes; got ${size}.`);
  const begin = place + 30 + view.getUint16(place + 26, true) + view.getUint16(place + 28, true);
  const bytes = new Blob([new Uint8Array(view.buffer, begin, length)]);
  return new Response(method === 0 ? bytes : bytes.stream().pipeThrough(new DecompressionStream("deflate-raw"))).arrayBuffer();
}

// Returns the consist of a file that a user opens or drops. Raises Error with a message.
async function consistOfFile(file) {
  if (!file.name.toLowerCase().endsWith(".fmu")) {
    const command = `python -m bogie_braking live --consist ${file.name}`;
    throw new Error(`Only Python reads consists. Run "${command}", and open the page that it writes.`);
  }
  const view = new DataView(await file.arrayBuffer()), files = Object.fromEntries([...filesOf(view)].map((one) => [one.name, one]));
  if (!files[NUMBERS] || !files[DESCRIPTION]) throw new Error("It must be a TrainDynamics.fmu. Build one: bogie-braking build train --consist FILE.");
  const description = new DOMParser().parseFromString(new TextDecoder().decode(await contentOf(view, files[DESCRIPTION])), "text/xml").documentElement;
  const version = description.getAttribute("version");
  if (version !== DATA.version) throw new Error(`It must be of version ${DATA.version}; got ${version}. Build it again.`);
  return new Consist(new Float64Array(await contentOf(view, files[NUMBERS])), { name: description.getAttribute("modelName") || file.name });
}
