// Locks: whether `shape` keeps a dimension or may change it within a range of `[shape.free]`.
import { make } from "./base.js";
import { state, valueAt } from "./state.js";
import { edit, say } from "./talk.js";

// Of a dimension that has a lock: its key, the key of its range, and the range where it is free. Those of the web's own outline have none.
export const lockOf = (key) => state.ranges[key] && { key, range: state.ranges[key], limits: valueAt(state.ranges[key]) };

export const lockTitle = ({ limits }) => (limits ? `shape may change it from ${limits[0]} to ${limits[1]}. Press: it stays as it is` : "Stays as it is in shape. Press: shape may change it within a range");

export const toggleLock = ({ key, range, limits }, name) => (limits ? edit({ [range]: null }, `${name}: stays as it is`) : say({ do: "free", key }));

// A padlock in a square of 16, its bow open where the dimension is free.
export const lockShape = (open) => [make("rect", { x: 3, y: 7, width: 10, height: 7, rx: 1.5 }), make("path", { d: open ? "M5 7V4.5a3 3 0 0 1 5.8-1" : "M5 7V4.5a3 3 0 0 1 6 0V7" })];
