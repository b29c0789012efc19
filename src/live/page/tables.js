// What stands at the end: a verdict, figures, tables, and grids of verdicts.

const VERDICTS = { stable: ["good", "✓"], ok: ["good", "✓"], passed: ["good", "✓"], degraded: ["fair", "≈"], fails: ["poor", "✗"], failed: ["poor", "✗"] };

function showEnd() {
  const end = store.end;
  const banner = byId("verdict");
  setHidden(banner, !end);
  for (const id of ["figures", "tables", "grids"]) byId(id).replaceChildren();
  for (const [id, parts] of [["figures", end?.figures], ["tables", end?.tables], ["grids", end?.grids]]) setHidden(byId(id), !list(parts).length);
  showCharts(list(end?.charts).map(record));
  if (!end) return;
  const failed = list(end.failed).map(text);
  const ok = end.ok !== false;
  banner.className = `banner ${ok ? "good" : "poor"}`;
  banner.dataset.ok = String(ok);
  const what = failed.length ? make("ul", {}, ...failed.map((line) => make("li", { text: line }))) : "";
  banner.replaceChildren(make("b", { text: ok ? "✓ ended well" : "✗ failed" }), what);
  byId("figures").append(...list(end.figures).map(record).map(newFigure));
  byId("tables").append(...list(end.tables).map(record).map(newTable));
  byId("grids").append(...list(end.grids).map(record).map(newGrid));
}

function newFigure(figure) {
  const unit = text(figure.unit);
  const value = make("span", { class: "value", "data-figure": text(figure.label), text: text(figure.value) });
  return make("div", { class: "figure" }, make("div", { class: "dim", text: text(figure.label) }), make("div", {}, value, make("span", { class: "dim", text: unit ? ` ${unit}` : "" })));
}

const looksNumeric = (word) => /^[-−+]?[\d.]/.test(word);

function newTable(table) {
  const heading = list(table.heading).map((word) => make("th", { scope: "col", text: text(word) }));
  const rowOf = (row) => make("tr", {}, ...list(row).map((cell) => make("td", { class: looksNumeric(text(cell)) ? null : "words", text: text(cell) })));
  const body = make("tbody", {}, ...list(table.rows).map(rowOf));
  const made = make("table", { "data-table": text(table.title) }, make("thead", {}, make("tr", {}, ...heading)), body);
  return make("section", { class: "panel" }, make("h2", { text: text(table.title) }), make("div", { class: "scroll" }, made));
}

function newGrid(grid) {
  const heading = ["", ...list(grid.columns)].map((word) => make("th", { scope: "col", text: text(word) }));
  const cellOf = (cell) => {
    const verdict = text(record(cell).verdict);
    const [look, symbol] = VERDICTS[verdict] ?? ["none", "·"];
    const words = text(record(cell).text);
    return make("td", { class: `cell ${look}`, "data-verdict": verdict, title: `${verdict}${words ? `: ${words}` : ""}`, tabindex: "0" }, `${symbol} ${verdict}`);
  };
  const rowOf = (row) => make("tr", {}, make("th", { scope: "row", text: text(row.name) }), ...list(row.cells).map(cellOf));
  const made = make("table", { class: "grid", "data-grid": text(grid.title) }, make("thead", {}, make("tr", {}, ...heading)), make("tbody", {}, ...list(grid.rows).map(record).map(rowOf)));
  const detail = make("p", { class: "dim detail", "aria-live": "polite", text: "Point at a cell to read more." });
  const tell = (event) => {
    const cell = event.target.closest("td");
    if (cell) setText(detail, `${cell.parentElement.firstChild.textContent}, ${heading[cell.cellIndex]?.textContent ?? ""}: ${cell.title}`);
  };
  made.addEventListener("pointerover", tell);
  made.addEventListener("focusin", tell);
  return make("section", { class: "panel" }, make("h2", { text: text(grid.title) }), make("div", { class: "scroll" }, made), detail);
}
