// Common parts of all pages: elements by their names, packed data, colours, canvases.

const at = (name) => document.getElementById(name);

// Bytes from a text in base64, deflated (packed in frame.py).
async function unpacked(text) {
  const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  const plain = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Response(plain).arrayBuffer();
}

const DASHES = [[], [6, 3], [2, 2], [8, 3, 2, 3]]; // distinct without colours, too

// Colours of all drawings, in a light and in a dark surrounding, by their names in frame.css; changed: called when the
// surrounding changes.
const look = { changed() {} };
const night = matchMedia("(prefers-color-scheme: dark)");

function readLook() {
  const style = getComputedStyle(document.documentElement), [{ style: names }] = document.styleSheets[0].cssRules;
  for (const name of names) if (name.startsWith("--")) look[name.slice(2)] = style.getPropertyValue(name).trim();
  look.night = night.matches;
}

readLook();
night.addEventListener("change", () => { readLook(); look.changed(); });

// Names of the colours of `count` wheelsets.
function wheelColours(count) {
  const names = count > 2 ? ["first", "second", "third", "fourth"] : ["first", "fourth"];
  return Array.from({ length: count }, (_, number) => names[number % names.length]);
}

// A canvas with the resolution of the screen, in the units of the page; its context, width and height.
function sharp(canvas) {
  if (look.night !== night.matches) readLook();
  const scale = window.devicePixelRatio || 1, { clientWidth: width, clientHeight: height } = canvas;
  if (canvas.width !== Math.round(width * scale) || canvas.height !== Math.round(height * scale)) {
    canvas.width = Math.round(width * scale);
    canvas.height = Math.round(height * scale);
  }
  const context = canvas.getContext("2d", { willReadFrequently: true }); // drawn by the processor, without a GPU
  context.setTransform(scale, 0, 0, scale, 0, 0);
  context.clearRect(0, 0, width, height);
  context.font = "12px system-ui, sans-serif";
  return { context, width, height };
}

// A round step that divides a range into at most some parts.
function roundStep(range, parts) {
  const least = range / parts, power = 10 ** Math.floor(Math.log10(least));
  return power * [1, 2, 5, 10].find((factor) => factor * power >= least * (1 - 1e-9));
}
