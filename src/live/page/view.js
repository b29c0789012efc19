// Which time is shown. Live the view follows; held it stands still while the store goes on; in a report it plays.

const WINDOWS_S = [2, 5, 10, 20, 30, 60, 120, 300, 600, 1800, 3600, 3 * 3600, 6 * 3600, Infinity];

const view = {
  report: false, held: false, t: NaN, end: NaN, window: 10, playing: false, pace: 1,
  estimator: 0, lateOf: -1, played: 0,
};

/** Whether more is to come. */
const isLive = () => !view.report && !store.end;
const isMoving = () => (isLive() ? !view.held : view.playing);
const shownTime = () => (view.held ? view.t : store.t);

function startView() {
  Object.assign(view, { held: false, t: NaN, end: NaN, playing: false, estimator: 0, lateOf: -1 });
  if (view.report) view.window = Infinity;
}

/** Holds the view where it is. */
function hold() {
  if (view.held || !isNumber(store.t)) return;
  Object.assign(view, { held: true, t: store.t, end: store.t });
}

function follow() {
  view.playing = false;
  if (isLive()) view.held = false;
  else goTo(store.t);
}

function pauseOrGoOn() {
  if (isLive()) return view.held ? follow() : hold();
  hold();
  view.playing = !view.playing;
  view.played = performance.now();
  if (view.playing && view.t >= view.end) view.t = store.t0;
}

function goTo(t) {
  hold();
  if (!isNumber(t) || !view.held) return;
  view.t = clamp(t, store.t0, view.end);
}

/** A step back (-1) or on (1): a twentieth of the window. */
function step(way) {
  if (!view.held) return;
  const { from, to } = timeRange();
  goTo(view.t + (way * (to - from)) / 20);
}

function zoom(way) {
  const i = WINDOWS_S.indexOf(view.window);
  const whole = store.t - store.t0;
  let next = clamp(i + way, 0, WINDOWS_S.length - 1);
  // Windows longer than the whole all look alike.
  if (WINDOWS_S[next] >= whole) next = way > 0 ? WINDOWS_S.length - 1 : WINDOWS_S.findLastIndex((s) => s < whole);
  view.window = WINDOWS_S[Math.max(0, next)];
}

/** The times that the strips show: around the shown time, as far as there is something. */
function timeRange() {
  const [least, most] = [store.t0, view.held ? view.end : store.t];
  if (!isNumber(least)) return { from: 0, to: 1 };
  if (view.window === Infinity) return { from: least, to: Math.max(most, least + 1e-3) };
  const to = clamp(shownTime() + view.window / 2, Math.min(most, least + view.window), most);
  const from = Math.max(least, to - view.window);
  return { from, to: Math.max(to, from + view.window) };
}

/** Moves a report's time on while it plays; whether it does. */
function play() {
  if (!view.playing) return false;
  const now = performance.now();
  view.t += (view.pace * Math.min(now - view.played, 500)) / 1000;
  view.played = now;
  if (view.t >= view.end) Object.assign(view, { t: view.end, playing: false });
  return view.playing;
}
