// Where messages come from: a report has them in the page, a live page from the socket beside it.

const AGAIN_MS = 2000;

function startReport(element) {
  view.report = true;
  list(JSON.parse(element.textContent)).forEach(receive);
  changed(true);
}

function liveAddress() {
  const address = new URL("live", location.href);
  address.protocol = location.protocol === "https:" ? "wss:" : "ws:";
  const token = new URLSearchParams(location.search).get("token");
  address.search = token === null ? "" : new URLSearchParams({ token }).toString();
  address.hash = "";
  return address.href;
}

function setConnection(state) {
  connection.state = state;
  changed();
}

function connect() {
  const socket = new WebSocket(liveAddress(), "ratetable.v1");
  socket.addEventListener("open", () => setConnection("connected"));
  socket.addEventListener("message", ({ data }) => {
    try {
      receive(JSON.parse(data));
    } catch {
      return; // not a message of ours
    }
    dataChanged();
  });
  socket.addEventListener("close", () => {
    if (store.end) return setConnection("ended");
    setConnection("lost");
    setTimeout(connect, AGAIN_MS);
  });
}

const messages = byId("messages");
if (messages) startReport(messages);
else if (location.protocol.startsWith("http")) connect();
else setConnection("refused");
