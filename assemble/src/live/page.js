// The page. Input: news and fields from the program, and the choices of the user. Output: the display, and requests to stop.

import { COLOURS, LIGHT, RAMP, Stage } from "./scene.js";
import { Curve } from "./curve.js";
import { Color } from "./three.module.min.js";

const at = (id) => document.getElementById(id);
const stage = new Stage(at("scene"));
const curve = new Curve(at("curve"));

// The field of each view, and its display.
const VIEWS = {
  radiosity: { field: "radiosity", kind: LIGHT },
  irradiance: { field: "irradiance", kind: LIGHT },
  elements: { kind: COLOURS },
  parts: { kind: COLOURS },
  "row-sums": { field: "row-sums", kind: RAMP, range: [-9, 0], ramp: ["#20344f", "#2c6f85", "#58a37a", "#d3bd59", "#f7ecc8"] },
  computed: { field: "computed", kind: RAMP, range: [-3, 0], ramp: ["#6d4a2a", "#96632f", "#c07f3a", "#e29f50", "#ffd08a"] },
};
// Colour of elements without a value in a view.
const NOTHING = "#4a5361";
const MOST_ROWS = 300;

let status = { run: 0, placed: 0, parts: [], instances: [] };
let points = [];
let now = null;
let steps = [];
let view = "radiosity";
let automatic = 1; // the program's exposure
let held = null; // the exposure that the user keeps
let change = new AbortController(); // cancels a request that is no longer needed
const wake = new EventTarget();

// News

const source = new EventSource("events");
source.onmessage = (event) => {
  const news = JSON.parse(event.data);
  at("lost").hidden = true;
  if (news.status) {
    if (news.status.run !== status.run) points = [];
    status = news.status;
  }
  points.push(...news.points);
  [now, steps] = [news.now, news.steps];
  show(news);
};
source.onerror = () => {
  at("lost").hidden = false;
  at("stop").disabled = true;
};

const PHASES = {
  reading: (what) => what || "reading the scene",
  baking: (what) => what || "form factors of parts",
  coupling: (what) => what || "form factors between parts",
  exchange: () => (status.stopping ? "ending after this round" : "exchanging light"),
  writing: (what) => (what && what !== "exchange" ? `writing: ${what}` : "writing outputs"),
  done: () => (status.converged ? "done: the required error is proved" : "done: ended before the required error was proved"),
  failed: () => "failed",
};

function show({ status: isNew, stage: [what, done, total] }) {
  const over = status.phase === "done" || status.phase === "failed";
  at("phase").textContent = PHASES[status.phase](what) + (over && status.watched ? "; waiting for a file to change" : "");
  const bar = at("progress");
  bar.hidden = over || !total;
  if (total) bar.value = done / total;
  at("round").textContent = now ? (now.group > 1 ? `${now.round} of group ${now.group}` : now.round) : "–";
  at("seconds").textContent = now ? now.seconds.toPrecision(3) : "–";
  at("bound").textContent = now ? number(now.bound) : "–";
  at("relative").textContent = now ? number(now.relative) : "–";
  curve.set(points, now);
  showSteps();
  if (!isNew) return;
  document.title = status.scene ? `${status.scene} – Equilux` : "Equilux";
  at("name").textContent = status.scene || "\u00a0";
  at("stop").disabled = status.phase !== "exchange" || status.stopping;
  at("stop").hidden = over;
  at("close").hidden = !over;
  at("close").textContent = status.watched ? "Stop watching" : "Close";
  at("hint").textContent = over
    ? "Ends the program; written files remain."
    : "Ends after the current round; all outputs are written.";
  at("error").hidden = !status.error;
  at("error").textContent = status.error ?? "";
  showParts();
  at("written").hidden = !status.outputs.length;
  at("outputs").replaceChildren(...[...status.outputs, ...status.notes.map((note) => `note: ${note}`)].map((line) => made("li", line)));
  if (view === "parts") showPartColours();
  wake.dispatchEvent(new Event("news"));
}

function number(value) {
  return value === null || !isFinite(value) ? "unknown" : value === 0 ? "0" : value.toExponential(2);
}

