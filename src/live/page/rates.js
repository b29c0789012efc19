// Each sensor's rate: what the scene asks, what is delivered, and what is lost.

const rateRows = [];
const lostShare = (asked, delivered) => (isNumber(asked) && asked > 0 && isNumber(delivered) ? Math.max(0, 1 - delivered / asked) : NaN);

panel("rates", {
  present: () => store.sensors.length > 0,
  build() {
    rateRows.length = 0;
    store.sensors.forEach((sensor, i) => {
      const name = sensor.name || `sensor ${i + 1}`;
      const cell = (field) => make("td", { "data-sensor": name, "data-field": field });
      const row = { sensor, asked: cell("asked_hz"), rate: cell("rate_hz"), lost: cell("lost"), canvas: make("canvas", { role: "img", class: "spark" }) };
      setNumber(row.asked, isNumber(sensor.rate_hz) ? `${Number(sensor.rate_hz.toPrecision(6))} Hz` : "–", sensor.rate_hz);
      row.element = make("tr", {}, make("th", { scope: "row", text: name }), row.asked, row.rate, row.lost, make("td", {}, row.canvas));
      rateRows.push(row);
    });
    byId("rate-table").tBodies[0].replaceChildren(...rateRows.map(({ element }) => element));
  },
  draw(shown) {
    for (const { sensor, rate, lost, canvas } of rateRows) {
      const hz = sensor.rates.value(0, shown.t);
      const share = lostShare(sensor.rate_hz, hz);
      setNumber(rate, isNumber(hz) ? `${significant(hz, 4)} Hz` : "–", hz);
      // A rate over a second wavers by a sample or so: that is not a loss.
      const real = share * hz > 2 || share > 0.02;
      setNumber(lost, !isNumber(share) ? "–" : real ? `▼ ${significant(share * 100, 3)} %` : "0 %", share);
      lost.classList.toggle("bad", real);
      const room = surface(canvas);
      if (room) drawSpark(room, sensor, shown);
      describe(canvas, `${sensor.name}: ${significant(hz)} Hz delivered`);
    }
  },
});

function drawSpark({ g, width, height }, sensor, { range, t }) {
  const found = extent(sensor.rates, 0, 0, range);
  if (!found) return;
  const asked = isNumber(sensor.rate_hz) ? sensor.rate_hz : found.most;
  const { high } = padded(0, Math.max(asked, found.most));
  const x = scale(range.from, range.to, 1, width - 1);
  const y = scale(Math.min(found.least, asked * 0.8), high, height - 2, 2);
  g.strokeStyle = colour.dim;
  g.setLineDash([2, 2]);
  path(g, [[0, y(asked)], [width, y(asked)]], false);
  g.stroke();
  band(g, pieces(sensor.rates, 0, 0, range, x), y, { stroke: colour.bar, width: 1.5 });
  cursor(g, { left: 0, right: width, top: 0, bottom: height }, x(t));
}
