// What every plot shares: scales, ticks, a frame, and a line or band over time.

/** A scale from values to pixels, linear or by decades. */
function scale(low, high, from, to, log = false) {
  const inner = log ? Math.log10 : (x) => x;
  const [a, b] = [inner(low), inner(high)];
  const slope = (to - from) / (b - a || 1);
  const at = (x) => from + (inner(x) - a) * slope;
  return Object.assign(at, { low, high, log, back: (p) => (log ? 10 ** (a + (p - from) / slope) : a + (p - from) / slope) });
}

/** Round values between two, about `count` of them, and their step. */
function linearTicks(low, high, count) {
  const rough = (high - low) / Math.max(1, count);
  if (!(rough > 0) || !Number.isFinite(rough)) return { ticks: [], step: 0 };
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = power * ([1, 2, 5, 10].find((x) => x * power >= rough * 0.7) ?? 10);
  const ticks = [];
  for (let k = Math.ceil(low / step - 1e-9); ticks.length < 50 && k * step <= high + step * 1e-9; k++) ticks.push(k * step);
  // One tick alone says nothing about the scale.
  return ticks.length < 2 && count < 8 ? linearTicks(low, high, 2 * Math.max(1, count)) : { ticks, step };
}

/** Powers of ten between two, every so many decades that there are at most `count`; 2 and 5 too where these are few. */
function logTicks(low, high, count) {
  const [from, to] = [Math.ceil(Math.log10(low) - 1e-9), Math.floor(Math.log10(high) + 1e-9)];
  if (to - from < 2) {
    const all = [from - 1, from, from + 1].flatMap((k) => [1, 2, 5].map((x) => x * 10 ** k));
    return { ticks: all.filter((x) => x >= low && x <= high).slice(0, Math.max(2, count)), step: 0 };
  }
  const every = Math.max(1, Math.ceil((to - from + 1) / Math.max(1, count)));
  const ticks = [];
  for (let k = from; k <= to; k += every) ticks.push(10 ** k);
  return { ticks, step: 0 };
}

const ticksOf = (axis, count) => (axis.log ? logTicks : linearTicks)(axis.low, axis.high, count);

function decadeText(x) {
  const power = Math.floor(Math.log10(x) + 1e-9);
  const lead = Math.round(x / 10 ** power);
  if (lead > 1) return power >= -3 && power <= 4 ? fixed(x, Math.max(0, -power)) : exponential(x, 1);
  if (power >= -3 && power <= 4) return String(+`1e${power}`);
  return "10" + Array.from(String(power), (c) => ({ "-": "⁻" })[c] ?? "⁰¹²³⁴⁵⁶⁷⁸⁹"[c]).join("");
}

/** Words that can be read over anything. */
function over(g, words, x, y) {
  g.strokeStyle = colour.panel;
  g.lineWidth = 3;
  g.strokeText(words, x, y);
  g.fillText(words, x, y);
}

/** Grid lines and labels; `box` is {left, right, top, bottom} of the plot itself. */
function frame(g, box, x, y, { xLabels = true, xUnit = "", xCount = 6, yCount = 4 } = {}) {
  g.strokeStyle = colour.line;
  g.fillStyle = colour.dim;
  g.lineWidth = 1;
  g.setLineDash([]);
  g.beginPath();
  const across = ticksOf(x, xCount);
  let free = Infinity;
  g.textAlign = "center";
  // From the last, which has the unit; one without room is left out.
  for (const [i, tick] of across.ticks.reverse().entries()) {
    const p = Math.round(x(tick)) + 0.5;
    g.moveTo(p, box.top);
    g.lineTo(p, box.bottom);
    const words = (x.log ? decadeText(tick) : tickText(tick, across.step)) + (i ? "" : xUnit);
    const half = g.measureText(words).width / 2;
    const middle = clamp(p, box.left + half - 4, box.right - half + 4);
    if (!xLabels || middle + half > free) continue;
    g.fillText(words, middle, box.bottom + 8);
    free = middle - half - 4;
  }
  const up = yCount ? ticksOf(y, yCount) : { ticks: [], step: 0 };
  const labels = [];
  for (const tick of up.ticks) {
    const p = Math.round(y(tick)) + 0.5;
    g.moveTo(box.left, p);
    g.lineTo(box.right, p);
    labels.push([y.log ? decadeText(tick) : tickText(tick, up.step), clamp(p, box.top + 5, box.bottom - 5)]);
  }
  g.stroke();
  if (yCount) labelsUp(g, box, labels);
}

