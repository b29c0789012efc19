// What each link has carried, and what it lost.

const LINK_FIELDS = [
  ["packets", "packets", (n) => fixed(n, 0)],
  ["bytes", "bytes", bytesText],
  ["bytes_per_s", "a second", bytesText],
  ["dropped", "dropped", (n) => fixed(n, 0)],
  ["queued", "queued", (n) => fixed(n, 0)],
  ["received_bytes", "received", bytesText],
  ["damaged", "damaged", (n) => fixed(n, 0)],
];
const BAD = ["dropped", "damaged"];
let linkRows = [];

function newLinkRow(found, i) {
  const cells = LINK_FIELDS.map(([field, name]) => {
    const value = make("dd", { "data-link": i, "data-field": field });
    return { field, value, element: make("div", {}, make("dt", { text: name }), value) };
  });
  return { found, cells, element: make("div", { class: "link" }, make("h3", { text: found.name }), make("dl", {}, ...cells.map(({ element }) => element))) };
}

panel("links", {
  present: () => store.links.some(({ now }) => now),
  build: () => (linkRows = []),
  draw() {
    if (linkRows.length !== store.links.length) {
      linkRows = store.links.map(newLinkRow);
      byId("link-list").replaceChildren(...linkRows.map(({ element }) => element));
    }
    for (const { found, cells } of linkRows) {
      for (const [k, { field, value, element }] of cells.entries()) {
        const x = field === "bytes_per_s" ? found.bytes_per_s : found.now?.[field];
        setHidden(element, !isNumber(x));
        setNumber(value, LINK_FIELDS[k][2](x), x);
        value.classList.toggle("bad", BAD.includes(field) && x > 0);
      }
    }
  },
});
