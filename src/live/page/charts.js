// Charts of points and lines. One list of methods acts on all of them, and a point tells its numbers.

let charts = [];
const picked = { hidden: new Set(), names: [], lit: null };
const MARKS = ["circle", "square", "triangle", "diamond"];
const CHART_DASHES = [[], [6, 3], [2, 2], [8, 3, 2, 3]];

/** A series' look by its place among all names: a colour, and a mark and a dash for every seven. */
function lookOf(name) {
  const i = Math.max(0, picked.names.indexOf(name));
  const turn = Math.floor(i / colour.many.length) % MARKS.length;
  return { ink: colour.many[i % colour.many.length], mark: MARKS[turn], dash: CHART_DASHES[turn] };
}

function showCharts(told) {
  charts = told.map(newChart);
  const series = charts.flatMap((chart) => chart.series);
  picked.names = [...new Set(series.map(({ name }) => name))];
  picked.hidden.clear();
  picked.lit = null;
  setHidden(byId("charts"), !charts.length);
  byId("chart-list").replaceChildren(...charts.map(({ element }) => element));
  showPicks(series);
}

function newChart(told) {
  const axis = (side) => ({ label: text(record(side).label), log: Boolean(record(side).log) });
  const chart = { title: text(told.title), x: axis(told.x), y: axis(told.y), near: null, places: [] };
  const good = (x, log) => isNumber(x) && (!log || x > 0);
  chart.series = list(told.series).map(record).map((series) => ({
    name: text(series.name), group: text(series.group), line: Boolean(series.line),
    points: list(series.points).filter((p) => Array.isArray(p) && good(p[0], chart.x.log) && good(p[1], chart.y.log)),
  }));
  chart.canvas = make("canvas", { tabindex: "0", role: "img", "aria-label": `${chart.title}: arrow keys go from point to point` });
  chart.told = make("p", { class: "told", "aria-live": "polite" });
  const subtitle = text(told.subtitle);
  chart.element = make("section", { class: "panel chart", "data-chart": chart.title }, make("h2", { text: chart.title }), subtitle ? make("p", { class: "dim", text: subtitle }) : "", chart.canvas, chart.told);
  listenToChart(chart);
  return chart;
}

function showPicks(series) {
  const fieldset = byId("picks");
  const grouped = new Map();
  for (const { name, group } of series) {
    if (!grouped.has(group)) grouped.set(group, new Set());
    grouped.get(group).add(name);
  }
  const buttons = [["all", false], ["none", true]].map(([word, hidden]) => make("button", { type: "button", text: word, click: () => pickAll(hidden) }));
  const parts = [...grouped].map(([group, names]) => make("div", { class: "picks" }, group ? make("b", { text: group }) : "", ...[...names].map(newPick)));
  fieldset.replaceChildren(make("legend", { text: "Methods" }), make("div", { class: "picks" }, ...buttons), ...parts);
  setHidden(fieldset, picked.names.length < 2);
}

function newPick(name) {
  const change = (event) => {
    if (event.target.checked) picked.hidden.delete(name);
    else picked.hidden.add(name);
    drawCharts();
  };
  const box = make("input", { type: "checkbox", checked: true, "data-pick": name, change });
  const light = (lit) => () => lightUp(lit);
  return make("label", { pointerenter: light(name), pointerleave: light(null) }, box, make("canvas", { class: "mark", "data-mark": name, "aria-hidden": "true" }), make("span", { text: name }));
}

function pickAll(hidden) {
  picked.hidden = new Set(hidden ? picked.names : []);
  for (const box of byId("picks").querySelectorAll("input")) box.checked = !hidden;
  drawCharts();
}

function lightUp(name) {
  if (picked.lit === name) return;
  picked.lit = name;
  drawCharts();
}

function drawMark(g, [x, y], { ink, mark }, size) {
  g.fillStyle = ink;
  g.beginPath();
  if (mark === "circle") g.arc(x, y, size, 0, 7);
  else if (mark === "square") g.rect(x - size * 0.9, y - size * 0.9, size * 1.8, size * 1.8);
  else {
    const corners = mark === "triangle" ? [[0, -1.2], [1.1, 0.9], [-1.1, 0.9]] : [[0, -1.3], [1.3, 0], [0, 1.3], [-1.3, 0]];
    corners.forEach(([dx, dy], i) => (i ? g.lineTo(x + dx * size, y + dy * size) : g.moveTo(x + dx * size, y + dy * size)));
  }
  g.fill();
}

function drawCharts() {
  for (const canvas of document.querySelectorAll("canvas.mark")) {
    const room = surface(canvas);
    if (!room) continue;
    const look = lookOf(canvas.dataset.mark);
    Object.assign(room.g, { strokeStyle: look.ink, lineWidth: 1.5 });
    room.g.setLineDash(look.dash);
    path(room.g, [[0, room.height / 2], [room.width, room.height / 2]], false);
    room.g.stroke();
    drawMark(room.g, [room.width / 2, room.height / 2], look, 3.5);
  }
  for (const chart of charts) {
    const room = surface(chart.canvas);
    if (room) drawChart(room, chart);
  }
}

