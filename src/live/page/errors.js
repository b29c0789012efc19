// The estimate's error in inclination and in heading: now, and over time.

const ERRORS = [["inclination", "inclination_deg"], ["heading", "heading_deg"]];

panel("errors", {
  present: () => store.estimators.some(({ errors }) => errors.length),
  build() {
    const number = ([name], k) => make("span", {}, make("i", { class: `swatch line-${k}` }), `${name} `, make("b", { "data-error": name }), " deg");
    byId("error-numbers").replaceChildren(...ERRORS.map(number));
  },
  draw(shown) {
    const name = chosenEstimator()?.name;
    setText(byId("against"), `${name ? `${name} ` : ""}against the ${referenceName()}`);
    for (const [word, field] of ERRORS) {
      const x = shown.error?.[field];
      setNumber(byId("error-numbers").querySelector(`[data-error=${word}]`), significant(x), x);
    }
    const canvas = byId("error-history");
    const room = surface(canvas);
    if (room) drawErrors(room, chosenEstimator()?.errors, shown);
    describe(canvas, `Error over time. Inclination ${significant(shown.error?.inclination_deg)} deg, heading ${significant(shown.error?.heading_deg)} deg`);
  },
});

function drawErrors({ g, width, height }, errors, shown) {
  const box = { left: 44, right: width - 8, top: 6, bottom: height - 16 };
  const range = shown.range;
  const found = errors ? ERRORS.map((_, k) => extent(errors, k, k, range)).filter(Boolean) : [];
  const { low, high } = padded(Math.min(0, ...found.map(({ least }) => least)), Math.max(0, ...found.map(({ most }) => most)));
  const x = scale(range.from, range.to, box.left, box.right);
  const y = scale(low, high, box.bottom, box.top);
  frame(g, box, x, y, { xUnit: " s", xCount: width / 70, yCount: height / 30 });
  if (errors) {
    const dashes = [[], [5, 3]];
    clipped(g, box, () => ERRORS.forEach((_, k) => {
      band(g, pieces(errors, k, k, range, x), y, { stroke: colour.many[k], width: 1.5, dash: dashes[k] });
    }));
  }
  cursor(g, box, x(shown.t));
  goToByPointer(g.canvas, x);
}
