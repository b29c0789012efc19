// The loop: what has changed is drawn in the next frame, and nothing is drawn otherwise.

const CALM_MS = 250;
const calm = matchMedia("(prefers-reduced-motion: reduce)");
const shown = { t: NaN, truth: null, estimate: null, error: null, sensors: [], window_s: 0, paused: false, phase: "", drawn: 0, range: { from: 0, to: 1 } };
const loop = { asked: false, charts: true, begun: 0, end: null, drawnAt: 0 };

/** Something is to be drawn, with the charts too where they are concerned. */
function changed(withCharts = false) {
  if (withCharts) loop.charts = true;
  if (loop.asked) return;
  loop.asked = true;
  requestAnimationFrame(draw);
}

/** New data has come: who wants little motion gets it a few times a second. */
function dataChanged() {
  const wait = calm.matches ? CALM_MS - (performance.now() - loop.drawnAt) : 0;
  if (wait > 0) setTimeout(changed, wait);
  else changed();
}

function draw() {
  loop.asked = false;
  loop.drawnAt = performance.now();
  if (loop.begun !== store.begun) beginPanels();
  if (loop.end !== store.end) endPanels();
  const playing = play();
  lookUp();
  showHeader(shown);
  let appeared = false;
  for (const { element, present } of panels) {
    const hidden = !present();
    if (hidden !== element.hidden) appeared = true;
    setHidden(element, hidden);
  }
  if (appeared) arrange();
  for (const { element, draw: drawPanel } of panels) if (!element.hidden) drawPanel(shown);
  if (loop.charts) drawCharts();
  loop.charts = false;
  shown.drawn += 1;
  if (playing) dataChanged();
}

function beginPanels() {
  loop.begun = store.begun;
  startView();
  for (const { build } of panels) build();
  loop.end = undefined;
  measureRoom();
}

function endPanels() {
  loop.end = store.end;
  if (!isLive()) hold();
  showEnd();
  loop.charts = true;
  arrange();
}

/** What the shown time shows, for the panels and for tests. */
function lookUp() {
  const t = shownTime();
  const estimator = chosenEstimator();
  const error = (k) => estimator.errors.value(k, t);
  Object.assign(shown, {
    t, range: timeRange(),
    truth: attitudeAt(store.truth, t),
    estimate: estimator && attitudeAt(estimator.attitude, t),
    error: estimator && estimator.errors.at(t) >= 0 ? { inclination_deg: error(0), heading_deg: error(1) } : null,
    paused: isLive() ? view.held : !view.playing,
    phase: store.phase,
    sensors: store.sensors.map((sensor) => ({ name: sensor.name, visible: sensor.visible, last: lastReading(sensor, t) })),
  });
  shown.window_s = shown.range.to - shown.range.from;
}

function lastReading({ readings, columns }, t) {
  const i = readings.at(t);
  if (i < 0) return null;
  const n = columns.length;
  const middle = (k, j) => (readings.columns[k][i] + readings.columns[j][i]) / 2;
  const values = columns.map((_, k) => middle(k, n + k));
  const truth = columns.map((_, k) => middle(2 * n + k, 3 * n + k));
  return { t: readings.last[i], values, true: truth.some(Number.isNaN) ? null : truth };
}

/** Leaves out columns without a panel. */
function arrange() {
  for (const column of document.querySelectorAll(".column")) setHidden(column, ![...column.children].some((part) => !part.hidden));
  byId("panels").classList.toggle("narrow", byId("middle").hidden);
  measureRoom();
}

/** How high strips and bodies may be for the panels to fit on the screen. */
function measureRoom() {
  const style = document.documentElement.style;
  const room = Math.max(420, innerHeight - byId("panels").offsetTop - 12);
  style.setProperty("--room", `${room}px`);
  const seen = store.sensors.filter(({ readings, visible }) => visible && readings.length).length || 1;
  const hidden = store.sensors.filter(({ readings, visible }) => !visible && readings.length).length;
  style.setProperty("--strip", `${clamp(Math.floor((room - 58 - 26 * hidden) / seen) - 27, 56, 240)}px`);
}

addEventListener("resize", () => {
  measureRoom();
  changed(true);
});
addEventListener("scroll", () => isMoving() && changed(), { passive: true });
document.addEventListener("visibilitychange", () => document.hidden || changed(true));

window.ratetable = { store, shown };
setTheme();
