// What the scene holds and when, with a cursor where we are; and the slider.

const ROW_HEIGHT = 17;
const TIMELINE_ROWS = ["motion", "force", "fault", "setting"];
let lanes = [];
let boxes = [];

// Spans that overlap lie in lanes below one another, at most four a row.
function lanesOf(row) {
  const ends = [];
  const spans = store.timeline.filter((span) => span.row === row).sort((a, b) => a.start_s - b.start_s);
  const made = [];
  for (const span of spans) {
    const end = isNumber(span.end_s) ? span.end_s : Infinity;
    let lane = ends.findIndex((before) => before <= span.start_s + 1e-9);
    if (lane < 0) lane = Math.min(ends.length, 3);
    ends[lane] = end;
    (made[lane] ??= []).push({ label: text(span.label), start: span.start_s, end });
  }
  return made.map((kept, i) => ({ row, name: i ? "" : row, spans: kept }));
}

panel("time", {
  present: () => isNumber(store.t) || store.timeline.length > 0,
  build() {
    const others = store.timeline.map(({ row }) => row).filter((row) => !TIMELINE_ROWS.includes(row));
    lanes = [...TIMELINE_ROWS, ...new Set(others)].flatMap(lanesOf);
    setHidden(byId("timeline"), !lanes.length);
    byId("timeline").style.height = `${lanes.length * ROW_HEIGHT + 15}px`;
  },
  draw(shown) {
    showControls(shown);
    const canvas = byId("timeline");
    const room = lanes.length ? surface(canvas) : null;
    if (room) drawTimeline(room, shown);
    const here = lanes.flatMap(({ row, spans }) => spans.filter(({ start, end }) => start <= shown.t && shown.t < end).map(({ label: word }) => `${row} ${word}`));
    describe(canvas, `Timeline at ${secondsText(shown.t)}: ${here.join(", ") || "nothing"}`);
  },
});

function drawTimeline({ g, width, height }, shown) {
  const box = { left: 56, right: width - 6, top: 1, bottom: height - 14 };
  const spans = lanes.flatMap((lane) => lane.spans);
  const ends = spans.flatMap(({ start, end }) => [start, end]).filter(isNumber);
  const most = Math.max(store.about.duration_s ?? 0, isNumber(store.t) ? store.t : 0, isNumber(store.about.duration_s) ? 0 : Math.max(0, ...ends));
  const x = scale(Math.min(0, isNumber(store.t0) ? store.t0 : 0), most || 1, box.left, box.right);
  frame(g, box, x, scale(0, 1, box.bottom, box.top), { xUnit: " s", xCount: width / 90, yCount: 0 });
  boxes = [];
  lanes.forEach((lane, i) => {
    const top = box.top + i * ROW_HEIGHT;
    g.fillStyle = colour.dim;
    g.textAlign = "left";
    g.fillText(lane.name, 2, top + ROW_HEIGHT / 2);
    lane.spans.forEach((span, k) => {
      const next = lane.spans[k + 1];
      drawSpan(g, box, top, { ...span, row: lane.row, x, until: next ? x(next.start) : box.right });
    });
  });
  cursor(g, box, x(shown.t));
  goToByPointer(g.canvas, x);
}

function drawSpan(g, box, top, { label: word, start, end, row, x, until }) {
  const open = !isNumber(end);
  const [from, to] = [Math.max(box.left, x(start)), open ? box.right : Math.min(box.right, x(end))];
  const wide = Math.max(2, to - from - 1);
  g.fillStyle = colour.many[Math.max(0, TIMELINE_ROWS.indexOf(row))];
  g.globalAlpha = 0.28;
  g.fillRect(from, top + 1, wide, ROW_HEIGHT - 2);
  g.globalAlpha = 1;
  g.fillRect(from, top + 1, 2, ROW_HEIGHT - 2);
  const words = open ? `${word} →` : word;
  if (until - from > 14) {
    g.fillStyle = colour.fg;
    g.textAlign = "left";
    clipped(g, { left: from, right: until, top, bottom: top + ROW_HEIGHT }, () => g.fillText(words, from + 5, top + ROW_HEIGHT / 2 + 0.5));
  }
  boxes.push({ from, to: from + wide, top, title: `${row}: ${word}, ${secondsText(start)} to ${open ? "the end" : secondsText(end)}` });
}

byId("timeline").addEventListener("pointermove", (event) => {
  const canvas = byId("timeline");
  const [x, y] = [event.offsetX, event.offsetY];
  const title = boxes.find(({ from, to, top }) => x >= from && x <= to && y >= top && y < top + ROW_HEIGHT)?.title ?? "";
  if (canvas.title !== title) canvas.title = title;
});

function showControls(shown) {
  const live = isLive();
  const moving = live ? !view.held : view.playing;
  const button = byId("pause");
  setText(button, live ? (moving ? "❚❚ Pause" : "▶ Go on") : moving ? "❚❚ Pause" : "▶ Play");
  button.setAttribute("aria-pressed", String(!moving));
  setHidden(byId("pace"), live);
  setHidden(byId("follow"), !live);
  byId("follow").disabled = !view.held;
  const { from, to } = shown.range;
  setText(byId("window"), view.window === Infinity ? "whole" : secondsText(view.window, 0));
  byId("window").title = `${secondsText(from)} to ${secondsText(to)}`;
  const slider = byId("slider");
  const end = view.held ? view.end : store.t;
  const place = end > store.t0 ? String(Math.round((1000 * (shown.t - store.t0)) / (end - store.t0))) : "1000";
  if (document.activeElement !== slider || slider.value !== place) slider.value = place;
  slider.setAttribute("aria-valuetext", secondsText(shown.t));
}