// Labels beside the plot, or in it where they are too wide.
function labelsUp(g, box, labels) {
  for (const [words, p] of labels) {
    const inside = g.measureText(words).width > box.left - 4;
    g.textAlign = inside ? "left" : "right";
    over(g, words, inside ? box.left + 2 : box.left - 4, p);
  }
}

function clipped(g, box, paint) {
  g.save();
  g.beginPath();
  g.rect(box.left, box.top, box.right - box.left, box.bottom - box.top);
  g.clip();
  paint();
  g.restore();
}

/** Where we are, as a line from top to bottom. */
function cursor(g, box, p) {
  if (!(p >= box.left - 1 && p <= box.right + 1)) return;
  g.setLineDash([]);
  g.strokeStyle = colour.cursor;
  g.lineWidth = 1.5;
  g.beginPath();
  g.moveTo(p, box.top);
  g.lineTo(p, box.bottom);
  g.stroke();
}

/** The least and greatest of two columns in a time, or null; `above` leaves out what is not greater than it. */
function extent(series, low, high, range, above = -Infinity) {
  let [least, most] = [Infinity, -Infinity];
  const last = series.at(range.to);
  for (let i = Math.max(0, series.at(range.from)); i <= last; i++) {
    const [a, b] = [series.columns[low][i], series.columns[high][i]];
    if (a > above && a < least) least = a;
    if (b > above && b > most) most = b;
  }
  return least <= most ? { least, most } : null;
}

/** Some room around two values, also where they are the same. */
function padded(least, most) {
  const room = (most - least) * 0.06 || Math.abs(most) * 1e-3 || 1;
  return { low: Math.max(least - room, -Number.MAX_VALUE / 4), high: Math.min(most + room, Number.MAX_VALUE / 4) };
}

/**
 * The points of two columns in a time as [pixel, low, high], with the points in one pixel joined, and in pieces
 * where there is a gap much longer than the usual distance.
 */
function pieces(series, low, high, range, x) {
  const from = Math.max(0, series.at(range.from));
  const last = Math.min(series.length - 1, series.at(range.to) + 1);
  const usual = last > from ? (series.last[last] - series.first[from]) / (last - from) : 0;
  const [lows, highs] = [series.columns[low], series.columns[high]];
  const found = [];
  let piece = null;
  let before = -Infinity;
  for (let i = from; i <= last; i++) {
    const [a, b] = [lows[i], highs[i]];
    if (Number.isNaN(a) || series.first[i] - before > 6 * usual) piece = null;
    before = series.last[i];
    if (Number.isNaN(a)) continue;
    if (!piece) found.push((piece = []));
    const p = x(series.first[i]);
    const tail = piece[piece.length - 1];
    if (tail && p - tail[0] < 0.75) {
      if (a < tail[1]) tail[1] = a;
      if (b > tail[2]) tail[2] = b;
    } else piece.push([p, a, b]);
  }
  return found;
}

/** A band between low and high, with its edges: a line where both are the same. */
function band(g, found, y, { stroke, fill = null, width = 1, dash = [] }) {
  g.strokeStyle = stroke;
  g.lineWidth = width;
  g.setLineDash(dash);
  for (const piece of found) {
    g.beginPath();
    if (piece.length === 1) {
      g.fillStyle = stroke;
      g.fillRect(piece[0][0] - 1, y(piece[0][2]) - 1, 2, Math.max(2, y(piece[0][1]) - y(piece[0][2])));
      continue;
    }
    piece.forEach(([p, , b], i) => (i ? g.lineTo(p, y(b)) : g.moveTo(p, y(b))));
    if (piece.some(([, a, b]) => a !== b)) {
      for (let i = piece.length - 1; i >= 0; i--) g.lineTo(piece[i][0], y(piece[i][1]));
      g.closePath();
      if (fill) {
        g.globalAlpha = 0.35;
        g.fillStyle = fill;
        g.fill();
        g.globalAlpha = 1;
      }
    }
    g.stroke();
  }
  g.setLineDash([]);
}
