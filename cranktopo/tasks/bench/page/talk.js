// Talk with the server: one drag is on its way at a time, the newest follows.
import { $ } from "./base.js";
import { state } from "./state.js";

// Numbers of drags: the last one made, sent, answered; and what waits.
export const line = { seq: 0, sent: 0, answered: 0, waiting: null };
let socket = null;

export function connect(hear) {
  const address = new URL("talk", location.href);
  address.protocol = "ws:";
  socket = new WebSocket(address);
  socket.onopen = () => {
    status("Ready");
    line.sent = line.answered = 0;
    line.waiting = null;
    say({ do: "hello" });
  };
  socket.onmessage = (event) => hear(JSON.parse(event.data));
  socket.onclose = () => {
    status("The bench has ended or is out of reach; trying again");
    setTimeout(() => connect(hear), 1500);
  };
}

export const say = (message) => socket && socket.readyState === 1 && socket.send(JSON.stringify(message));
export const status = (text) => ($("status").textContent = text);

// Says what is wrong, or calmly what is worth knowing; nothing takes it away.
export function complain(text, calm = false) {
  $("message").className = calm ? "calm" : "";
  $("message").hidden = !text;
  $("message").querySelector("span").textContent = text || "";
}

// The server has answered a drag, or passed over it for a newer question: the next may go.
export function answered(seq) {
  line.answered = Math.max(line.answered, seq);
  next();
}

export function drag(changes) {
  if (!state.dragging) status("Moving");
  state.dragging = true;
  line.waiting = changes;
  next();
}

function next() {
  if (!line.waiting || line.answered < line.sent) return;
  line.sent = ++line.seq;
  say({ do: "drag", changes: line.waiting, seq: line.seq, keep_pitch: state.keepPitch });
  line.waiting = null;
}

// Takes a step; what was dragged goes to the nearest value that keeps the rules, what was typed is taken or refused.
export function edit(changes, what, dragged = false) {
  line.waiting = null;
  state.dragging = false;
  say({ do: "edit", changes, what, snap: dragged, keep_pitch: state.keepPitch });
}
