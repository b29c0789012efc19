// Two bodies in one picture: the truth solid, the estimate outlined, over the horizon and the nav axes.

const HOME = { heading: 32, elevation: 24 };
const camera = { ...HOME };

// A dart with a fin, in forward, left and up; every face turns the same way round as seen from outside.
const DART = (() => {
  const [nose, left, right] = [[1, 0, 0], [-0.8, 0.75, 0], [-0.8, -0.75, 0]];
  const [top, keel, tip] = [[-0.6, 0, 0.2], [-0.6, 0, -0.08], [-0.95, 0, 0.6]];
  return {
    faces: [[nose, left, top], [nose, top, right], [nose, keel, left], [nose, right, keel], [left, keel, top], [right, top, keel], [[0.05, 0, 0.08], tip, top]],
    edges: [[nose, left], [left, top], [top, right], [right, nose], [nose, top], [top, tip], [tip, [0.05, 0, 0.08]], [left, keel], [keel, right], [nose, keel]],
  };
})();

// How each choice of axes lies in the world (east, north, up), and in a body (forward, left, up).
const FRAMES = {
  "ned-frd": {
    world: ([n, e, d]) => [e, n, -d], body: ([f, l, u]) => [f, -l, -u], nav: ["N", "E", "D"],
    words: "x forward, y right, z down",
  },
  "enu-flu": {
    world: ([e, n, u]) => [e, n, u], body: ([f, l, u]) => [f, l, u], nav: ["E", "N", "U"],
    words: "x forward, y left, z up",
  },
};
const frameOf = () => FRAMES[store.about.axes] ?? FRAMES["ned-frd"];

/** From the world to the picture: [right, down, distance]. */
function lens(width, height) {
  const [h, e] = [camera.heading, camera.elevation].map((x) => (x * Math.PI) / 180);
  const [sh, ch, se, ce] = [Math.sin(h), Math.cos(h), Math.sin(e), Math.cos(e)];
  const size = Math.min(width / 3.2, (height - 36) / 2.25);
  return ([east, north, up]) => {
    const depth = (sh * east + ch * north) * ce - se * up;
    const near = size / (1 + depth * 0.13);
    const right = ch * east - sh * north;
    const above = (sh * east + ch * north) * se + ce * up;
    return [width / 2 + right * near, height / 2 + 4 - above * near, depth];
  };
}

// A face in its parts below and above the horizon.
function split(face, above) {
  const kept = [];
  face.forEach((p, i) => {
    const q = face[(i + 1) % face.length];
    const inside = above ? p[2] >= 0 : p[2] <= 0;
    if (inside) kept.push(p);
    if ((p[2] > 0 && q[2] < 0) || (p[2] < 0 && q[2] > 0)) {
      const share = p[2] / (p[2] - q[2]);
      kept.push(p.map((x, k) => x + share * (q[k] - x)));
    }
  });
  return kept.length > 2 ? kept : null;
}

function path(g, points, closed = true) {
  g.beginPath();
  points.forEach(([x, y], i) => (i ? g.lineTo(x, y) : g.moveTo(x, y)));
  if (closed) g.closePath();
}

function shade(face) {
  const [a, b, c] = face;
  const [u, v] = [b, c].map((p) => p.map((x, k) => x - a[k]));
  const normal = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
  const size = Math.hypot(...normal) || 1;
  return 0.62 + 0.3 * Math.abs((0.3 * normal[0] - 0.35 * normal[1] + 0.9 * normal[2]) / size);
}

function paintFaces(g, look, faces, above) {
  const parts = faces.map((face) => ({ part: split(face, above), light: shade(face) })).filter(({ part }) => part);
  const far = (part) => part.reduce((sum, p) => sum + look(p)[2], 0) / part.length;
  parts.sort((a, b) => far(b.part) - far(a.part));
  for (const { part, light } of parts) {
    path(g, part.map(look));
    g.fillStyle = colour.truth;
    g.fill();
    g.fillStyle = `rgba(0,0,0,${(1 - light).toFixed(3)})`;
    g.fill();
    g.strokeStyle = colour.fg;
    g.lineWidth = 0.75;
    g.stroke();
  }
}

