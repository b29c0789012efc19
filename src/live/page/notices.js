// What has been noticed, the newest first.

let noticesShown = -1;

panel("notices", {
  present: () => store.notices.length > 0,
  build: () => (noticesShown = -1),
  draw() {
    if (noticesShown === store.noticed) return;
    noticesShown = store.noticed;
    const lines = store.notices.map(({ t, text: words }) => make("li", {}, make("time", { text: isNumber(t) ? secondsText(t) : "" }), make("span", { text: words })));
    byId("notice-list").replaceChildren(...lines.reverse());
  },
});
