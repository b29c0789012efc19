// Keys and buttons: each does one thing with the view.

const ACTIONS = {
  " ": pauseOrGoOn,
  "+": () => zoom(-1),
  "=": () => zoom(-1),
  "-": () => zoom(1),
  ArrowLeft: () => step(-1),
  ArrowRight: () => step(1),
  f: follow,
  "?": () => byId("help").open || byId("help").showModal(),
};

document.addEventListener("keydown", (event) => {
  if (event.ctrlKey || event.altKey || event.metaKey || byId("help").open) return;
  const target = event.target;
  if (target.matches?.("select") || (event.key === " " && target.matches?.("button, [type=checkbox]"))) return;
  if (event.key.startsWith("Arrow") && target.matches?.("[type=range]")) return;
  const digit = /^[1-9]$/.test(event.key) ? () => toggleSensor(Number(event.key) - 1) : null;
  const action = digit ?? (Object.hasOwn(ACTIONS, event.key) ? ACTIONS[event.key] : null);
  if (!action) return;
  event.preventDefault();
  action();
  changed();
});

/** After a click with a pointer the space bar is the view's again. */
function letGo(event) {
  if (event.detail) event.currentTarget.blur();
}

function onClick(id, action) {
  byId(id).addEventListener("click", (event) => {
    action();
    letGo(event);
    changed();
  });
}
onClick("pause", pauseOrGoOn);
onClick("follow", follow);
onClick("closer", () => zoom(-1));
onClick("wider", () => zoom(1));
onClick("back", () => (hold(), step(-1)));
onClick("forth", () => (hold(), step(1)));
onClick("ask", ACTIONS["?"]);

byId("slider").addEventListener("input", (event) => {
  hold();
  goTo(store.t0 + (Number(event.target.value) / 1000) * (view.end - store.t0));
  changed();
});
byId("pace").addEventListener("change", (event) => (view.pace = Number(event.target.value)));

// Light or dark is the system's choice until the button is pressed.
const dark = matchMedia("(prefers-color-scheme: dark)");
let darkChosen = null;

function setTheme() {
  document.documentElement.dataset.theme = (darkChosen ?? dark.matches) ? "dark" : "light";
  readColours();
  changed(true);
}
dark.addEventListener("change", setTheme);
byId("theme").addEventListener("click", () => {
  darkChosen = !(darkChosen ?? dark.matches);
  setTheme();
});
