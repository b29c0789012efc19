// A strip for each sensor: what it reads as a band or line, and the truth thin over it.

/** A sensor's columns in groups that one strip can show: of one unit, and a position's angles each alone. */
function stripsOf(sensor) {
  const groups = [];
  sensor.columns.forEach(({ name, unit }, k) => {
    const alone = name === "latitude" || name === "longitude";
    const group = groups[groups.length - 1];
    if (group && !alone && !group.alone && group.unit === unit) group.columns.push(k);
    else groups.push({ unit, alone, columns: [k] });
  });
  return groups;
}

const rows = [];

/** Pressing on a plot over time goes to that time; `x` is its present scale. */
const timeScales = new WeakMap();
function goToByPointer(canvas, x) {
  const known = timeScales.has(canvas);
  timeScales.set(canvas, x);
  if (known) return;
  const go = (event) => {
    if (event.type === "pointermove" && !event.buttons) return;
    // A finger that goes down may be about to scroll: only its tap counts.
    if (event.pointerType === "touch" && event.type !== "click") return;
    goTo(timeScales.get(canvas).back(event.clientX - canvas.getBoundingClientRect().left));
    changed();
  };
  for (const kind of ["pointerdown", "pointermove", "click"]) canvas.addEventListener(kind, go);
}

panel("strips", {
  present: () => store.sensors.some(({ readings }) => readings.length),
  build() {
    setText(byId("thinned"), text(store.about.thinned));
    byId("thinned").title = text(store.about.thinned);
    rows.length = 0;
    store.sensors.forEach((sensor, i) => rows.push(newRow(sensor, i)));
    byId("strip-list").replaceChildren(...rows.map(({ element }) => element));
  },
  draw(shown) {
    rows.forEach((row, i) => {
      const { sensor } = row;
      if (row.columns !== sensor.columns) fillRow(row);
      setHidden(row.element, !sensor.readings.length);
      row.element.classList.toggle("off", !sensor.visible);
      row.button.setAttribute("aria-pressed", String(sensor.visible));
      if (!sensor.visible || !sensor.readings.length) return;
      const last = i === rows.findLastIndex((other) => other.sensor.visible && other.sensor.readings.length);
      for (const strip of row.strips) drawStrip(row, strip, shown, last);
    });
  },
});

function newRow(sensor, i) {
  const name = sensor.name || `sensor ${i + 1}`;
  const key = i < 9 ? make("kbd", { text: String(i + 1) }) : "";
  const click = (event) => {
    toggleSensor(i);
    letGo(event);
  };
  const button = make("button", { type: "button", class: "toggle", "data-toggle": name, title: "Show or hide", click }, key, make("span", { text: name }));
  const plots = make("div", { class: "plots" });
  return { sensor, button, plots, strips: [], columns: null, element: make("div", { class: "strip", "data-strip": name }, button, plots) };
}

function fillRow(row) {
  row.columns = row.sensor.columns;
  row.strips = stripsOf(row.sensor).map((group) => {
    const legend = make("div", { class: "legend" });
    const cells = group.columns.map((k, i) => {
      const { name } = row.columns[k];
      const value = make("b", { "data-sensor": row.sensor.name, "data-column": name });
      legend.append(make("span", {}, make("i", { class: `swatch axis-${i % 3}` }), make("span", { text: `${name} ` }), value));
      return value;
    });
    if (group.unit) legend.append(make("span", { class: "dim", text: group.unit }));
    const canvas = make("canvas", { role: "img" });
    return { ...group, cells, canvas, element: make("div", { class: group.columns.length > 1 ? "plot wide" : "plot" }, legend, canvas), y: null };
  });
  row.plots.classList.toggle("several", row.strips.length > 1);
  row.plots.replaceChildren(...row.strips.map(({ element }) => element));
}

function toggleSensor(i) {
  const sensor = store.sensors[i];
  if (!sensor) return;
  sensor.visible = !sensor.visible;
  measureRoom();
  changed();
}