const circle = (radius) => Array.from({ length: 72 }, (_, i) => [radius * Math.sin((i * Math.PI) / 36), radius * Math.cos((i * Math.PI) / 36), 0]);

function paintHorizon(g, look) {
  path(g, circle(1.35).map(look));
  g.globalAlpha = 0.55;
  g.fillStyle = colour.line;
  g.fill();
  g.globalAlpha = 1;
  g.strokeStyle = colour.dim;
  g.lineWidth = 1;
  g.stroke();
  circle(1.35).forEach((p, i) => {
    if (i % 6) return;
    const out = i % 18 ? 1.04 : 1.08;
    path(g, [look(p), look(p.map((x) => x * out))], false);
    g.stroke();
  });
}

function arrow(g, from, to, dash) {
  g.setLineDash(dash);
  path(g, [from, to], false);
  g.stroke();
  g.setLineDash([]);
  const [dx, dy] = [to[0] - from[0], to[1] - from[1]];
  const size = Math.hypot(dx, dy);
  if (size < 6) return;
  const [ux, uy] = [dx / size, dy / size];
  path(g, [to, [to[0] - 7 * ux + 3 * uy, to[1] - 7 * uy - 3 * ux], [to[0] - 7 * ux - 3 * uy, to[1] - 7 * uy + 3 * ux]]);
  g.fill();
}

/** A name beside an arrow's end, with the panel's colour around it so that it can be read over anything. */
function label(g, word, from, to) {
  const size = Math.hypot(to[0] - from[0], to[1] - from[1]);
  const out = size > 6 ? 10 / size : 0;
  const [x, y] = [to[0] + (to[0] - from[0]) * out, to[1] + (to[1] - from[1]) * out + (size > 6 ? 0 : -10)];
  g.textAlign = "center";
  g.fillStyle = colour.fg;
  over(g, word, x, y);
}

// The nav axes; their names come last, over the bodies.
function paintNav(g, look, named) {
  const { world, nav } = frameOf();
  nav.forEach((word, k) => {
    const end = world([0, 1, 2].map((i) => (i === k ? 1.5 : 0)));
    const short = end[2] ? end.map((x) => x * 0.72) : end;
    g.strokeStyle = g.fillStyle = colour.dim;
    g.lineWidth = 1;
    g.font = "bold 12px system-ui, sans-serif";
    const ends = [look([0, 0, 0]), look(short)];
    if (named) label(g, word, ...ends);
    else arrow(g, ...ends, []);
  });
}

// The ends of a body's axes in the picture.
function axisEnds(look, rotation) {
  const { world } = frameOf();
  return [0, 1, 2].map((k) => look(world(rotation.map((row) => 1.1 * row[k]))));
}

function paintAxes(g, look, ends, { dash, names, apart }) {
  const origin = look([0, 0, 0]);
  ends.forEach((end, k) => {
    g.strokeStyle = g.fillStyle = colour.axes[k];
    g.lineWidth = dash.length ? 1.5 : 2;
    arrow(g, origin, end, dash);
    const other = apart?.[k];
    if (other && Math.hypot(end[0] - other[0], end[1] - other[1]) < 16) return;
    g.font = "bold 13px system-ui, sans-serif";
    label(g, names[k], origin, end);
  });
}

function paintBodies(g, look, truth, estimate) {
  const { world, body } = frameOf();
  const placed = (rotation, shape) => shape.map((part) => part.map((p) => world(apply(rotation, body(p)))));
  const faces = truth ? placed(truth.rotation, DART.faces) : [];
  const fromAbove = camera.elevation >= 0;
  paintFaces(g, look, faces, !fromAbove);
  paintHorizon(g, look);
  paintNav(g, look, false);
  paintFaces(g, look, faces, fromAbove);
  paintNav(g, look, true);
  const ends = truth && axisEnds(look, truth.rotation);
  if (truth) paintAxes(g, look, ends, { dash: [], names: ["x", "y", "z"] });
  if (!estimate) return;
  g.strokeStyle = colour.estimate;
  g.lineWidth = 2;
  for (const edge of placed(estimate.rotation, DART.edges)) {
    path(g, edge.map(look), false);
    g.stroke();
  }
  const names = truth ? ["x′", "y′", "z′"] : ["x", "y", "z"];
  paintAxes(g, look, axisEnds(look, estimate.rotation), { dash: [4, 3], names, apart: ends });
}

