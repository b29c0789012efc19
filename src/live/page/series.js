// Numbers over time, in bounded memory: when the room is full, older points are joined, with their least and greatest.

const MOST_POINTS = 16384;

class Series {
  /** One letter a column: "l" keeps the least of joined points, "h" the greatest, "v" the latest. */
  constructor(kinds) {
    this.kinds = kinds;
    this.length = 0;
    this.first = new Float64Array(256);
    this.last = new Float64Array(256);
    this.columns = Array.from(kinds, () => new Float64Array(256));
  }

  /** Adds a point; one that is older than the newest is left out. */
  push(t, values) {
    if (!isNumber(t) || (this.length && t < this.last[this.length - 1])) return;
    if (this.length === this.first.length) this.makeRoom();
    const n = this.length++;
    this.first[n] = this.last[n] = t;
    for (let k = 0; k < this.columns.length; k++) {
      const x = values[k];
      this.columns[k][n] = isNumber(x) ? x : NaN;
    }
  }

  makeRoom() {
    if (this.length >= MOST_POINTS) return this.join();
    const grown = (old) => {
      const array = new Float64Array(Math.min(MOST_POINTS, 2 * old.length));
      array.set(old);
      return array;
    };
    this.first = grown(this.first);
    this.last = grown(this.last);
    this.columns = this.columns.map(grown);
  }

  // The older three quarters become at most half of the room, evenly over their time.
  join() {
    const old = (MOST_POINTS * 3) / 4;
    const span = (this.last[old - 1] - this.first[0]) / (MOST_POINTS / 4);
    let n = 0;
    for (let i = 1; i < old; i++) {
      if (this.last[i] - this.first[n] <= span) this.joinInto(n, i);
      else this.move(++n, i);
    }
    n += 1;
    for (const array of [this.first, this.last, ...this.columns]) array.copyWithin(n, old, this.length);
    this.length -= old - n;
  }

  joinInto(n, i) {
    this.last[n] = this.last[i];
    this.columns.forEach((column, k) => {
      const [a, b] = [column[n], column[i]];
      if (Number.isNaN(b)) return;
      const kind = this.kinds[k];
      if (Number.isNaN(a) || kind === "v" || (kind === "l" ? b < a : b > a)) column[n] = b;
    });
  }

  move(n, i) {
    this.first[n] = this.first[i];
    this.last[n] = this.last[i];
    for (const column of this.columns) column[n] = column[i];
  }

  /** The last point that is not after t, or -1. */
  at(t) {
    let [low, high] = [0, this.length];
    while (low < high) {
      const middle = (low + high) >> 1;
      if (this.first[middle] <= t) low = middle + 1;
      else high = middle;
    }
    return low - 1;
  }

  /** A column's value at the last point that is not after t. */
  value(k, t) {
    const i = this.at(t);
    return i < 0 ? NaN : this.columns[k][i];
  }
}
