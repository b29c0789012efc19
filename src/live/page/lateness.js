// How late packets leave: the counts since the start, and p50, p99 and the greatest over time. All of it is in µs.

const LATE = ["p50", "p99", "max"];
const LATE_DASHES = [[], [5, 3], [2, 2]];
const lateSensors = () => store.sensors.filter((_, i) => view.lateOf < 0 || i === view.lateOf);

panel("lateness", {
  present: () => Boolean(store.histogram?.counts.length) || store.sensors.some(({ lateness }) => lateness.length),
  build() {
    setOptions(byId("late-of"), [[-1, "worst of all"], ...store.sensors.map(({ name }, i) => [i, name])]);
    const number = (name, k) => make("span", {}, make("i", { class: `swatch line-${k}` }), `${name} `, make("b", { "data-late": name }));
    byId("late-numbers").replaceChildren(...LATE.map(number));
  },
  draw(shown) {
    const worst = LATE.map((_, k) => worstAt(k, shown.t));
    LATE.forEach((name, k) => setNumber(byId("late-numbers").querySelector(`[data-late=${name}]`), microsecondsText(worst[k]), worst[k]));
    const words = LATE.map((name, k) => `${name} ${microsecondsText(worst[k])}`).join(", ");
    const histogram = byId("late-histogram");
    const counts = histogramCounts();
    setHidden(histogram, !counts);
    const room = counts && surface(histogram);
    if (room) drawHistogram(room, counts);
    describe(histogram, `Lateness: counts since the start, by µs. ${words}`);
    const over = byId("late-history");
    setHidden(over, !lateSensors().some(({ lateness }) => lateness.length));
    const roomOver = surface(over);
    if (roomOver) drawLateHistory(roomOver, shown);
    describe(over, `Lateness over time. ${words}`);
  },
});

function worstAt(k, t) {
  const values = lateSensors().map(({ lateness }) => lateness.value(k, t)).filter(isNumber);
  return values.length ? Math.max(...values) : NaN;
}

function histogramCounts() {
  if (!store.histogram) return null;
  const { edges, counts } = store.histogram;
  const chosen = counts.filter(({ of }) => view.lateOf < 0 || of === view.lateOf);
  const total = edges.slice(1).map((_, i) => chosen.reduce((sum, { n }) => sum + (isNumber(n[i]) ? n[i] : 0), 0));
  const first = total.findIndex((n) => n > 0);
  if (first < 0) return null;
  const last = total.findLastIndex((n) => n > 0);
  return { edges, total, first, last };
}

// Both axes go by decades: the tail of a few late ones is what matters.
function drawHistogram({ g, width, height }, { edges, total, first, last }) {
  const box = { left: 44, right: width - 8, top: 6, bottom: height - 16 };
  const low = Math.max(edges[first], edges[first + 1] / 10, 1e-4);
  const x = scale(Math.min(low, 0.1), Math.max(edges[last + 1], 1000), box.left, box.right, true);
  const y = scale(0.5, Math.max(...total) * 1.5, box.bottom, box.top, true);
  frame(g, box, x, y, { xCount: width / 40, yCount: height / 24 });
  g.fillStyle = colour.bar;
  clipped(g, box, () => {
    for (let i = first; i <= last; i++) {
      if (!total[i]) continue;
      const from = x(Math.max(edges[i], low));
      g.fillRect(from, y(total[i]), Math.max(1, x(edges[i + 1]) - from - (x(edges[i + 1]) - from > 4 ? 1 : 0)), box.bottom - y(total[i]));
    }
  });
  note(g, box, "count by µs late");
}

function note(g, box, words) {
  g.textAlign = "right";
  g.fillStyle = colour.dim;
  over(g, words, box.right - 2, box.top + 6);
}

function drawLateHistory({ g, width, height }, { range, t }) {
  const box = { left: 44, right: width - 8, top: 6, bottom: height - 16 };
  const x = scale(range.from, range.to, box.left, box.right);
  const lines = LATE.map((_, k) => worstOver(k, range, x, box));
  const values = lines.flat(2).map(([, value]) => value);
  const least = values.reduce((a, b) => Math.min(a, b), Infinity);
  if (least === Infinity) return;
  const most = values.reduce((a, b) => Math.max(a, b), 0);
  const y = scale(10 ** Math.floor(Math.log10(least)), 10 ** Math.ceil(Math.log10(most * 1.01)), box.bottom, box.top, true);
  frame(g, box, x, y, { xUnit: " s", xCount: width / 70, yCount: height / 24 });
  clipped(g, box, () => lines.forEach((found, k) => band(g, found, y, { stroke: colour.many[k], width: 1.5, dash: LATE_DASHES[k] })));
  note(g, box, "µs over time");
  cursor(g, box, x(t));
  goToByPointer(g.canvas, x);
}

// The greatest of the sensors in every few pixels, as one line with gaps.
function worstOver(k, range, x, box) {
  const all = lateSensors().flatMap(({ lateness }) => pieces(lateness, k, k, range, x).flat());
  const cells = new Map();
  for (const [p, , value] of all) {
    const cell = Math.round((p - box.left) / 3);
    if (value > 0 && !(cells.get(cell) >= value)) cells.set(cell, value);
  }
  const points = [...cells.keys()].sort((a, b) => a - b).map((cell) => [box.left + 3 * cell, cells.get(cell), cells.get(cell)]);
  return points.length ? [points] : [];
}

byId("late-of").addEventListener("change", (event) => {
  view.lateOf = Number(event.target.value);
  changed();
});
