// Colours of everything that is drawn, in a light and in a dark surrounding: those of the style sheet.

const DASHES = [[], [6, 3], [2, 2], [8, 3, 2, 3]]; // told apart without colours, too

const look = { read: false };

// Reads the colours again; called when the surrounding changes.
function readLook() {
  const style = getComputedStyle(document.documentElement);
  for (const name of ["ink", "soft", "grid", "paper", "steel", "rail", "ground", "car", "frame", "signal", "leaf", "pipe", "edge", "window", "first", "second", "third", "fourth"])
    look[name] = style.getPropertyValue(`--${name}`).trim();
}

readLook();
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => { readLook(); look.changed?.(); });
