"use strict";
// The page of the bench: forms from the schema, picture, drawing, gauges, history, variants, jobs, files.
// All text from files and designs is set as text, never as markup.
(() => {
  const $ = (id) => document.getElementById(id);
  const make = (tag, attributes = {}, ...children) => {
    const node = document.createElementNS(SVG.has(tag) ? "http://www.w3.org/2000/svg" : "http://www.w3.org/1999/xhtml", tag);
    for (const [name, value] of Object.entries(attributes)) {
      if (name.startsWith("on")) node.addEventListener(name.slice(2), value);
      else if (value === true) node.setAttribute(name, "");
      else if (value !== false && value !== undefined && value !== null) node.setAttribute(name, value);
    }
    node.append(...children);
    return node;
  };
  const SVG = new Set(["svg", "path", "circle", "line", "text", "g"]);

  // Gauges: name, label, unit, digits, which way is better (0: neither), size of the unit.
  const GAUGES = [
    ["mass", "Mass", "kg", 4, -1], ["torsion_per_mass", "Torsional stiffness per mass", "kN m/rad/kg", 4, 1, 1e3],
    ["bending_per_mass", "Bending stiffness per mass", "kN/mm/kg", 4, 1, 1e3],
    ["fatigue_safety", "Fatigue safety, least", "", 3, 1], ["pin_fillet_safety", "Safety, pin fillet", "", 3, 1],
    ["journal_fillet_safety", "Safety, journal fillet", "", 3, 1],
    ["torsion", "Torsional stiffness", "kN m/rad", 4, 1, 1e3], ["bending", "Bending stiffness", "kN/mm", 4, 1, 1e3],
    ["inertia", "Inertia about the crank axis", "kg mm2", 5, -1], ["unbalance", "Unbalance", "kg mm", 4, 0],
    ["balance_factor", "Balance factor of the oscillating mass", "%", 3, 0],
    ["m53_pin", "UR M53 polynomials, pin fillet", "", 3, 1], ["m53_journal", "UR M53 polynomials, journal fillet", "", 3, 1],
    ["natural_frequency", "First natural frequency", "Hz", 4, 0], ["piston_gap", "Gap to the piston skirt", "mm", 3, 0],
    ["crankcase_gap", "Gap to the crankcase", "mm", 3, 0], ["gas_force", "Gas force", "kN", 4, 0, 1e3],
    ["pin_force", "Largest rod force", "kN", 4, 0, 1e3], ["mean_torque", "Mean torque of the engine", "N m", 4, 0],
    ["mean_pressure", "Indicated mean pressure", "bar", 3, 0], ["power", "Indicated power", "kW", 4, 0],
  ];
  const SOLVED = new Set(["torsion", "bending", "torsion_per_mass", "bending_per_mass", "fatigue_safety", "pin_fillet_safety", "journal_fillet_safety"]);
  const GROUPS = [
    ["Engine", ["engine"]], ["Throw and journals", ["throw"]], ["Web", ["web"]], ["Material", ["material"]],
    ["Goal and limits", ["goal"]], ["Design space", ["envelope"]], ["Supports", ["supports"]], ["Shaft line", ["shaft"]],
    ["Fatigue", ["fatigue"]], ["Search", ["shape", "optimise"]], ["Effects", ["effects"]],
  ];
  const LAYOUTS = ["single", "in-line", "V", "boxer"];
  const JOBS = {
    shape: "Best dimensions of this web that can be made, judged on body-fitted elements: minutes. Comes back as a variant.",
    optimise: "Topology in the design space, then a parametric web of it: about two minutes. Comes back as a variant.",
    bound: "What no web of this design space can beat: half a minute. Comes back as a mark on the gauge.",
    fatigue: "Safety on the fine mesh of `cranktopo fatigue`: half a minute.",
    sweep: "Many values of one dimension: give it as KEY=A:B:N in the field Limit.",
  };

  const state = { reference: null, project: null, jobs: [], live: {}, settled: {}, original: {}, bound: {},
    turns: [0], fresh: false, front: null, ghostFront: null, picture: null, settledPicture: null, dragging: false, broken: [], made: [] };
  let socket = null, seq = 0, sent = 0, answered = 0, waiting = null, viewer = null;
  const sentAt = new Map();

  // Talk with the server: one drag is on its way at a time, the newest follows.
  function connect() {
    const address = new URL("talk", location.href);
    address.protocol = "ws:";
    socket = new WebSocket(address);
    socket.onopen = () => {
      status("Ready");
      sent = answered = 0;
      say({ do: "hello" });
    };
    socket.onmessage = (event) => hear(JSON.parse(event.data));
    socket.onclose = () => {
      status("The bench has ended or is out of reach; trying again");
      setTimeout(connect, 1500);
    };
  }
  const say = (message) => socket && socket.readyState === 1 && socket.send(JSON.stringify(message));
  const status = (text) => ($("status").textContent = text);

  function complain(text) {
    $("message").hidden = !text;
    $("message").querySelector("span").textContent = text || "";
  }

  function drag(changes) {
    state.dragging = true;
    waiting = changes;
    if (answered === sent) next();
  }

  function next() {
    if (!waiting) return;
    sent = ++seq;
    sentAt.set(seq, performance.now());
    say({ do: "drag", changes: waiting, seq });
    waiting = null;
  }

  function edit(changes, what) {
    waiting = null;
    state.dragging = false;
    say({ do: "edit", changes, what });
  }

  function hear(message) {
    const act = {
      reference: () => (state.reference = message.tables),
      state: () => hearState(message),
      live: () => hearLive(message),
      original: () => hearOriginal(message),
      coarse: () => hearCoarse(message),
      settled: () => hearSettled(message),
      jobs: () => ((state.jobs = message.jobs), showJobs()),
      proof: () => hearProof(message),
      made: () => hearMade(message),
      busy: () => status(message.what),
      error: () => complain(message.message),
    }[message.type];
    if (act) act();
  }

  function hearState(message) {
    const before = state.project, project = message.project;
    state.project = project;
    state.jobs = message.jobs || [];
    $("begin").hidden = Boolean(project);
    $("bench").hidden = !project;
    document.querySelectorAll("header [data-do]").forEach((b) => (b.disabled = !project));
    if (!project) return showBegin(message);
    complain("");
    $("name").textContent = project.name;
    document.querySelector("[data-do=undo]").disabled = project.at === 0;
    document.querySelector("[data-do=redo]").disabled = project.at + 1 >= project.steps.length;
    if (!before || before.name !== project.name) {
      Object.assign(state, { settled: {}, original: {}, bound: {}, made: [], picture: null, settledPicture: null, refit: true });
      $("write").elements.name.value = project.name;
      $("hint").hidden = localStorage.getItem("cranktopo-hint") === "seen";
    }
    if (!before || before.name !== project.name || before.at !== project.at || before.steps[before.at].file !== project.steps[project.at].file)
      Object.assign(state, { fresh: false, settledPicture: null, dragging: false });
    showForms();
    showHistory();
    showVariants();
    showJobs();
    showGauges();
  }

  function hearLive(message) {
    if (message.seq) {
      answered = Math.max(answered, message.seq);
    }
    if (message.seq && !state.dragging && !waiting) return next();
    state.broken = message.broken || [];
    showBroken();
    if (message.broken) return next();
    state.live = message.gauges;
    state.turns = message.turns_deg;
    state.notes = message.notes;
    state.front = message.front;
    state.picture = message.picture;
    showPicture(message.seq);
    showFront();
    showGauges();
    next();
  }

  function hearOriginal(message) {
    if (message.broken) return;
    state.original = { ...state.original, ...message.gauges };
    state.ghostFront = message.front;
    state.ghostPicture = message.picture;
    if (viewer) showGhost();
    showFront();
    showGauges();
  }

  function hearCoarse(message) {
    if (state.dragging ? !message.seq : message.seq && message.seq < seq) return;
    state.coarse = message.gauges;
    showGauges();
  }

  function hearSettled(message) {
    if (message.which === "original") state.original = { ...state.original, ...pick(message.gauges) };
    else if (!state.dragging) {
      state.settled = pick(message.gauges);
      state.errors = message.error_percent || {};
      state.settledParts = message.parts;
      state.place = message.place;
      state.missing = message.missing;
      state.coarse = {};
      state.fresh = true;
      state.settledPicture = message.picture || null;
      status(message.parts.includes("safety") ? "Settled" : "Stiffness settled; safety follows");
      if ($("safety").checked) showPicture();
    }
    showGauges();
  }
  const pick = (gauges) => Object.fromEntries(Object.entries(gauges).filter(([name]) => SOLVED.has(name)));

  function hearProof(message) {
    for (const [name, value] of Object.entries(message.gauges))
      if (name.startsWith("bound_")) state.bound[name.slice(6)] = value;
    status(`${message.kind} is done`);
    showGauges();
  }

  function hearMade(message) {
    state.made.push(message);
    status(`${message.name} is written`);
    $("made").append(make("li", {}, make("a", { href: `made/${encodeURIComponent(message.name)}`, download: message.name }, message.name)));
    showHistory();
  }

  // The first page.
  function showBegin(message) {
    const open = (name) => make("li", {}, make("button", { type: "button", onclick: () => say({ do: "open", name }) }, name));
    $("own").replaceChildren(...message.files.map(open));
    $("built-in").replaceChildren(...message.designs.map(open));
  }

  function beginForm() {
    const form = $("questions"), usual = { single: 1, "in-line": 4, V: 8, boxer: 4 };
    form.querySelector("fieldset").append(
      ...LAYOUTS.map((name) => make("label", {}, make("input", { type: "radio", name: "layout", value: name, checked: name === "single",
        onchange: () => (form.elements.cylinders.value = usual[name]) }), ` ${name}`)),
    );
    form.addEventListener("submit", (event) => {
      event.preventDefault();
      const answers = {};
      for (const [name, text] of new FormData(form)) {
        if (!text.trim()) continue;
        const number = name === "layout" || name === "name" ? text.trim() : numberOf(text);
        if (number === null) return complain(`${name}: '${text}' is no number.`);
        answers[name] = number;
      }
      say({ do: "start", answers });
    });
    for (const kind of ["dragover", "drop"])
      document.addEventListener(kind, (event) => {
        event.preventDefault();
        if (kind === "drop" && event.dataTransfer.files[0]) upload(event.dataTransfer.files[0]);
      });
    $("file").addEventListener("change", () => $("file").files[0] && upload($("file").files[0]));
  }

  async function upload(file) {
    status(`reading ${file.name}`);
    const answer = await fetch(`upload?name=${encodeURIComponent(file.name)}`, { method: "POST", body: file });
    const found = answer.ok ? await answer.json() : { error: `${file.name}: was refused (${answer.status}).` };
    complain(found.error);
    status(found.error ? "Not opened" : "Ready");
  }

  // A number as people write it: decimal point or comma.
  function numberOf(text) {
    const plain = text.trim().replace(/\s/g, "").replace(/^([+-]?\d+),(\d+)$/, "$1.$2");
    return /^[+-]?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?$/i.test(plain) ? Number(plain) : null;
  }

  // Forms.
  const parts = (key) => key.split(".").flatMap((word) => [word.split("[")[0], ...[...word.matchAll(/\[(\d+)\]/g)].map((m) => Number(m[1]))]);
  const valueAt = (key, data = state.project.data) => parts(key).reduce((at, part) => (at === undefined || at === null ? undefined : at[part]), data);
  const words = (name) => name.replace(/_(mm|deg|kg|kg_m3|MPa|GPa|rpm|N|Nm|N_per_mm|Nm_per_rad|percent|um|kg_m2|Hz|kW)$/, "").replaceAll("_", " ");

  function showForms() {
    if (!state.reference) return;
    const held = document.activeElement?.dataset?.key, open = openTables(), scroll = $("forms").scrollTop;
    const groups = GROUPS.map(([title, roots]) => {
      const body = roots.flatMap((root) => tableForms(root, root));
      return make("details", { "data-path": `group:${title}`, open: open.has(`group:${title}`) || (!open.size && title === "Web") }, make("summary", {}, title), ...body);
    });
    $("tree").replaceChildren(...groups);
    filterForms();
    showBroken();
    $("forms").scrollTop = scroll;
    if (held) document.querySelector(`[data-key="${CSS.escape(held)}"]:not([type=range])`)?.focus({ preventScroll: true });
  }
  const openTables = () => new Set([...document.querySelectorAll("#tree details[open]")].map((d) => d.dataset.path));

  // Forms of one table of the schema at a place of the design, and of the tables in it.
  function tableForms(path, place) {
    const tables = state.reference.filter((table) => table.path === path);
    if (!tables.length) return [];
    const common = tables[0], value = valueAt(place);
    if (common.repeated) {
      const entries = Array.isArray(value) ? value : [];
      return [
        ...entries.flatMap((_, i) => oneTable(tables, path, `${place}[${i}]`, `${words(path.split(".").pop())} ${i + 1}`, true)),
        make("div", { class: "tools" }, ...adders(tables, `${place}[${entries.length}]`, path)),
      ];
    }
    if (value === undefined && !common.required && !common.empty) return [make("div", { class: "tools" }, ...adders(tables, place, path))];
    return path.includes(".") ? oneTable(tables, path, place, words(path.split(".").pop()), !common.required && !common.empty) : tableBody(tables, path, place);
  }

  function oneTable(tables, path, place, title, removable) {
    const body = tableBody(tables, path, place);
    if (removable) body.push(make("div", { class: "tools" }, make("button", { type: "button", onclick: () => edit({ [place]: null }, `removed ${title}`) }, `Remove ${title}`)));
    return [make("details", { "data-path": place, open: openTables().has(place) || path === "throw.main_journal" || path === "throw.crankpin" || removable }, make("summary", {}, title), ...body)];
  }

  function tableBody(tables, path, place) {
    const [common, ...choices] = tables, rows = [];
    const chosen = choices.find((table) => choiceOf(table) === valueAt(`${place}.${table.choice}`));
    if (choices.length) rows.push(choiceRow(choices, place));
    if (chosen) rows.push(...chosen.keys.filter((key) => key.name !== chosen.choice).map((key) => keyRow(key, place)));
    rows.push(...common.keys.filter((key) => key.name !== "mirrored_web").map((key) => keyRow(key, place)));
    const inner = [...new Set(state.reference.map((table) => table.path))].filter((p) => p.startsWith(`${path}.`) && !p.slice(path.length + 1).includes("."));
    return [...rows, ...inner.flatMap((p) => tableForms(p, `${place}.${p.split(".").pop()}`))];
  }
  const choiceOf = (table) => table.keys.find((key) => key.name === table.choice).example;

  // What a new table begins with: its required keys, their examples, places in the middle of the throw.
  function beginning(tables, choice) {
    const keys = [...(choice ? choice.keys : []), ...tables[0].keys].filter((key) => key.required);
    return Object.fromEntries(keys.map((key) => [key.name, key.example]));
  }

  function adders(tables, place, path) {
    const [, ...choices] = tables, title = words(path.split(".").pop());
    const inner = (found) => {
      for (const table of state.reference.filter((t) => t.required === false && t.path.startsWith(`${path}.`) && ["from", "to"].includes(t.path.slice(path.length + 1))))
        found[table.path.split(".").pop()] ??= beginning([table]);
      return found;
    };
    const button = (choice, label) => make("button", { type: "button", onclick: () => edit({ [place]: inner(beginning(tables, choice)) }, `added ${label}`) }, `Add ${label}`);
    return choices.length ? choices.map((choice) => button(choice, `${title}: ${choiceOf(choice)}`)) : [button(null, title)];
  }

  function choiceRow(choices, place) {
    const key = choices[0].choice, chosen = valueAt(`${place}.${key}`), id = `f-${place}.${key}`;
    const select = make("select", { id, "data-key": `${place}.${key}`, onchange: () => {
      const old = choices.find((table) => choiceOf(table) === chosen), now = choices.find((table) => choiceOf(table) === select.value);
      const changes = { [`${place}.${key}`]: select.value };
      for (const one of old?.keys ?? []) if (one.name !== key && !now.keys.some((other) => other.name === one.name)) changes[`${place}.${one.name}`] = null;
      for (const one of now.keys) if (one.required && one.name !== key && valueAt(`${place}.${one.name}`) === undefined) changes[`${place}.${one.name}`] = one.example;
      edit(changes, `${words(key)}: ${select.value}`);
    } }, ...choices.map((table) => make("option", { selected: choiceOf(table) === chosen }, choiceOf(table))));
    return make("div", { class: "row" }, make("label", { for: id }, words(key)), select);
  }

  function keyRow(key, place) {
    const path = `${place}.${key.name}`, value = valueAt(path), id = `f-${path}`, help = `${id}-help`;
    const facts = [key.meaning, key.allowed && `Range: ${key.allowed} ${key.unit}`.trim(), key.default !== null && `Default: ${shown(key.default)}`].filter(Boolean).join(" ");
    const row = make("div", { class: "row", "data-row": path, "data-words": `${path} ${key.meaning}`.toLowerCase() }, make("label", { for: id, title: facts }, words(key.name)));
    const options = key.kind.startsWith("one of ") ? JSON.parse(`[${key.kind.slice(7)}]`) : key.kind === "true or false" ? [true, false] : null;
    if (options) row.append(selectOf(path, id, help, key, options, value));
    else row.append(inputOf(path, id, help, key, value), make("span", { class: "unit" }, key.unit));
    if (!options && typeof value === "number" && ["mm", "deg"].includes(key.unit)) row.append(sliderOf(path, key, value));
    row.append(make("p", { class: "help", id: help }, facts), make("p", { class: "broken", role: "alert", hidden: true }));
    return row;
  }
  const shown = (value) => (typeof value === "number" ? String(Number(value.toPrecision(6))) : typeof value === "string" ? value : JSON.stringify(value));

  function selectOf(path, id, help, key, options, value) {
    const blank = key.required ? [] : [make("option", { value: "", selected: value === undefined }, key.default === null ? "not given" : `${shown(key.default)} (assumed)`)];
    const select = make("select", { id, "data-key": path, "aria-describedby": help, onchange: () => {
      const taken = select.value === "" ? null : options.find((one) => String(one) === select.value);
      edit({ [path]: taken }, `${words(key.name)}: ${taken ?? "as assumed"}`);
    } }, ...blank, ...options.map((one) => make("option", { value: String(one), selected: one === value }, String(one))));
    return select;
  }

  function read(text, key) {
    if (!text.trim()) return key.required ? undefined : null;
    if (key.kind === "text") return text.trim();
    if (key.kind.startsWith("list")) {
      try {
        return JSON.parse(text.trim().startsWith("[") ? text : `[${text}]`);
      } catch {
        return undefined;
      }
    }
    return numberOf(text) ?? (key.kind === "number" || key.kind === "whole number" ? undefined : text.trim());
  }

  function inputOf(path, id, help, key, value) {
    const numeric = key.kind === "number" || key.kind === "whole number";
    const assumed = key.default !== null ? `${shown(key.default)} (assumed)` : key.required ? "" : "not given";
    const input = make("input", { id, "data-key": path, "aria-describedby": help, inputmode: numeric ? "decimal" : "text", autocomplete: "off", spellcheck: "false",
      placeholder: assumed, value: value === undefined ? "" : shown(value),
      oninput: () => {
        const found = numeric ? numberOf(input.value) : null;
        if (found !== null) drag({ [path]: found });
      },
      onchange: () => {
        const found = read(input.value, key);
        if (found === undefined) return mark(path, `'${input.value}' is ${numeric ? "no number" : "not understood"}.`);
        if (found !== (value ?? null)) edit({ [path]: found }, `${words(key.name)}: ${found === null ? "as assumed" : `${shown(found)} ${key.unit}`}`);
      } });
    return input;
  }

  function sliderOf(path, key, value) {
    const [low, high] = rangeOf(key, value), step = Number((10 ** Math.floor(Math.log10((high - low) / 200 || 0.1))).toPrecision(1));
    const slider = make("input", { type: "range", "data-key": path, min: low, max: high, step, value, "aria-label": words(key.name),
      oninput: () => {
        const number = slider.closest(".row").querySelector("input");
        number.value = slider.value;
        drag({ [path]: Number(slider.value) });
      },
      onchange: () => Number(slider.value) !== value && edit({ [path]: Number(slider.value) }, `${words(key.name)}: ${slider.value} ${key.unit}`) });
    return slider;
  }

  function rangeOf(key, value) {
    const span = Math.max(Math.abs(value) * 0.5, key.unit === "deg" ? 10 : 2);
    const found = key.allowed.match(/^(-?[\d.e+]+) to (-?[\d.e+]+)$/);
    const [least, most] = found ? [Number(found[1]), Number(found[2])] : [key.allowed.startsWith("≥ 0") || value >= 0 ? 0 : -Infinity, Infinity];
    const tidy = (x) => Number(x.toPrecision(4));
    return [tidy(Math.max(least, value - span)), tidy(Math.min(most, value + span))];
  }

  function filterForms() {
    const sought = $("find").value.trim().toLowerCase();
    document.querySelectorAll("#tree .row[data-row]").forEach((row) => (row.hidden = Boolean(sought) && !row.dataset.words.includes(sought)));
    if (sought) document.querySelectorAll("#tree details").forEach((d) => (d.open = Boolean(d.querySelector(".row[data-row]:not([hidden])"))));
  }

  function showBroken() {
    document.querySelectorAll("#tree .row.is-broken").forEach((row) => mark(row.dataset.row, ""));
    const homeless = state.broken.filter(({ key, message }) => !mark(key, message));
    if (homeless.length) complain(homeless.map((one) => one.message).join("\n"));
    else if (!state.broken.length && state.dragging) complain("");
  }

  function mark(key, text) {
    const row = document.querySelector(`#tree [data-row="${CSS.escape(key)}"]`);
    if (!row) return false;
    row.classList.toggle("is-broken", Boolean(text));
    const line = row.querySelector(".broken");
    line.hidden = !text;
    line.textContent = text;
    row.querySelector("input")?.setAttribute("aria-invalid", text ? "true" : "false");
    if (text) for (let at = row.parentElement; at && at.id !== "tree"; at = at.parentElement) if (at.tagName === "DETAILS") at.open = true;
    return true;
  }

  // 3D view: the first picture starts it, later ones replace the body.
  function showPicture(number) {
    const coloured = $("safety").checked && state.settledPicture && !state.dragging;
    const text = coloured ? state.settledPicture : state.picture;
    if (!text) return;
    $("legend").textContent = coloured ? `Colour: share of the fatigue strength that is used; yellow is the least safety, ${plain(state.settled.fatigue_safety, 3)}.`
      : $("safety").checked ? "The colours of the safety come when it has settled." : "Blue: web. Grey: journals, and the original where it stands out.";
    if (!viewer) return startViewer(text);
    viewer.show(text).then((drawn) => {
      if (!drawn) return;
      viewer.colour(coloured ? 0 : -1);
      if (state.refit) viewer.refit();
      state.refit = false;
      viewer.dataset.shown = String(seq);
      if (sentAt.has(number)) (window.benchDelays ??= []).push(performance.now() - sentAt.get(number));
      sentAt.delete(number);
    });
    viewer.turns($("crank").checked ? state.turns : null);
  }

  function startViewer(text) {
    if ($("scene3d")) return;
    const holder = make("script", { id: "scene3d", type: "application/octet-stream" });
    holder.textContent = text;
    $("viewer").addEventListener("ready", () => {
      viewer = $("viewer");
      state.refit = true;
      showPicture();
      showGhost();
    });
    document.body.append(holder, make("script", { src: "viewer.js" }));
  }

  function showGhost() {
    viewer?.ghost($("ghost").checked && state.ghostPicture && state.project?.at !== state.project?.original ? state.ghostPicture : null);
  }

  // Front view: strokes in mm, y up; handles are dimensions.
  function showFront() {
    const svg = $("front"), view = state.front;
    if (!view || (svg.dataset.held && state.frontDrawn)) return view && moveFront(svg, view);
    state.frontDrawn = true;
    const points = view.paths.flatMap((path) => path.points).concat(view.circles.flatMap((c) => [[c.at[0] - c.radius, c.at[1] - c.radius], [c.at[0] + c.radius, c.at[1] + c.radius]]));
    const [xs, ys] = [0, 1].map((i) => points.map((p) => p[i]));
    const pad = 0.12 * (Math.max(...ys) - Math.min(...ys));
    const box = [Math.min(...xs) - 3 * pad, -Math.max(...ys) - pad, Math.max(...xs) - Math.min(...xs) + 6 * pad, Math.max(...ys) - Math.min(...ys) + 2 * pad];
    svg.setAttribute("viewBox", box.join(" "));
    const scale = Math.max(box[2] / Math.max(svg.clientWidth, 100), box[3] / Math.max(svg.clientHeight, 100));
    svg.dataset.scale = scale;
    svg.replaceChildren(make("g", {}), ...view.handles.map((handle) => handleOf(handle, scale)));
    moveFront(svg, view);
  }

  function moveFront(svg, view) {
    const line = (path, kind = path.kind) => make("path", { class: kind, d: `M${path.points.map(([x, y]) => `${x},${-y}`).join("L")}${path.closed ? "Z" : ""}` });
    const round = (c, kind = c.kind) => make("circle", { class: kind, cx: c.at[0], cy: -c.at[1], r: c.radius });
    const ghost = state.project?.at !== state.project?.original || state.dragging ? state.ghostFront : null;
    const ghosts = ghost && $("ghost").checked ? ghost.paths.filter((p) => p.kind === "web").map((p) => line(p, "ghost")) : [];
    svg.firstChild.replaceChildren(...view.room.map((p) => line(p)), ...view.paths.map((p) => line(p)), ...view.circles.map((c) => round(c)), ...ghosts);
    const byKey = Object.fromEntries(view.handles.map((handle) => [handle.key, handle]));
    for (const node of svg.querySelectorAll("[data-handle]")) {
      const handle = byKey[node.dataset.handle];
      if (handle) placeHandle(node, handle, Number(svg.dataset.scale));
    }
  }

  const unitOf = (key) => (key.endsWith("_deg") ? "deg" : "mm");
  function placeHandle(node, handle, scale) {
    const [dot, text] = node.children, [x, y] = [handle.at[0], -handle.at[1]];
    dot.setAttribute("cx", x);
    dot.setAttribute("cy", y);
    dot.setAttribute("r", 7 * scale);
    dot.setAttribute("aria-valuenow", handle.value.toFixed(2));
    dot.setAttribute("aria-valuetext", `${handle.value.toFixed(2)} ${unitOf(handle.key)}`);
    text.setAttribute("x", x + 10 * scale);
    text.setAttribute("y", y - 8 * scale);
    text.setAttribute("font-size", 12 * scale);
    text.style.fontSize = `${12 * scale}px`;
    text.style.strokeWidth = `${3 * scale}px`;
    text.textContent = `${words(handle.key.split(".").pop())} ${handle.value.toFixed(1)}`;
    node.handle = handle;
  }

  function handleOf(handle) {
    const name = words(handle.key.replaceAll(".", " "));
    const dot = make("circle", { class: "handle", tabindex: "0", role: "slider", "aria-label": name, "data-handle-key": handle.key });
    const node = make("g", { "data-handle": handle.key }, dot, make("text", {}));
    const svg = $("front");
    let held = null, value = 0;
    const move = (to) => {
      value = Number(to.toFixed(unitOf(handle.key) === "deg" ? 1 : 2));
      const number = document.querySelector(`#tree input[data-key="${CSS.escape(handle.key)}"]`);
      if (number) number.value = value;
      drag({ [handle.key]: value });
    };
    const release = () => {
      if (held === null) return;
      held = null;
      delete svg.dataset.held;
      edit({ [handle.key]: value }, `${name}: ${value} ${unitOf(handle.key)}`);
    };
    dot.addEventListener("pointerdown", (event) => {
      dot.setPointerCapture(event.pointerId);
      held = { x: event.clientX, y: event.clientY, from: node.handle.value };
      value = held.from;
      svg.dataset.held = handle.key;
      event.preventDefault();
      dot.focus();
    });
    dot.addEventListener("pointermove", (event) => {
      if (!held) return;
      const scale = Number(svg.dataset.scale), [wx, wy] = handle.way;
      const along = ((event.clientX - held.x) * wx - (event.clientY - held.y) * wy) * scale;
      move(held.from + along * handle.per_mm);
    });
    dot.addEventListener("pointerup", release);
    dot.addEventListener("pointercancel", release);
    dot.addEventListener("keydown", (event) => {
      const step = { ArrowUp: 1, ArrowRight: 1, ArrowDown: -1, ArrowLeft: -1, PageUp: 10, PageDown: -10 }[event.key];
      if (!step) return;
      event.preventDefault();
      if (held === null) value = node.handle.value;
      held = { from: value, key: true };
      svg.dataset.held = handle.key;
      move(value + step * (event.shiftKey ? 0.1 : 0.5));
    });
    dot.addEventListener("keyup", (event) => event.key.startsWith("Arrow") || event.key.startsWith("Page") ? release() : null);
    dot.addEventListener("blur", release);
    return node;
  }

  // Gauges.
  const plain = (value, digits) => (value === undefined || value === null ? "" : Math.abs(value) >= 1e5 ? Math.round(value).toLocaleString("en") : String(Number(value.toPrecision(digits))));

  function valueOf(name) {
    if (!SOLVED.has(name)) return [state.live[name], "live, exact"];
    if ((state.dragging || !state.fresh) && state.coarse?.[name] !== undefined) return [state.coarse[name], "coarse: 4 mm cells brought to the settled value"];
    const value = state.settled[name], error = (state.errors ?? {})[name.replace("_per_mass", "")];
    if (value === undefined) return [undefined, "waits"];
    if (state.dragging || !state.fresh) return [value, "stale: of the last settled web"];
    return [value, name.includes("safety") ? "settled, elements of half a fillet" : `settled${error === undefined ? "" : `, error at most ${error.toFixed(1)} %`}`];
  }

  function limitOf(name) {
    const text = valueAt(`goal.limits.${name}`), found = typeof text === "string" && text.match(/([<>])=\s*(-?[\d.]+)\s*(%)?/);
    if (!found) return null;
    const required = found[3] && name !== "balance_factor" ? (Number(found[2]) / 100) * state.original[name] : Number(found[2]);
    return Number.isFinite(required) ? { text, required, sense: found[1] } : null;
  }

  function showGauges() {
    if (!state.project) return;
    const worse = [], broken = [];
    const rows = GAUGES.map((gauge) => {
      const [name, label] = gauge, [value, ring] = valueOf(name), original = state.original[name];
      if (value === undefined && original === undefined && !SOLVED.has(name)) return null;
      if (value === undefined && original === undefined && state.missing && name.includes("safety")) return null;
      const percent = value !== undefined && original ? 100 * (value / original - 1) : null, better = gauge[4];
      const way = percent === null || !better || Math.abs(percent) < 0.05 ? 0 : Math.sign(percent) * better * Math.sign(original);
      const limit = limitOf(name), holds = limit && value !== undefined && (limit.sense === ">" ? value >= limit.required * (1 - 1e-4 * Math.sign(limit.required)) : value <= limit.required * (1 + 1e-4 * Math.sign(limit.required)));
      const stale = ring.startsWith("stale") || ring === "waits";
      if (way < 0 && !stale) worse.push(`${label.toLowerCase()} ${signed(percent)}`);
      if (limit && !holds && !stale) broken.push(`${label.toLowerCase()} ${limit.text}`);
      return gaugeRow(gauge, value, ring, percent, way, limit, holds, stale);
    }).filter(Boolean);
    $("dials").replaceChildren(...rows);
    const line = broken.length ? `Limit not kept: ${broken.join("; ")}.` : "";
    const same = state.project.at === state.project.original && !state.dragging;
    $("worse").textContent = same ? "This is the original." : [line, worse.length ? `Worse than the original: ${worse.join("; ")}.` : "Nothing is worse than the original."].filter(Boolean).join(" ");
    $("worse").className = same ? "" : worse.length || broken.length ? "bad" : "good";
    $("place").textContent = state.place && !state.dragging ? `Least safety: ${state.place}.` : state.missing || "";
    $("notes").replaceChildren(...(state.notes ?? []).map((text) => make("li", {}, text)));
  }
  const signed = (percent) => `${percent > 0 ? "+" : "−"}${Math.abs(percent).toFixed(Math.abs(percent) < 10 ? 1 : 0)} %`;

  function gaugeRow(gauge, value, ring, percent, way, limit, holds, stale) {
    const [name, label, unit, digits, , size = 1] = gauge, original = state.original[name], bound = state.bound[name];
    const text = value === undefined ? "…" : `${plain(value / size, digits)} ${unit}`;
    const change = percent === null ? "" : Math.abs(percent) < 0.05 ? "as original" : signed(percent);
    const item = make("li", { class: stale ? "stale" : "", "data-gauge": name, role: "group", "aria-label": `${label}: ${text}, ${change || "no original yet"}, ${ring}${limit ? `, limit ${limit.text} ${holds ? "holds" : "is not kept"}` : ""}` },
      make("span", {}, label), make("span", { class: "value" }, text), make("span", { class: `change ${way > 0 ? "better" : way < 0 ? "worse" : ""}` }, change));
    if (percent !== null && !["unbalance", "balance_factor"].includes(name)) item.append(trackOf(percent, limit, original, bound));
    const line = make("div", { class: "ring" }, make("span", {}, ring));
    if (limit) line.append(make("span", { class: `limit ${holds ? "holds" : ""}` }, `limit ${limit.text}${holds ? "" : ": not kept"}`));
    if (bound !== undefined) line.append(make("span", {}, `no web beats ${plain(bound / size, digits)} ${unit} (proof)`));
    item.append(line);
    return item;
  }

  // A bar from 70 to 130 % of the original; black: original, red: limit.
  function trackOf(percent, limit, original, bound) {
    const at = (p) => `${Math.max(0, Math.min(100, 50 + (p / 30) * 50))}%`, track = make("span", { class: "track", "aria-hidden": "true" });
    const bar = make("i"), mark = make("b");
    bar.style.left = at(Math.min(0, percent));
    bar.style.right = `calc(100% - ${at(Math.max(0, percent))})`;
    mark.style.left = "50%";
    track.append(bar, mark);
    for (const value of [limit?.required, bound])
      if (value !== undefined) {
        const line = make("u");
        line.style.left = at(100 * (value / original - 1));
        track.append(line);
      }
    return track;
  }

  // History, variants, jobs, files.
  function showHistory() {
    const { steps, at, diff } = state.project;
    $("history").querySelector("ol").replaceChildren(...steps.map((step, i) => make("li", { class: i === at ? "here" : i > at ? "undone" : "", "aria-current": i === at ? "step" : undefined }, step.what)));
    const list = $("history").querySelector("ol"), here = list.querySelector("li.here");
    if (here) list.scrollTop = here.offsetTop - list.offsetTop - list.clientHeight / 2;
    $("diff").textContent = diff.length ? diff.join("\n") : "No change.";
    const lines = [...steps.slice(0, at + 1).map((step) => step.command), ...state.jobs.map((job) => job.command), ...state.made.map((file) => file.command)];
    $("commands").textContent = lines.join("\n");
  }

  const COLUMNS = ["mass", "torsion_per_mass", "bending_per_mass", "fatigue_safety", "unbalance"];
  function showVariants() {
    const variants = state.project.variants, table = $("variants").querySelector("table"), gauges = COLUMNS.map((name) => GAUGES.find((g) => g[0] === name));
    if (!variants.length) {
      $("scatter").toggleAttribute("hidden", true);
      return table.replaceChildren(make("tbody", {}, make("tr", {}, make("th", {}, "Keep variant puts the design here."))));
    }
    const head = make("tr", {}, make("th", { scope: "col" }, "Variant"), ...gauges.map(([, label, unit]) => make("th", { scope: "col" }, `${label.replace("stiffness ", "").replace(", least", "")} ${unit}`)), make("th", {}, ""));
    const base = variants.find((one) => one.pinned)?.gauges;
    const rows = variants.map((variant) => make("tr", { "data-variant": variant.id },
      make("th", { scope: "row", title: variant.what }, make("label", {}, make("input", { type: "checkbox", checked: variant.pinned, "aria-label": `compare ${variant.name}`, onchange: (event) => say({ do: "compare", id: variant.id, pinned: event.target.checked }) }), ` ${variant.name}`), make("br"), make("small", {}, variant.what)),
      ...gauges.map(([name, , , digits, , size = 1]) => {
        const value = variant.gauges[name], before = base?.[name];
        return make("td", {}, value === undefined ? "" : plain(value / size, digits), before && value !== undefined && !variant.pinned ? ` (${signed(100 * (value / before - 1))})` : "");
      }),
      make("td", {}, make("button", { type: "button", onclick: () => say({ do: "take", id: variant.id }) }, "Take"), make("button", { type: "button", "aria-label": `drop ${variant.name}`, onclick: () => say({ do: "drop", id: variant.id }) }, "Drop"))));
    table.replaceChildren(make("thead", {}, head), make("tbody", {}, ...rows));
    scatter(variants);
  }

  function scatter(variants) {
    const found = variants.filter((one) => one.gauges.mass && one.gauges.torsion), svg = $("scatter");
    svg.toggleAttribute("hidden", found.length < 2);
    if (found.length < 2) return;
    const [xs, ys] = [found.map((one) => one.gauges.mass), found.map((one) => one.gauges.torsion / 1e3)];
    const place = (v, all, from, to) => from + ((v - Math.min(...all)) / (Math.max(...all) - Math.min(...all) || 1)) * (to - from);
    svg.setAttribute("viewBox", "0 0 400 190");
    svg.replaceChildren(make("line", { x1: 50, y1: 160, x2: 390, y2: 160 }), make("line", { x1: 50, y1: 10, x2: 50, y2: 160 }),
      make("text", { x: 220, y: 182 }, `mass ${plain(Math.min(...xs), 4)} to ${plain(Math.max(...xs), 4)} kg`), make("text", { x: 55, y: 12 }, `torsion ${plain(Math.min(...ys), 4)} to ${plain(Math.max(...ys), 4)} kN m/rad`),
      ...found.flatMap((one, i) => {
        const [x, y] = [place(xs[i], xs, 70, 330), place(ys[i], ys, 145, 30)];
        return [make("circle", { cx: x, cy: y, r: 5 }), make("text", { x: x + 8, y: y + 4 }, one.name)];
      }));
  }

  function showJobs() {
    const list = $("jobs").querySelector("ul");
    list.replaceChildren(...state.jobs.slice().reverse().map((job) => {
      const buttons = make("span", { class: "tools" });
      if (job.state === "running") buttons.append(make("button", { type: "button", onclick: () => say({ do: "stop", id: job.id }) }, "Stop"));
      if (job.resumable) buttons.append(make("button", { type: "button", onclick: () => say({ do: "resume", id: job.id }) }, "Continue"));
      if (job.page) buttons.append(make("a", { href: `job/${job.id}`, target: "_blank", rel: "noreferrer" }, "Report"));
      return make("li", { "data-job": job.state }, make("strong", {}, `${job.kind} ${job.id}: ${job.state}`), ` ${job.state === "running" ? `${job.seconds} s` : ""} `, buttons, make("p", {}, job.notes.slice(-2).join(" | ")));
    }));
    if (state.project) showHistory();
  }

  function outForms() {
    const form = $("job");
    form.elements.kind.append(...Object.keys(JOBS).map((name) => make("option", {}, name)));
    const help = () => ($("job-help").textContent = JOBS[form.elements.kind.value]);
    form.elements.kind.addEventListener("change", help);
    help();
    form.addEventListener("submit", (event) => {
      event.preventDefault();
      const kind = form.elements.kind.value, limit = form.elements.limit.value.trim(), options = {};
      const [sense, quantity] = form.elements.goal.value.split("=");
      if (["shape", "optimise", "bound"].includes(kind)) options[sense] = quantity;
      if (limit && kind === "sweep") options.vary = limit;
      else if (limit && kind !== "fatigue") options.limit = limit.split(";").map((one) => one.trim());
      say({ do: "job", kind, options });
      status(`${kind} starts`);
    });
    $("write").addEventListener("submit", (event) => {
      event.preventDefault();
      const { name, kind, replace } = $("write").elements, [suffix, part] = kind.value.split(":");
      const file = `${name.value.trim().replace(/\.(toml|step|stl|pdf|svg)$/i, "")}${suffix}`;
      if (suffix === ".toml") say({ do: "save", name: file, replace: replace.checked });
      else say({ do: "export", name: file, replace: replace.checked, ...(part === "drawing" ? {} : { part }) });
      status(`writing ${file}`);
    });
    $("copy").addEventListener("click", () => navigator.clipboard?.writeText($("commands").textContent));
  }

  function keep() {
    const name = `variant ${state.project.variants.length + 1}`;
    say({ do: "keep", name });
    status(`${name} is kept`);
  }

  document.querySelectorAll("header [data-do]").forEach((button) => button.addEventListener("click", () => (button.dataset.do === "keep" ? keep() : say({ do: button.dataset.do }))));
  document.addEventListener("keydown", (event) => {
    if (!(event.ctrlKey || event.metaKey) || !state.project) return;
    const act = { z: () => say({ do: event.shiftKey ? "redo" : "undo" }), y: () => say({ do: "redo" }), k: keep }[event.key.toLowerCase()];
    if (!act) return;
    event.preventDefault();
    act();
  });
  $("message").querySelector("button").addEventListener("click", () => complain(""));
  $("hint").querySelector("button").addEventListener("click", () => {
    localStorage.setItem("cranktopo-hint", "seen");
    $("hint").hidden = true;
  });
  $("find").addEventListener("input", filterForms);
  $("ghost").addEventListener("change", () => (showGhost(), showFront()));
  for (const id of ["safety", "crank"]) $(id).addEventListener("change", () => showPicture());
  new ResizeObserver(() => state.front && ((state.frontDrawn = false), delete $("front").dataset.held, showFront())).observe($("front"));
  beginForm();
  outForms();
  connect();
})();