function made(name, text = "", kind = "") {
  const element = document.createElement(name);
  element.textContent = text;
  element.className = kind;
  return element;
}

const WORDS = { waiting: "…", reused: "reused", computed: "computed" };

function showParts() {
  at("count").textContent = status.elements ? `${status.instances.length}, ${status.elements.toLocaleString("en")} elements` : "";
  const rows = status.instances.slice(0, MOST_ROWS).map((instance) => {
    const part = status.parts[instance.part];
    const [row, name] = [made("tr"), made("td")];
    const swatch = made("span", "", "swatch");
    swatch.style.background = colourOf(instance.part).getStyle();
    name.append(swatch, instance.name);
    name.title = `part ${part.name}, ${part.elements} elements`;
    const own = made("td", instance.inside ? `${WORDS[instance.inside]}, cut` : WORDS[part.own], instance.inside ?? part.own);
    own.title = instance.inside ? "another part is inside this part" : part.reason;
    const coupling = made("td", WORDS[instance.coupling], instance.coupling);
    coupling.title = instance.reason;
    row.append(name, own, coupling);
    return row;
  });
  if (status.instances.length > MOST_ROWS) rows.push(made("tr", `and ${status.instances.length - MOST_ROWS} more`));
  at("parts").replaceChildren(...rows);
}

// The paper's steps; 1 is the first instance, 2 are all others.
const STEPS = [
  ["F₁₁", "form factors inside the first part"], ["F₂₂", "form factors inside the others"],
  ["F₁₂", "form factors from the others to the first"], ["F₂₁", "form factors to the others"],
  ["solve 1", "equilibrium in the first"], ["solve 2", "equilibrium in the others"],
  ["1 → 2", "transfer to the others"], ["2 → 1", "transfer to the first"],
];

function showSteps() {
  const seconds = STEPS.map((_, i) => status.seconds?.[`step${i + 1}`] ?? 0);
  if (status.phase === "exchange") steps.forEach((time, i) => (seconds[4 + i] = time));
  const isKnown = !["reading", "baking", "coupling", undefined].includes(status.phase);
  const rows = STEPS.map(([name, meaning], i) => {
    const row = made("li");
    row.title = meaning;
    row.append(made("span", `${i + 1}  ${name}`, "quiet"), made("output", isKnown ? seconds[i].toFixed(3) : "–"));
    return row;
  });
  at("steps").replaceChildren(...rows);
}

// Colours

// Distinct colours for consecutive numbers: steps of the golden angle around the hues.
function colourOf(part) {
  return new Color().setHSL((0.58 + 0.381966 * part) % 1, 0.42, 0.5 + 0.09 * ((part % 3) - 1));
}

function showPartColours() {
  const of = status.instances.map((instance) => colourOf(instance.part).toArray());
  const grey = [0.3, 0.3, 0.3];
  showColours((instance) => of[instance] ?? grey);
}

function showColours(of) {
  if (!stage.instances) return;
  const values = new Float32Array(3 * stage.instances.length);
  stage.instances.forEach((instance, i) => values.set(of(instance), 3 * i));
  stage.show(values, 3, COLOURS);
}

// Fields: the next is requested after the last has been drawn, so a slow page skips rounds.

const nextFrame = () => new Promise((done) => requestAnimationFrame(done));
const news = () => new Promise((done) => wake.addEventListener("news", done, { once: true }));

async function follow() {
  let shown = { view: null, number: 0 };
  for (;;) {
    try {
      if (status.placed && stage.head?.run !== status.placed) {
        await load();
        shown = { view: null, number: 0 };
      }
      if (!stage.head) {
        await news();
        continue;
      }
      if (shown.view !== view) {
        shown = { view, number: 0 };
        begin();
      }
      const { field, kind } = VIEWS[view];
      if (!field) {
        await Promise.race([news(), new Promise((done) => change.signal.addEventListener("abort", done))]);
        continue;
      }
      const response = await fetch(`field/${field}?after=${shown.number}`, { signal: change.signal });
      if (response.status === 200) shown.number = received(await response.arrayBuffer(), kind, shown.number);
      else if (response.status !== 204) await news();
      await nextFrame();
    } catch (error) {
      // Another view was chosen, or the program has ended, as the news will report.
      if (error.name !== "AbortError") await Promise.race([news(), new Promise((done) => setTimeout(done, 1000))]);
    }
  }
}

