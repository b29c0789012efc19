"use strict";
// Numbers as people read them.

const isNumber = (x) => typeof x === "number" && Number.isFinite(x);
const clamp = (x, least, most) => Math.max(least, Math.min(most, x));

/** A fixed number of decimals, and no -0. */
function fixed(x, decimals) {
  if (!isNumber(x)) return "–";
  if (Math.abs(x) >= 1e9) return exponential(x, 4);
  const text = x.toFixed(clamp(decimals, 0, 12));
  return /^-[0.]+$/.test(text) ? text.slice(1) : text;
}

function exponential(x, digits) {
  return x.toExponential(digits - 1).replace("e+", "e").replace(/\.?0+e/, "e");
}

/** About this many significant digits. */
function significant(x, digits = 4) {
  if (!isNumber(x)) return "–";
  const size = Math.abs(x);
  if (size === 0) return "0";
  if (size >= 1e7 || size < 1e-4) return exponential(x, digits);
  return fixed(x, digits - 1 - Math.floor(Math.log10(size)));
}

/** The decimals that tell a thousandth of this span apart. */
function decimalsOf(span) {
  return span > 0 ? clamp(Math.ceil(3 - Math.log10(span)), 0, 10) : 3;
}

function secondsText(t, decimals = 1) {
  if (!isNumber(t)) return "–";
  if (Math.abs(t) < 600) return `${fixed(t, decimals)} s`;
  const sign = t < 0 ? "−" : "";
  const whole = Math.floor(Math.abs(t));
  const parts = [[Math.floor(whole / 3600), "h"], [Math.floor(whole / 60) % 60, "min"], [whole % 60, "s"]];
  return sign + parts.filter(([n], i) => n > 0 || i > 0).map(([n, unit]) => `${n} ${unit}`).join(" ");
}

function bytesText(n) {
  if (!isNumber(n)) return "–";
  const units = ["B", "kB", "MB", "GB", "TB"];
  const power = n < 1000 ? 0 : clamp(Math.floor(Math.log10(n) / 3), 0, 4);
  return `${power ? significant(n / 1000 ** power) : fixed(n, 0)} ${units[power]}`;
}

function microsecondsText(x) {
  if (!isNumber(x)) return "–";
  const size = Math.abs(x);
  if (size >= 1e6) return `${significant(x / 1e6, 3)} s`;
  return size >= 1e4 ? `${significant(x / 1e3, 3)} ms` : `${significant(x, 3)} µs`;
}

/** A tick's label: plain where it is short. */
function tickText(x, step) {
  if (x === 0) return "0";
  const size = Math.abs(x);
  if (size >= 1e6 || size < 1e-3) {
    const digits = step > 0 ? clamp(Math.floor(Math.log10(size)) - Math.floor(Math.log10(step)) + 1, 1, 6) : 1;
    return exponential(x, digits);
  }
  return fixed(x, step > 0 ? clamp(-Math.floor(Math.log10(step) + 1e-9), 0, 8) : 3);
}
