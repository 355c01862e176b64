// A run as the address of the page: its settings and its actions, `friction=0.08&do=100:lever:100`.

const DONE_LATER = ["lever", "friction", "protection", "uneven", "leaves"]; // controls that act while a run goes

// The settings and the plan of a link, without its #; messages: on invalid parts. The page's controls define
// the valid values.
function readLink(text) {
  const settings = { ...DATA.defaults }, messages = [];
  let plan = [];
  for (const [name, value] of new URLSearchParams(text)) {
    if (name === "embed") continue;
    if (name === "do") plan = readPlan(value, messages);
    else if (!(name in settings)) messages.push(`The link has "${name}", which this page does not know; it is left out.`);
    else if (takes(name, value)) settings[name] = value;
    else messages.push(`The link has ${name} ${value}; this page takes ${taken(name)}, and starts with ${settings[name]}.`);
  }
  return { settings, plan, messages };
}

function readPlan(text, messages) {
  const plan = [];
  for (const one of text.split(",").filter(Boolean)) {
    const [step, name, value] = one.split(":");
    const known = DONE_LATER.includes(name) && /^\d{1,6}$/.test(step) && (name === "leaves" || takes(name, value));
    if (known) plan.push([Number(step), name, inside(name, value)]);
    else messages.push(`The link does "${one}", which is no step:control:value of this page; it is left out.`);
  }
  return plan.sort(([a], [b]) => a - b);
}

// A control's value in the unit of the simulation.
function inside(name, value) {
  if (name === "protection") return value === true || value === "1";
  return Number(value) / ({ lever: 100, uneven: 100, gradient: 1000 }[name] ?? 1);
}

// The link of a run: settings that differ from the page's defaults, and the actions.
function writeLink(settings, done) {
  const words = new URLSearchParams();
  for (const [name, value] of Object.entries(settings))
    if (String(value) !== String(DATA.defaults[name])) words.set(name, value);
  const outside = ([step, name, value]) => `${step}:${name}:${name === "lever" || name === "uneven" ? +(100 * value).toFixed(6) : Number(value)}`;
  if (done.length) words.set("do", done.map(outside).join(","));
  return `#${decodeURIComponent(words.toString())}`;
}
