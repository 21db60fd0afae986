"use strict";
// The points of a sweep: scatter, parallel coordinates, filters and table show the same choice of them.
(() => {
  const data = JSON.parse(document.getElementById("sweep-data").textContent);
  const { columns, rows, about, original, picks } = data;
  const webs = JSON.parse(document.getElementById("sweep-webs").textContent);
  const viewer = document.getElementById("viewer");
  const one = (query) => document.querySelector(query);
  const front = new Set(data.front);
  const coarse = new Set(data.coarse); // a first look reads too stiff: it is on no front
  const isNumber = (value) => typeof value === "number";
  const signed = (percent) => { // with the decimals that show its sign
    const shown = [1, 2, 3, 4].map((n) => percent.toFixed(n)).find(Number) ?? "0.0";
    return `${percent < 0 && Number(shown) ? "" : "+"}${shown}`;
  };
  const numeric = columns.map((_, c) => rows.some((row) => isNumber(row[c])) && rows.every((row) => row[c] === null || isNumber(row[c])));
  const numbers = columns.map((_, c) => c).filter((c) => numeric[c]);
  const nameOf = (c) => columns[c].label + (columns[c].unit ? `, ${columns[c].unit}` : "");
  // Large numbers without decimals in groups of three; keys of the scene keep what was given.
  const number = (value, digits) => Math.abs(value) >= 1e4 ? Math.round(Number(value.toPrecision(digits))).toLocaleString("en-US") : Number(value.toPrecision(digits)).toString();
  const text = (value, c) => value === null || value === undefined ? "-" : isNumber(value) ? number(value, columns[c]?.varied ? 6 : 4) : value;
  const escaped = (value) => String(value).replace(/[&<>"]/g, (c) => ({ "&": "&amp;", "<": "&lt;", ">": "&gt;", '"': "&quot;" })[c]);
  const state = { x: 0, y: 0, colour: -1, sort: -1, up: true, shown: null, kept: null, rows: 60, filters: new Map() };

  const visible = (i) => {
    for (const [c, wanted] of state.filters) {
      const value = rows[i][c];
      if (typeof wanted === "string" ? String(value) !== wanted : value === null || value < wanted[0] || value > wanted[1]) return false;
    }
    return true;
  };
  let seen = rows.map(() => true);

  // Axes ---------------------------------------------------------------------------------------------------
  const extent = (c, extra = [], among = rows) => {
    const values = among.map((row) => row[c]).concat(extra).filter(isNumber);
    if (!values.length) return [0, 1];
    const low = Math.min(...values), high = Math.max(...values), pad = (high - low || Math.abs(high) || 1) * 0.05;
    return [low - pad, high + pad];
  };
  const ticks = ([low, high], most) => {
    const raw = (high - low) / most, power = 10 ** Math.floor(Math.log10(raw));
    const step = [1, 2, 5, 10].find((n) => n * power >= raw) * power;
    const found = [];
    for (let n = Math.ceil(low / step); n * step <= high; n++) found.push(Number((n * step).toPrecision(12)));
    return found;
  };
  const hue = (share) => `hsl(${Math.round(255 - 215 * share)} 70% 52%)`;

  // Scatter ------------------------------------------------------------------------------------------------
  let places = [];
  let toScreen = null;
  function errorBars(i) {
    const row = rows[i], { x, y } = state, { px, py } = toScreen;
    if (!isNumber(row[x]) || !isNumber(row[y])) return "";
    const [ex, ey] = [x, y].map((c) => columns[c].error === null ? 0 : (row[columns[c].error] || 0) / 100 * row[c]);
    const bar = (x1, x2, y1, y2) => `<line class="error" data-i="${i}" x1="${px(x1)}" x2="${px(x2)}" y1="${py(y1)}" y2="${py(y2)}"/>`;
    return (ex ? bar(row[x] - ex, row[x] + ex, row[y], row[y]) : "") + (ey ? bar(row[x], row[x], row[y] - ey, row[y] + ey) : "");
  }
  function drawScatter() {
    const holder = one("[data-scatter]");
    const width = Math.max(300, holder.clientWidth), height = Math.min(520, Math.max(300, width * 0.6));
    const box = { left: 78, right: width - 14, top: 12, bottom: height - 44 };
    const { x, y, colour } = state;
    const boundOf = (c) => columns[c].bound === null ? [] : [columns[c].bound];
    const xs = extent(x, [original[x], ...boundOf(x)]), ys = extent(y, [original[y], ...boundOf(y)]);
    const px = (v) => box.left + (v - xs[0]) / (xs[1] - xs[0]) * (box.right - box.left);
    const py = (v) => box.bottom - (v - ys[0]) / (ys[1] - ys[0]) * (box.bottom - box.top);
    toScreen = { px, py };
    const parts = [];
    for (const v of ticks(xs, width / 110)) parts.push(`<line class="grid" x1="${px(v)}" x2="${px(v)}" y1="${box.top}" y2="${box.bottom}"/><text class="tick" x="${px(v)}" y="${box.bottom + 16}" text-anchor="middle">${number(v, 12)}</text>`);
    for (const v of ticks(ys, height / 60)) parts.push(`<line class="grid" x1="${box.left}" x2="${box.right}" y1="${py(v)}" y2="${py(v)}"/><text class="tick" x="${box.left - 6}" y="${py(v) + 4}" text-anchor="end">${number(v, 12)}</text>`);
    parts.push(`<text x="${(box.left + box.right) / 2}" y="${height - 8}" text-anchor="middle">${escaped(nameOf(x))}</text>`);
    parts.push(`<text transform="translate(13 ${(box.top + box.bottom) / 2}) rotate(-90)" text-anchor="middle">${escaped(nameOf(y))}</text>`);
    for (const v of boundOf(x)) parts.push(`<line class="bound" x1="${px(v)}" x2="${px(v)}" y1="${box.top}" y2="${box.bottom}"/>`);
    for (const v of boundOf(y)) parts.push(`<line class="bound" x1="${box.left}" x2="${box.right}" y1="${py(v)}" y2="${py(v)}"/>`);
    one("[data-bound]").hidden = !boundOf(x).length && !boundOf(y).length;
    const drawn = rows.filter((row) => isNumber(row[x]) && isNumber(row[y]));
    const range = colour < 0 ? null : extent(colour, [], drawn);
    places = [];
    const dots = [];
    rows.forEach((row, i) => {
      if (!isNumber(row[x]) || !isNumber(row[y])) return;
      const cx = px(row[x]), cy = py(row[y]);
      places.push({ i, cx, cy });
      const fill = range && isNumber(row[colour]) ? ` style="fill:${hue((row[colour] - range[0]) / (range[1] - range[0]))}"` : "";
      const dot = `<circle data-i="${i}" cx="${cx.toFixed(1)}" cy="${cy.toFixed(1)}" r="${front.has(i) ? 5 : 4}"${fill} class="${front.has(i) ? "front" : ""}"/>`;
      front.has(i) ? dots.push(dot) : dots.unshift(dot);
    });
    parts.push(`<path class="line" data-front/>`, ...data.front.map(errorBars), ...dots);
    if (isNumber(original[x]) && isNumber(original[y])) {
      const [ox, oy] = [px(original[x]), py(original[y])];
      parts.push(`<path class="original" d="M${ox - 7} ${oy - 7}L${ox + 7} ${oy + 7}M${ox - 7} ${oy + 7}L${ox + 7} ${oy - 7}"><title>original</title></path>`);
    }
    parts.push(`<g data-mark></g>`);
    holder.innerHTML = `<svg viewBox="0 0 ${width} ${height}" role="img" aria-label="${escaped(nameOf(y))} over ${escaped(nameOf(x))} of ${places.length} points">${parts.join("")}</svg>`;
    const ramp = one("[data-ramp]");
    ramp.hidden = !range;
    if (range) {
      const values = drawn.map((row) => row[colour]).filter(isNumber);
      ramp.innerHTML = `<span class="swatch" style="width:5rem;background:linear-gradient(90deg,${[0, .25, .5, .75, 1].map(hue)})"></span>${escaped(nameOf(colour))}: ${text(Math.min(...values), colour)} to ${text(Math.max(...values), colour)}`;
    }
    filterScatter();
  }

  // The best that the visible points reach in the two quantities, as steps from one of them to the next.
  function frontLine() {
    const { x, y } = state, sx = columns[x].sense, sy = columns[y].sense;
    if (!sx || !sy || x === y) return "";
    const sorted = places.filter(({ i }) => seen[i] && !coarse.has(i)).sort((a, b) => sx * (rows[b.i][x] - rows[a.i][x]) || sy * (rows[b.i][y] - rows[a.i][y]));
    let best = -Infinity;
    const line = [];
    for (const place of sorted) if (sy * rows[place.i][y] > best) { best = sy * rows[place.i][y]; line.push(place); }
    return line.map(({ cx, cy }, n) => n ? `L${cx.toFixed(1)} ${line[n - 1].cy.toFixed(1)}L${cx.toFixed(1)} ${cy.toFixed(1)}` : `M${cx.toFixed(1)} ${cy.toFixed(1)}`).join("");
  }
  function filterScatter() {
    for (const dot of document.querySelectorAll("[data-scatter] [data-i]")) dot.classList.toggle("out", !seen[dot.dataset.i]);
    one("[data-front]").setAttribute("d", frontLine());
    mark();
  }

  // Parallel coordinates -----------------------------------------------------------------------------------
  const lanes = numbers.filter((c) => new Set(rows.map((row) => row[c])).size > 1 && (columns[c].varied || columns[c].sense));
  let laneAt = null;
  function drawParallel() {
    const holder = one("[data-parallel]");
    const width = Math.max(736, holder.clientWidth, lanes.length * 92), height = 330, top = 58, bottom = height - 26;
    const lx = (n) => lanes.length < 2 ? width / 2 : 58 + n * (width - 116) / (lanes.length - 1);
    const ranges = lanes.map((c) => extent(c));
    const ly = (n, v) => bottom - (v - ranges[n][0]) / (ranges[n][1] - ranges[n][0]) * (bottom - top);
    const path = (row) => {
      let d = "", pen = "M";
      lanes.forEach((c, n) => { if (isNumber(row[c])) { d += `${pen}${lx(n).toFixed(1)} ${ly(n, row[c]).toFixed(1)}`; pen = "L"; } else pen = "M"; });
      return d;
    };
    const order = rows.map((_, i) => i).sort((a, b) => front.has(a) - front.has(b));
    const parts = order.map((i) => `<path data-i="${i}" class="row${front.has(i) ? " front" : ""}" d="${path(rows[i])}"/>`);
    lanes.forEach((c, n) => {
      const label = columns[c].label.split(".").pop(), [low, high] = extent(c);
      parts.push(`<line class="axis" x1="${lx(n)}" x2="${lx(n)}" y1="${top}" y2="${bottom}"/><text x="${lx(n)}" y="${22 + 14 * (n % 2)}" text-anchor="middle">${escaped(label)}<title>${escaped(nameOf(c))}</title></text><text class="tick" x="${lx(n)}" y="${top - 5}" text-anchor="middle">${number(high, 4)}</text><text class="tick" x="${lx(n)}" y="${bottom + 16}" text-anchor="middle">${number(low, 4)}</text><rect class="brush" data-brush="${c}" x="${lx(n) - 6}" width="12" height="0"/><rect class="grip" data-lane="${n}" x="${lx(n) - 16}" y="${top}" width="32" height="${bottom - top}"/>`);
    });
    parts.push(`<path class="shown" data-path/>`);
    holder.innerHTML = `<svg viewBox="0 0 ${width} ${height}" style="min-width:${Math.min(width, 46 * 16)}px" role="img" aria-label="Parallel coordinates of ${lanes.length} quantities">${parts.join("")}</svg>`;
    laneAt = { path, ly, value: (n, y) => ranges[n][0] + (bottom - y) / (bottom - top) * (ranges[n][1] - ranges[n][0]) };
    filterParallel();
  }
  function filterParallel() {
    for (const path of document.querySelectorAll("[data-parallel] path.row")) path.classList.toggle("out", !seen[path.dataset.i]);
    lanes.forEach((c, n) => {
      const brush = one(`[data-brush="${c}"]`), range = state.filters.get(c), [low, high] = extent(c);
      const [from, to] = range ? [Math.max(low, range[0]), Math.min(high, range[1])] : [0, 0];
      brush.setAttribute("y", range ? laneAt.ly(n, to) : 0);
      brush.setAttribute("height", range ? Math.max(2, laneAt.ly(n, from) - laneAt.ly(n, to)) : 0);
    });
    mark();
  }
  one("[data-parallel]").addEventListener("pointerdown", (event) => {
    const n = event.target.dataset.lane;
    if (n === undefined) return;
    const svg = one("[data-parallel] svg"), c = lanes[n];
    const at = (e) => { const r = svg.getBoundingClientRect(); return laneAt.value(n, (e.clientY - r.top) / r.height * svg.viewBox.baseVal.height); };
    const begin = at(event), beginY = event.clientY;
    const move = (e) => {
      if (Math.abs(e.clientY - beginY) < 4) return;
      const end = at(e);
      setFilter(c, [Math.min(begin, end), Math.max(begin, end)]);
    };
    const stop = (e) => {
      if (Math.abs(e.clientY - beginY) < 4) setFilter(c, null);
      removeEventListener("pointermove", move);
      removeEventListener("pointerup", stop);
    };
    addEventListener("pointermove", move);
    addEventListener("pointerup", stop);
    event.preventDefault();
  });

  // Filters ------------------------------------------------------------------------------------------------
  const filtered = columns.map((_, c) => c).filter((c) => new Set(rows.map((row) => row[c]).filter((value) => value !== null)).size > 1);
  function drawFilters() {
    one("[data-filters]").innerHTML = filtered.map((c) => {
      if (!numeric[c]) {
        const values = [...new Set(rows.map((row) => String(row[c])))];
        return `<fieldset><legend>${escaped(nameOf(c))}</legend><select data-filter="${c}" aria-label="${escaped(nameOf(c))}"><option value="">all</option>${values.map((v) => `<option>${escaped(v)}</option>`).join("")}</select></fieldset>`;
      }
      const values = rows.map((row) => row[c]).filter(isNumber);
      const field = (end, value) => `<input type="number" step="any" data-filter="${c}" data-end="${end}" placeholder="${text(value, c)}" aria-label="${escaped(nameOf(c))}, ${end ? "at most" : "at least"}">`;
      return `<fieldset><legend>${escaped(nameOf(c))}</legend>${field(0, Math.min(...values))} to ${field(1, Math.max(...values))}</fieldset>`;
    }).join("");
  }
  one("[data-filters]").addEventListener("input", (event) => {
    const c = Number(event.target.dataset.filter);
    if (!numeric[c]) return setFilter(c, event.target.value || null);
    const [from, to] = [0, 1].map((end) => one(`[data-filter="${c}"][data-end="${end}"]`).value);
    setFilter(c, from === "" && to === "" ? null : [from === "" ? -Infinity : Number(from), to === "" ? Infinity : Number(to)], true);
  });
  one("[data-clear]").addEventListener("click", () => { state.filters.clear(); drawFilters(); refresh(); });
  function setFilter(c, wanted, typed = false) {
    wanted === null ? state.filters.delete(c) : state.filters.set(c, wanted);
    if (!typed && numeric[c]) [0, 1].forEach((end) => {
      const field = one(`[data-filter="${c}"][data-end="${end}"]`);
      if (field) field.value = wanted === null || !isFinite(wanted[end]) ? "" : Number(wanted[end].toPrecision(5));
    });
    refresh();
  }
  function refresh() {
    seen = rows.map((_, i) => visible(i));
    one("[data-count]").textContent = `${seen.filter(Boolean).length} of ${rows.length} points`;
    filterScatter();
    filterParallel();
    drawTable();
  }

  // Table --------------------------------------------------------------------------------------------------
  const withReason = about.some(([, , , reason]) => reason);
  function drawHead() {
    const head = (c, label, unit) => `<th scope="col"${c === -1 || (c >= 0 && !numeric[c]) ? ' class="text"' : ""} aria-sort="${state.sort === c ? (state.up ? "ascending" : "descending") : "none"}"><button type="button" data-sort="${c}">${escaped(label)}</button>${unit ? ` <small>${escaped(unit)}</small>` : ""}</th>`;
    one("[data-table] thead").innerHTML = `<tr>${head(-1, "point", "")}${columns.map((col, c) => head(c, col.label, col.unit)).join("")}${withReason ? '<th scope="col" class="text">how it ended</th>' : ""}</tr>`;
  }
  function ordered() {
    const list = rows.map((_, i) => i).filter((i) => seen[i]), { sort, up } = state;
    if (sort < 0) return up ? list : list.reverse();
    const sign = up ? 1 : -1;
    return list.sort((a, b) => {
      const [u, v] = [rows[a][sort], rows[b][sort]];
      if (u === null || v === null) return (u === null) - (v === null) || a - b;
      return sign * (u < v ? -1 : u > v ? 1 : 0) || a - b;
    });
  }
  function drawTable() {
    const cells = (row) => row.map((value, c) => `<td${numeric[c] ? "" : ' class="text"'}>${escaped(text(value, c))}</td>`).join("");
    const list = ordered();
    const lines = list.slice(0, state.rows).map((i) => `<tr data-i="${i}" tabindex="0" class="${front.has(i) ? "front" : ""}"><th scope="row">${escaped(about[i][0])}</th>${cells(rows[i])}${withReason ? `<td class="reason">${escaped(about[i][3] ? `${about[i][1]}: ${about[i][3]}` : about[i][1])}</td>` : ""}</tr>`);
    one("[data-table] tbody").innerHTML = `<tr class="base"><th scope="row">original</th>${cells(original)}${withReason ? "<td></td>" : ""}</tr>${lines.join("")}`;
    one("[data-more]").hidden = list.length <= state.rows;
    mark();
  }
  one("[data-more]").addEventListener("click", () => { state.rows += 200; drawTable(); });
  one("[data-table] thead").addEventListener("click", (event) => {
    const button = event.target.closest("[data-sort]");
    if (!button) return;
    const c = Number(button.dataset.sort);
    [state.sort, state.up] = [c, state.sort === c ? !state.up : !(c >= 0 && columns[c].sense > 0)];
    drawHead();
    drawTable();
    one(`[data-sort="${c}"]`).focus();
  });

  // The point in view --------------------------------------------------------------------------------------
  let markedRow = null;
  function mark() {
    const i = state.shown ?? state.kept, group = one("[data-mark]"), path = one("[data-path]");
    if (!group || !path) return;
    const row = i === null ? null : rows[i], { x, y } = state;
    let drawn = "";
    if (row && isNumber(row[x]) && isNumber(row[y])) {
      const { px, py } = toScreen, cx = px(row[x]), cy = py(row[y]);
      drawn = `${errorBars(i)}<circle class="ring" style="fill:none" cx="${cx}" cy="${cy}" r="8"/>`;
    }
    group.innerHTML = drawn;
    path.setAttribute("d", row ? laneAt.path(row) : "");
    markedRow?.classList.remove("shown");
    markedRow = i === null ? null : one(`[data-table] tr[data-i="${i}"]`);
    markedRow?.classList.add("shown");
    showWeb(i);
    one("[data-detail]").innerHTML = row ? details(i, row) : '<div class="title screen">Point at the plots or at a row of the table to see all values of a point.</div>';
  }
  let viewed = null;
  async function showWeb(i) {
    if (!viewer?.show || viewed === i) return;
    viewed = i;
    const missing = i !== null && !webs[i];
    const why = missing && (about[i][1] === "done" ? "not in this page, which would be too large" : about[i][1]);
    viewer.classList.toggle("missing", missing);
    one("[data-web-of]").textContent = i === null ? "original web" : missing ? `no web: ${why}` : `web of ${about[i][0]}`;
    if (await viewer.show(i === null ? null : webs[i])) viewer.dataset.web = i ?? "";
  }
  viewer?.addEventListener("ready", async () => {
    mark();
    for (const button of document.querySelectorAll("[data-pick]")) {
      const web = webs[picks[button.dataset.pick][1]], picture = button.querySelector("img");
      if (web) [picture.src, picture.hidden] = [await viewer.picture(web), false];
    }
    viewer.dataset.pictures = "";
  });
  function details(i, row) {
    const [id, status, run, reason] = about[i];
    const change = (c) => isNumber(row[c]) && isNumber(original[c]) && original[c] && !columns[c].varied ? ` (${signed(100 * (row[c] / original[c] - 1))} %)` : "";
    const shown = columns.map((_, c) => c).filter((c) => row[c] !== null);
    const title = `${id}, ${status}${front.has(i) ? ", on the front" : ""}${run ? `, ${run}` : ""}${reason ? `: ${reason}` : ""}`;
    return `<div class="title">${escaped(title)}</div>` + shown.map((c) => `<div><dt>${escaped(nameOf(c))}</dt><dd>${escaped(text(row[c], c))}${columns[c].sense ? change(c) : ""}</dd></div>`).join("");
  }
  const show = (i) => { if (state.shown !== i) { state.shown = i; mark(); } };
  const keep = (i) => { state.kept = state.kept === i ? null : i; state.shown = null; mark(); };
  const nearest = (event) => {
    const svg = one("[data-scatter] svg"), r = svg.getBoundingClientRect(), scale = svg.viewBox.baseVal.width / r.width;
    const [x, y] = [(event.clientX - r.left) * scale, (event.clientY - r.top) * scale];
    let best = null, least = 24 ** 2;
    for (const { i, cx, cy } of places) {
      const d = (cx - x) ** 2 + (cy - y) ** 2;
      if (seen[i] && d < least) [best, least] = [i, d];
    }
    return best;
  };
  one("[data-scatter]").addEventListener("pointermove", (event) => show(nearest(event)));
  one("[data-scatter]").addEventListener("pointerleave", () => show(null));
  one("[data-scatter]").addEventListener("click", (event) => { const i = nearest(event); if (i !== null) keep(i); });
  // The next point that is seen along an axis of the scatter, from the one in view.
  function step(axis, forward) {
    const list = places.filter(({ i }) => seen[i] && !coarse.has(i)).sort((a, b) => a[axis] - b[axis] || a.i - b.i);
    const at = list.findIndex(({ i }) => i === (state.shown ?? state.kept));
    const next = list[at < 0 ? (forward ? 0 : list.length - 1) : at + (forward ? 1 : -1)];
    if (next) show(next.i);
  }
  one("[data-scatter]").addEventListener("keydown", (event) => {
    const keys = {
      ArrowRight: () => step("cx", true), ArrowLeft: () => step("cx", false),
      ArrowUp: () => step("cy", false), ArrowDown: () => step("cy", true),
      Enter: () => { if (state.shown !== null) keep(state.shown); },
      Escape: () => { state.kept = null; show(null); mark(); },
    };
    if (!keys[event.key] || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    keys[event.key]();
  });
  one("[data-scatter]").addEventListener("blur", () => show(null));
  const over = (event) => { const i = event.target.closest?.("[data-i]")?.dataset.i; return i === undefined ? null : Number(i); };
  for (const place of ["[data-table] tbody", "[data-parallel]"]) {
    one(place).addEventListener("pointerover", (event) => show(over(event)));
    one(place).addEventListener("pointerleave", () => show(null));
    one(place).addEventListener("click", (event) => { const i = over(event); if (i !== null) keep(i); });
  }
  one("[data-table] tbody").addEventListener("focusin", (event) => show(over(event)));
  one("[data-table] tbody").addEventListener("focusout", () => show(null));
  one("[data-table] tbody").addEventListener("keydown", (event) => { if (event.key === "Enter") keep(over(event)); });
  for (const button of document.querySelectorAll("[data-pick]")) {
    const [, i] = picks[button.dataset.pick];
    const told = numbers.filter((c) => ["mass_kg", "torsion_Nm_per_rad", "bending_N_per_mm", "fatigue_safety"].includes(columns[c].name));
    const changes = told.filter((c) => isNumber(rows[i][c]) && isNumber(original[c]) && original[c]).map((c) => {
      const percent = 100 * (rows[i][c] / original[c] - 1);
      const value = columns[c].name === "mass_kg" ? `${text(rows[i][c], c)}\u00a0kg, ` : "";
      return { worse: columns[c].sense * percent < -0.05, words: `${columns[c].label} ${value}${signed(percent)}\u00a0%` };
    });
    changes.sort((a, b) => b.worse - a.worse); // what got worse comes first
    button.querySelector("small").innerHTML = changes.map(({ worse, words }) => `<span${worse ? ' class="worse"' : ""}>${escaped(words)}</span>`).join("; ");
    if (changes.some(({ worse }) => worse)) button.parentElement.className = "neutral";
    button.addEventListener("click", () => { state.kept = null; keep(i); one("#scatter").scrollIntoView(); });
  }

  // Start --------------------------------------------------------------------------------------------------
  const column = (...names) => names.map((name) => columns.findIndex((col) => col.name === name)).find((c) => c >= 0 && numeric[c]);
  state.x = column("mass_kg") ?? numbers[0] ?? 0;
  state.y = column("torsion_Nm_per_rad") ?? numbers.find((c) => c !== state.x) ?? state.x;
  state.colour = numbers.find((c) => columns[c].varied) ?? -1;
  for (const select of document.querySelectorAll("[data-axis]")) {
    const none = select.dataset.axis === "colour" ? '<option value="-1">none</option>' : "";
    select.innerHTML = none + numbers.map((c) => `<option value="${c}">${escaped(nameOf(c))}</option>`).join("");
    select.value = state[select.dataset.axis];
    select.addEventListener("change", () => { state[select.dataset.axis] = Number(select.value); drawScatter(); });
  }
  drawHead();
  drawFilters();
  drawScatter();
  drawParallel();
  refresh();
  let before = state.rows; // paper shows the whole front, and nothing else
  addEventListener("beforeprint", () => { before = state.rows; state.rows = Infinity; drawTable(); });
  addEventListener("afterprint", () => { state.rows = before; drawTable(); });
  let resizing = 0;
  addEventListener("resize", () => { cancelAnimationFrame(resizing); resizing = requestAnimationFrame(() => { drawScatter(); drawParallel(); }); });
  document.documentElement.dataset.ready = "";
})();
