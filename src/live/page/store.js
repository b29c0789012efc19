// What the messages have told so far.

const NOTICES_KEPT = 200;
const store = {};

const list = (x) => (Array.isArray(x) ? x : []);
const text = (x) => (x === null || x === undefined ? "" : String(x));
const record = (x) => (x && typeof x === "object" && !Array.isArray(x) ? x : {});

function clear() {
  Object.assign(store, {
    about: {}, begun: 0, end: null, phase: "", waiting: "", t: NaN, t0: NaN, lost: 0,
    sensors: [], estimators: [], links: [], timeline: [], notices: [], noticed: 0,
    truth: new Series("vvvv"), histogram: null,
  });
}
clear();

function receive(message) {
  const told = record(message);
  if (told.kind === "begin") begin(told);
  else if (told.kind === "more") more(told);
  else if (told.kind === "end") store.end = told;
}

function begin(told) {
  const begun = store.begun + 1;
  clear();
  store.begun = begun;
  store.about = told;
  store.sensors = list(told.sensors).map(newSensor);
  for (const [names, find] of [[told.estimators, estimator], [told.links, link]]) {
    list(names).slice(0, 100).forEach((name, i) => {
      const found = find(i);
      found.name = text(name) || found.name;
    });
  }
  store.timeline = list(told.timeline).map(record).filter((span) => isNumber(span.start_s));
}

function newSensor(told) {
  const { name, kind, rate_hz, has_truth, columns } = record(told);
  const named = list(columns).map((column) => ({ name: text(record(column).name), unit: text(record(column).unit) }));
  const sensor = { name: text(name), kind: text(kind), rate_hz, has_truth, visible: true };
  return Object.assign(sensor, { rates: new Series("v"), lateness: new Series("vhh") }, newReadings(named));
}

// The columns are each reading's least, greatest, and the truth's least and greatest.
function newReadings(columns) {
  const n = columns.length;
  return { columns, readings: new Series(["l", "h", "l", "h"].map((kind) => kind.repeat(n)).join("")) };
}

function estimator(i) {
  if (!Number.isInteger(i) || i < 0 || i > 99) return null;
  while (store.estimators.length <= i) {
    const name = `estimate ${store.estimators.length + 1}`;
    store.estimators.push({ name, attitude: new Series("vvvv"), errors: new Series("hh") });
  }
  return store.estimators[i];
}

function link(i) {
  if (!Number.isInteger(i) || i < 0 || i > 99) return null;
  while (store.links.length <= i) store.links.push({ name: `link ${store.links.length + 1}`, now: null, past: [] });
  return store.links[i];
}

function more(told) {
  if (told.phase !== undefined) store.phase = text(told.phase);
  if (told.waiting !== undefined) store.waiting = text(told.waiting);
  if (isNumber(told.lost)) store.lost = told.lost;
  addAttitudes(store.truth, told.truth);
  each(told.estimates, estimator, ({ attitude }, part) => addAttitudes(attitude, part));
  each(told.errors, estimator, ({ errors }, part) => addColumns(errors, part, ["inclination_deg", "heading_deg"]));
  each(told.readings, sensorAt, addReadings);
  each(told.rates, sensorAt, ({ rates }, part) => addColumns(rates, part, ["hz"]));
  each(told.lateness, sensorAt, ({ lateness }, part) => addColumns(lateness, part, ["p50_us", "p99_us", "max_us"]));
  if (told.late_histogram) store.histogram = histogramOf(record(told.late_histogram));
  if (isNumber(told.t)) reach(told.t);
  each(told.links, link, addLink);
  for (const notice of list(told.notices).map(record)) {
    store.notices.push({ t: notice.t, text: text(notice.text) });
    store.noticed += 1;
  }
  store.notices.splice(0, store.notices.length - NOTICES_KEPT);
}

const sensorAt = (i) => store.sensors[i] ?? null;

function each(parts, find, add) {
  for (const part of list(parts).map(record)) {
    const found = find(part.of ?? 0);
    if (found) add(found, part);
  }
}

/** Scene time has come to t. */
function reach(t) {
  if (!isNumber(t)) return;
  if (!(store.t >= t)) store.t = t;
  if (!(store.t0 <= t)) store.t0 = t;
}

function addAttitudes(series, part) {
  const { t, q } = record(part);
  list(t).forEach((time, i) => {
    const attitude = list(q).slice(4 * i, 4 * i + 4);
    if (attitude.length < 4 || !attitude.every(isNumber)) return;
    series.push(time, attitude);
    reach(time);
  });
}

function addColumns(series, part, names) {
  list(part.t).forEach((time, i) => {
    series.push(time, names.map((name) => list(part[name])[i]));
    reach(time);
  });
}

function addReadings(sensor, part) {
  const low = list(part.low).map(list);
  if (!sensor.columns.length && low.length) {
    Object.assign(sensor, newReadings(low.map((_, k) => ({ name: "xyzuvw"[k] ?? `${k}`, unit: "" }))));
  }
  const high = part.high ? list(part.high).map(list) : low;
  const truth = list(part.true).map(list);
  const kinds = [low, high, truth, truth];
  list(part.t).forEach((time, i) => {
    sensor.readings.push(time, kinds.flatMap((values) => sensor.columns.map((_, k) => values[k]?.[i])));
    reach(time);
  });
}

function histogramOf(told) {
  const edges = list(told.edges_us);
  if (edges.length < 2 || !edges.every(isNumber)) return null;
  const counts = list(told.counts).map(record).map(({ of, n }) => ({ of, n: list(n) }));
  return { edges, counts };
}

// A link's bytes a second come from what it told about three seconds ago.
function addLink(found, part) {
  found.now = part;
  const { bytes } = part;
  if (!isNumber(bytes) || !isNumber(store.t)) return;
  const { past } = found;
  if (!past.length) past.push({ t: store.t0, bytes: 0 });
  if (store.t <= past[past.length - 1].t) return;
  past.push({ t: store.t, bytes });
  while (past.length > 2 && past[1].t < store.t - 3) past.shift();
  found.bytes_per_s = (bytes - past[0].bytes) / (store.t - past[0].t);
}