// The bounds are those of all series, so that a chart stays still while methods are picked.
function boundsOf(points, k, log) {
  const values = points.map((p) => p[k]);
  const [least, most] = [values.reduce((a, b) => Math.min(a, b), Infinity), values.reduce((a, b) => Math.max(a, b), -Infinity)];
  if (least > most) return log ? { low: 1, high: 10 } : { low: 0, high: 1 };
  if (!log) return padded(least, most);
  const room = Math.max(1.3, (most / least) ** 0.04);
  return { low: Math.max(least / room, 1e-300), high: Math.min(most * room, 1e300) };
}

function drawChart({ g, width, height }, chart) {
  const box = { left: 58, right: width - 10, top: 8, bottom: height - 34 };
  const points = chart.series.flatMap((series) => series.points);
  const [bx, by] = [boundsOf(points, 0, chart.x.log), boundsOf(points, 1, chart.y.log)];
  const x = scale(bx.low, bx.high, box.left, box.right, chart.x.log);
  const y = scale(by.low, by.high, box.bottom, box.top, chart.y.log);
  frame(g, box, x, y, { xCount: width / 60, yCount: height / 32 });
  g.fillStyle = colour.dim;
  g.textAlign = "center";
  g.fillText(chart.x.label, (box.left + box.right) / 2, height - 8);
  g.save();
  g.translate(8, (box.top + box.bottom) / 2);
  g.rotate(-Math.PI / 2);
  g.fillText(chart.y.label, 0, 0);
  g.restore();
  const seen = chart.series.filter(({ name }) => !picked.hidden.has(name));
  const lit = chart.near && seen.includes(chart.near.series) ? chart.near.series.name : picked.lit;
  seen.sort((a, b) => (a.name === lit) - (b.name === lit));
  chart.places = seen.flatMap((series) => series.points.map((point) => ({ series, point, at: [x(point[0]), y(point[1])] })));
  for (const series of seen) drawSeries(g, chart, series, lit);
  if (chart.near) drawNear(g, chart);
}

function drawSeries(g, chart, series, lit) {
  const look = lookOf(series.name);
  const at = chart.places.filter((place) => place.series === series).map((place) => place.at);
  g.globalAlpha = lit === null || series.name === lit ? 1 : 0.15;
  if (series.line) {
    Object.assign(g, { strokeStyle: look.ink, lineWidth: series.name === lit ? 3 : 1.5 });
    g.setLineDash(look.dash);
    path(g, at, false);
    g.stroke();
    g.setLineDash([]);
  }
  const size = at.length > 60 && series.line ? 0 : series.name === lit ? 4.5 : 3;
  if (size) for (const place of at) drawMark(g, place, look, size);
  g.globalAlpha = 1;
}

function drawNear(g, chart) {
  const place = chart.places.find(({ series, point }) => series === chart.near.series && point === chart.near.point);
  if (!place) return;
  Object.assign(g, { strokeStyle: colour.fg, lineWidth: 2 });
  g.beginPath();
  g.arc(place.at[0], place.at[1], 7, 0, 7);
  g.stroke();
}

function tellPoint(chart, near) {
  if (chart.near === near) return;
  chart.near = near;
  const axis = ({ label: word }, value) => `${word || "value"} ${significant(value)}`;
  const words = near ? [near.series.name, near.point[2], axis(chart.x, near.point[0]), axis(chart.y, near.point[1])].map(text).filter(Boolean).join(" · ") : "";
  setText(chart.told, words);
  picked.lit = near ? near.series.name : null;
  drawCharts();
}

function listenToChart(chart) {
  chart.canvas.addEventListener("pointermove", (event) => {
    const distance = ({ at }) => Math.hypot(at[0] - event.offsetX, at[1] - event.offsetY);
    const near = chart.places.reduce((best, place) => (distance(place) < (best ? distance(best) : 30) ? place : best), null);
    if (near?.point !== chart.near?.point) tellPoint(chart, near);
  });
  chart.canvas.addEventListener("pointerleave", (event) => event.pointerType === "mouse" && tellPoint(chart, null));
  chart.canvas.addEventListener("blur", () => tellPoint(chart, null));
  chart.canvas.addEventListener("keydown", (event) => {
    const way = { ArrowRight: [0, 1], ArrowLeft: [0, -1], ArrowDown: [1, 0], ArrowUp: [-1, 0] }[event.key];
    if (!way) return;
    event.preventDefault();
    event.stopPropagation();
    tellPoint(chart, nextPoint(chart, way));
  });
}

// The point `along` its series, or at the same place in the next series.
function nextPoint(chart, [series, along]) {
  const seen = chart.series.filter(({ name, points }) => points.length && !picked.hidden.has(name));
  if (!seen.length) return null;
  const here = seen.indexOf(chart.near?.series);
  const there = seen[here < 0 ? 0 : (here + series + seen.length) % seen.length];
  const i = here < 0 ? 0 : chart.near.series.points.indexOf(chart.near.point) + along;
  return { series: there, point: there.points[clamp(i, 0, there.points.length - 1)] };
}