function drawStrip({ sensor }, strip, shown, last) {
  const { readings, columns } = sensor;
  const n = columns.length;
  const found = strip.columns.flatMap((k) => [extent(readings, k, n + k, shown.range), extent(readings, 2 * n + k, 3 * n + k, shown.range)]).filter(Boolean);
  const bounds = found.length ? padded(Math.min(...found.map(({ least }) => least)), Math.max(...found.map(({ most }) => most))) : { low: -1, high: 1 };
  const decimals = Math.max(0, decimalsOf(bounds.high - bounds.low) - (strip.alone ? 1 : 0));
  const point = readings.at(shown.t);
  const now = strip.columns.map((k) => (point < 0 ? NaN : (readings.columns[k][point] + readings.columns[n + k][point]) / 2));
  strip.cells.forEach((cell, i) => setNumber(cell, fixed(now[i], decimals), now[i]));
  describe(strip.canvas, `${sensor.name}: ${strip.columns.map((k, i) => `${columns[k].name} ${fixed(now[i], decimals)}`).join(", ")} ${strip.unit}`);
  strip.canvas.classList.toggle("last", last);
  const room = surface(strip.canvas);
  if (room) paintStrip(room, sensor, strip, { shown, bounds, last });
}

function paintStrip({ g, width, height }, { readings, columns }, strip, { shown, bounds, last }) {
  const n = columns.length;
  const small = width < 260;
  const box = { left: small ? 4 : 48, right: width - 14, top: 3, bottom: height - (last ? 16 : 3) };
  const x = scale(shown.range.from, shown.range.to, box.left, box.right);
  const y = scale(bounds.low, bounds.high, box.bottom, box.top);
  frame(g, box, x, y, { xLabels: last, xUnit: " s", xCount: width / 70, yCount: small ? 0 : (box.bottom - box.top) / 24 });
  clipped(g, box, () => {
    strip.columns.forEach((k, i) => {
      const stroke = colour.axes[i % 3];
      band(g, pieces(readings, k, n + k, shown.range, x), y, { stroke, fill: stroke, width: 2.5 });
    });
    strip.columns.forEach((k, i) => {
      const truth = pieces(readings, 2 * n + k, 3 * n + k, shown.range, x);
      // Where it goes up and down within every pixel it would hide what is read.
      const points = truth.flat();
      g.globalAlpha = points.reduce((sum, [, a, b]) => sum + y(a) - y(b), 0) > 4 * points.length ? 0.3 : 1;
      band(g, truth, y, { stroke: colour.fg, width: 1, dash: axisDashes[i % 3] });
      g.globalAlpha = 1;
    });
  });
  if (small) limits(g, box, y);
  names(g, box, y, strip, readings, columns, shown);
  cursor(g, box, x(shown.t));
  goToByPointer(g.canvas, x);
}

// A small strip has its least and greatest value inside, as there is no room beside it.
function limits(g, box, y) {
  const { ticks, step } = linearTicks(y.low, y.high, 2);
  g.textAlign = "left";
  for (const tick of ticks.length > 1 ? [ticks[0], ticks[ticks.length - 1]] : ticks) {
    const middle = clamp(y(tick), box.top + 6, box.bottom - 6);
    g.fillStyle = colour.dim;
    over(g, tickText(tick, step), box.left + 2, middle);
  }
}

// Each line's name at its right end, apart from one another.
function names(g, box, y, { columns }, readings, all, shown) {
  if (columns.length < 2) return;
  const n = all.length;
  const i = readings.at(shown.range.to);
  if (i < 0) return;
  const ends = columns.map((k, order) => ({ order, name: all[k].name.slice(0, 1), at: y((readings.columns[k][i] + readings.columns[n + k][i]) / 2) }));
  const placed = ends.filter(({ at }) => isNumber(at)).sort((a, b) => a.at - b.at);
  const most = box.bottom - 5 - 10 * (placed.length - 1);
  placed.forEach((end, j) => (end.at = Math.max(clamp(end.at, box.top + 5, most + 10 * j), j ? placed[j - 1].at + 10 : 0)));
  g.textAlign = "left";
  g.font = "bold 11px system-ui, sans-serif";
  for (const { order, name, at } of placed) {
    g.fillStyle = colour.axes[order % 3];
    g.fillText(name, box.right + 4, at);
  }
}
