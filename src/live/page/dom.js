// Elements, canvases and colours. Text from outside is only ever put in as text.

const byId = (id) => document.getElementById(id);

/** An element with attributes; `text` is its text, and a function listens. */
function make(tag, attributes = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (value === null || value === undefined || value === false) continue;
    if (name === "text") element.textContent = value;
    else if (typeof value === "function") element.addEventListener(name, value);
    else element.setAttribute(name, value === true ? "" : value);
  }
  element.append(...children);
  return element;
}

function setText(element, text) {
  if (element.textContent !== text) element.textContent = text;
}

/** A number for people, with the number as it is beside it for programs. */
function setNumber(element, text, value) {
  setText(element, text);
  const raw = isNumber(value) ? String(value) : "";
  if (element.dataset.value !== raw) element.dataset.value = raw;
}

function setHidden(element, hidden) {
  if (element.hidden !== hidden) element.hidden = hidden;
}

function setOptions(select, names) {
  select.replaceChildren(...names.map(([value, text]) => make("option", { value, text })));
}

// Colours by Okabe and Ito, which all can tell apart; the style has them for light and for dark.
const colour = {};
const axisDashes = [[9, 4], [4, 3], [1.5, 2.5]];

function readColours() {
  const style = getComputedStyle(document.documentElement);
  for (const name of ["panel", "fg", "dim", "line", "x", "y", "z", "truth", "estimate", "bar", "cursor"]) {
    colour[name] = style.getPropertyValue(`--${name}`).trim();
  }
  colour.axes = [colour.x, colour.y, colour.z];
  colour.many = ["a", "b", "c", "d", "e", "f", "g"].map((name) => style.getPropertyValue(`--many-${name}`).trim());
}

/** A canvas ready to draw on in CSS pixels, or null where it has no size, or is out of sight while all moves. */
function surface(canvas) {
  const place = canvas.getBoundingClientRect();
  const width = Math.round(place.width);
  const height = Math.round(place.height);
  const away = place.bottom < -50 || place.top > innerHeight + 50;
  if (!width || !height || (away && isMoving())) return null;
  const ratio = devicePixelRatio || 1;
  const size = [Math.round(width * ratio), Math.round(height * ratio)];
  if (canvas.width !== size[0]) canvas.width = size[0];
  if (canvas.height !== size[1]) canvas.height = size[1];
  const g = canvas.getContext("2d");
  g.setTransform(ratio, 0, 0, ratio, 0, 0);
  g.clearRect(0, 0, width, height);
  g.font = "11px system-ui, sans-serif";
  g.textBaseline = "middle";
  g.lineJoin = "round";
  return { g, width, height };
}

const described = new WeakMap();

/** What a canvas shows, in words, at most once a second. */
function describe(canvas, text) {
  const now = performance.now();
  if (now - (described.get(canvas) ?? -1e9) < 1000) return;
  described.set(canvas, now);
  if (canvas.getAttribute("aria-label") !== text) canvas.setAttribute("aria-label", text);
}

// Each panel says whether it has something to show, builds itself when a scene begins, and draws.
const panels = [];

function panel(id, { present, build, draw }) {
  panels.push({ element: byId(id), present, build, draw });
}
