// Small helpers of the page. All text from files and designs is set as text, never as markup.

export const $ = (id) => document.getElementById(id);
export const make = (tag, attributes = {}, ...children) => {
  const node = document.createElementNS(SVG.has(tag) ? "http://www.w3.org/2000/svg" : "http://www.w3.org/1999/xhtml", tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (name.startsWith("on")) node.addEventListener(name.slice(2), value);
    else if (value === true) node.setAttribute(name, "");
    else if (value !== false && value !== undefined && value !== null) node.setAttribute(name, value);
  }
  node.append(...children);
  return node;
};
const SVG = new Set(["svg", "path", "circle", "line", "text", "g", "title", "rect"]);

// A number as people write it: decimal point or comma.
export function numberOf(text) {
  if (/,\s/.test(text)) return null; // a list
  const plain = text.trim().replace(/\s/g, "").replace(/^([+-]?\d+),(\d+)$/, "$1.$2");
  return /^[+-]?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?$/i.test(plain) ? Number(plain) : null;
}

// Units by the last words of a name, as the server has them.
let units = {}, unit = /$^/;
export function takeUnits(found) {
  units = found;
  unit = new RegExp(`_(${Object.keys(found).join("|")})$`);
}

export const words = (name) => name.replace(unit, "").replaceAll("_", " ");

export const shown = (value) => (typeof value === "number" ? String(Number(value.toPrecision(6))) : typeof value === "string" ? value : JSON.stringify(value));

export const lower = (label) => (/^[A-Z][A-Z]/.test(label) ? label : label[0].toLowerCase() + label.slice(1));

export const unitOf = (key) => units[unit.exec(key)?.[1]] ?? "";

export const plain = (value, digits) => (value === undefined || value === null ? "" : Math.abs(value) >= 1e5 ? Math.round(value).toLocaleString("en") : String(Number(value.toPrecision(digits))));

// A change with the decimals that show its sign; one that is none has no minus.
export const signed = (change, unit = "%") => {
  const size = Math.abs(change), digits = size >= 10 ? 0 : [1, 2, 3, 4].find((n) => Number(size.toFixed(n))) ?? 1;
  return `${change < 0 && Number(size.toFixed(digits)) ? "−" : "+"}${size.toFixed(digits)}\u00a0${unit}`;
};