async function load() {
  const response = await fetch("model");
  if (response.status !== 200) return;
  stage.load(await response.arrayBuffer());
  // Until light is available.
  showColours(() => [0.2, 0.2, 0.2]);
}

function begin() {
  const { ramp, range } = VIEWS[view];
  if (ramp) stage.setRamp(ramp, NOTHING, range);
  else stage.setRamp(Array(5).fill(NOTHING), "#2a2b33", [-3, 0]);
  setLines();
  if (view === "elements") showColours(() => [0.62, 0.62, 0.62]);
  if (view === "parts") showPartColours();
  showLegend();
  showRound();
}

// Show a snapshot, unless it belongs to the model of another run. Returns its version.
function received(buffer, kind, before) {
  const head = new DataView(buffer);
  const [run, number, round] = [0, 4, 8].map((offset) => head.getUint32(offset, true));
  if (run !== stage.head.run) return before;
  const stride = head.getUint32(16, true);
  if (kind === LIGHT) {
    automatic = head.getFloat32(12, true);
    expose();
  }
  stage.show(new Float32Array(buffer, 20), stride, kind);
  showRound(kind === LIGHT ? round : null);
  return number;
}

function showRound(round = null) {
  at("shown").textContent = round === null ? "" : round === 0 ? "before the first round" : `after round ${round}`;
  if (round !== null) stage.canvas.dataset.round = round;
}

const power = (exponent) => (Math.abs(exponent) <= 2 ? String(Number((10 ** exponent).toPrecision(1))) : `1e${exponent}`);

function showLegend() {
  const { ramp, range } = VIEWS[view];
  const legend = at("legend");
  legend.replaceChildren();
  const say = (text, colour) => {
    const line = made("p");
    if (colour) {
      const swatch = made("span", "", "swatch");
      swatch.style.background = colour;
      line.append(swatch);
    }
    line.append(text);
    legend.append(line);
  };
  if (view === "row-sums") say("How far the form factors of an element are from summing to 1; in a closed scene not at all");
  if (view === "computed") say("Share of an element’s form factors that this run computed");
  if (ramp) {
    const [bar, ends] = [made("span", "", "bar"), made("span", "", "ends")];
    bar.style.background = `linear-gradient(to right, ${ramp.join(", ")})`;
    ends.append(made("span", power(range[0])), made("span", power(range[1])));
    legend.append(bar, ends);
    say(view === "computed" ? "none: all reused" : "exactly 1", NOTHING);
  }
  if (view === "irradiance" && status.phase === "exchange") say("black surfaces: known at the end", "#2a2b33");
  if (view === "parts") say("One colour for each part, shared by its instances");
}

// Choices of the user

function expose() {
  stage.exposure = (held ?? automatic) * 2 ** at("stops").value;
}

function setLines() {
  stage.lines = view === "elements" ? 1 : at("edges").checked ? 0.6 : 0;
}

at("stops").addEventListener("input", () => {
  const stops = Number(at("stops").value);
  at("stops-text").textContent = stops === 0 ? "±0 stops" : `${stops > 0 ? "+" : "−"}${Math.abs(stops).toFixed(1)} stops`;
  expose();
});
at("stops").addEventListener("dblclick", () => {
  at("stops").value = 0;
  at("stops").dispatchEvent(new Event("input"));
});
at("hold").addEventListener("change", () => {
  held = at("hold").checked ? automatic : null;
  expose();
});
at("edges").addEventListener("change", setLines);
for (const choice of document.querySelectorAll("input[name=view]")) {
  choice.addEventListener("change", () => {
    view = choice.value;
    change.abort();
    change = new AbortController();
  });
}
at("stop").addEventListener("click", () => {
  at("stop").disabled = true;
  fetch("stop", { method: "POST" });
});
at("close").addEventListener("click", () => fetch("close", { method: "POST" }));

// A browser may restore an earlier choice.
view = document.querySelector("input[name=view]:checked").value;
follow();