const ANGLES = ["roll", "pitch", "yaw"];
const referenceName = () => (store.about.reference === "reference" ? "reference" : "truth");
const chosenEstimator = () => store.estimators[view.estimator] ?? store.estimators[0] ?? null;

function angleRow(of, name, swatch) {
  const cells = ANGLES.map((angle) => make("td", { [`data-${of}`]: angle }));
  return make("tr", { "data-row": of }, make("th", { scope: "row" }, make("i", { class: `swatch ${swatch}` }), make("span", { text: name })), ...cells);
}

function showAngles(of, attitude, hidden) {
  const row = byId("angles").querySelector(`tr[data-row=${of}]`);
  setHidden(row, hidden);
  ANGLES.forEach((angle, k) => setNumber(row.children[k + 1], fixed(attitude?.euler_deg[k], 2), attitude?.euler_deg[k]));
  const old = attitude?.age_s > 1 ? `${secondsText(attitude.age_s)} old` : "";
  if (row.title !== old) row.title = old;
  row.classList.toggle("old", old !== "");
}

panel("attitude", {
  present: () => store.truth.length > 0 || store.estimators.some(({ attitude }) => attitude.length),
  build() {
    byId("angles").tBodies[0].replaceChildren(angleRow("truth", referenceName(), "solid"), angleRow("estimate", "estimate", "outline"));
    const known = Object.hasOwn(FRAMES, store.about.axes);
    setText(byId("frame"), known ? `${store.about.axes}: ${frameOf().words}` : text(store.about.axes));
  },
  draw(shown) {
    const select = byId("estimator");
    if (select.options.length !== store.estimators.length) {
      setOptions(select, store.estimators.map(({ name }, i) => [i, name]));
      select.value = view.estimator;
    }
    setHidden(select, store.estimators.length < 2);
    const row = byId("angles").querySelector("tr[data-row=estimate] span");
    setText(row, chosenEstimator()?.name || "estimate");
    showAngles("truth", shown.truth, !store.truth.length);
    showAngles("estimate", shown.estimate, !store.estimators.some(({ attitude }) => attitude.length));
    const canvas = byId("bodies");
    const room = surface(canvas);
    if (!room) return;
    paintBodies(room.g, lens(room.width, room.height), shown.truth, shown.estimate);
    const words = (name, attitude) => (attitude ? [`${name}: ${ANGLES.map((angle, k) => `${angle} ${fixed(attitude.euler_deg[k], 1)}°`).join(", ")}`] : []);
    describe(canvas, `Attitude. ${[...words(referenceName(), shown.truth), ...words("estimate", shown.estimate)].join("; ")}`);
  },
});

function turnCamera(canvas) {
  let from = null;
  canvas.addEventListener("pointerdown", (event) => {
    from = [event.clientX, event.clientY];
    canvas.setPointerCapture(event.pointerId);
  });
  canvas.addEventListener("pointermove", (event) => {
    if (!from) return;
    camera.heading -= (event.clientX - from[0]) * 0.5;
    camera.elevation = clamp(camera.elevation + (event.clientY - from[1]) * 0.4, -85, 85);
    from = [event.clientX, event.clientY];
    changed();
  });
  for (const kind of ["pointerup", "pointercancel"]) canvas.addEventListener(kind, () => (from = null));
  canvas.addEventListener("dblclick", () => {
    Object.assign(camera, HOME);
    changed();
  });
}
turnCamera(byId("bodies"));
byId("estimator").addEventListener("change", (event) => {
  view.estimator = Number(event.target.value);
  changed();
});
