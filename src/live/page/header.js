// The first lines: what is shown, how far it is, and whether the page still hears of it.

const connection = { state: "connecting" };
const CONNECTIONS = {
  connecting: "○ connecting", connected: "● connected", ended: "■ ended", lost: "✗ connection lost, trying again",
  refused: "✗ no connection", report: "■ report",
};

function setChip(id, words) {
  setText(byId(id), words);
  setHidden(byId(id), !words);
}

function showHeader(shown) {
  const { about } = store;
  const title = text(about.title) || "ratetable";
  setText(byId("title"), title);
  const page = `${title} – ratetable`;
  if (document.title !== page) document.title = page;
  setChip("command", text(about.command));
  setChip("phase", store.end || view.report ? "" : store.phase);
  byId("phase").dataset.phase = store.phase;
  const { duration_s: duration, speed } = about;
  setHidden(byId("clock"), !isNumber(shown.t));
  setNumber(byId("now"), secondsText(shown.t), shown.t);
  setText(byId("duration"), isNumber(duration) ? ` of ${secondsText(duration, Number.isInteger(duration) ? 0 : 1)}` : "");
  setChip("speed", speed === "max" ? "as fast as it goes" : isNumber(speed) && speed !== 1 ? `speed ${significant(speed)}` : isNumber(speed) ? "real time" : "");
  setChip("lost", store.lost > 0 ? `${fixed(store.lost, 0)} messages lost by this page` : "");
  const state = store.end ? (view.report ? "report" : "ended") : connection.state;
  setText(byId("connection"), CONNECTIONS[state] ?? state);
  byId("connection").dataset.state = state;
  const waiting = !store.end && (store.waiting || (store.phase === "waiting" ? "waiting" : ""));
  setText(byId("waiting"), waiting || "");
  setHidden(byId("waiting"), !waiting);
  setHidden(document.querySelector("#help p:last-of-type"), !isLive());
}
