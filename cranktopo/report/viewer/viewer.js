"use strict";
// The 3D view: surfaces and cells of the throw, turned with pointer or keyboard. WebGL 2, nothing else.
(async () => {
  const box = document.getElementById("viewer");
  const packed = document.getElementById("scene3d");
  if (!box || !packed || !("DecompressionStream" in window)) return;
  const canvas = box.querySelector("canvas");
  const smooth = box.dataset.follows === undefined || !isSoftware();
  const gl = canvas.getContext("webgl2", { antialias: smooth, preserveDrawingBuffer: true });
  if (!gl) return;

  const VERTEX = `#version 300 es
    in vec3 position; in vec3 normal; in float share;
    uniform mat3 turn; uniform vec3 low, size, flip, shift, target, colour0, colour1; uniform vec2 spin;
    uniform vec3 scale; uniform float nearer; uniform vec3 ramp[STOPS]; uniform bool ramped;
    out vec3 tint; out float light, height, aside;
    const vec3 KEY = normalize(vec3(-0.45, 0.60, 0.65));
    const vec3 FRONT = normalize(vec3(0.10, 0.0, 1.0));
    const vec3 RIM = normalize(vec3(0.95, -0.10, 0.30));
    vec3 colour() {
      if (!ramped) return mix(colour0, colour1, share);
      float place = share * float(STOPS - 1);
      int below = min(int(place), STOPS - 2);
      return mix(ramp[below], ramp[below + 1], place - float(below));
    }
    void main() {
      vec3 own = low + size * position;
      mat3 about = mat3(spin.x, spin.y, 0.0, -spin.y, spin.x, 0.0, 0.0, 0.0, 1.0);
      vec3 p = turn * (about * (own * flip + shift) - target);
      vec3 n = turn * (about * (normal * flip));
      light = 0.42 + 0.42 * max(dot(n, KEY), 0.0) + 0.26 * max(dot(n, FRONT), 0.0)
        + 0.16 * max(dot(n, RIM), 0.0);
      tint = colour();
      height = own.z;
      aside = own.x * flip.x;
      gl_Position = vec4(scale * p, 1.0) - vec4(0.0, 0.0, nearer, 0.0);
    }`;
  const FRAGMENT = `#version 300 es
    precision highp float;
    const vec3 SECTION = vec3(0.93, 0.62, 0.33);
    uniform vec2 sides; uniform vec3 beyond; uniform float alpha, cut;
    in vec3 tint; in float light, height, aside; out vec4 pixel;
    void main() {
      if (aside > cut) discard;
      bool inside = !gl_FrontFacing && cut < 1e8; // seen through the cut: the section
      vec3 colour = height < sides.x || height > sides.y ? beyond : tint;
      pixel = vec4(inside ? SECTION : min(colour * light, 1.0) * alpha, alpha);
    }`;
  const WEB = [0.30, 0.52, 0.80], JOURNAL = [0.78, 0.79, 0.81], THIN = [1.0, 0.86, 0.5], GHOST = [0.62, 0.64, 0.68];
  const EVERYWHERE = [-1e9, 1e9], NEVER = 1e9, SHARP = Math.cos(35 * Math.PI / 180);
  const PRESSED = 4; // way of a pointer that presses and does not turn, px
  const PLAIN = "="; // before a block that is not compressed
  const EDGE = [0.10, 0.16, 0.30], START = { yaw: 0.75, pitch: 0.39, zoom: 1 };

  const { header, arrays } = await unpack(packed.textContent);
  let stress, program, uniforms;
  useRamp(header.stress);
  const bodies = allBuffers(header.bodies, arrays);
  const steps = header.steps;
  const state = { ...START, body: header.first, colour: -1,
    step: steps ? steps.iterations.length : 0, cut: 0.25, whole: false };
  const SPOT = [0.85, 0.12, 0.08], SPOT_SHARE = 0.025; // of the largest length of the body
  let blocks = null, waiting = false, other = null, asked = 0, ghost = null, aimed = null, turns = null, section = null;
  let spot = null, dot3 = null, lens = null;

  gl.enable(gl.DEPTH_TEST);
  controls();
  new ResizeObserver(redraw).observe(canvas);
  document.documentElement.classList.add("has-3d");
  redraw();
  box.show = show;
  box.picture = picture;
  box.ghost = showGhost;
  box.colour = (index) => {
    if (index === state.colour) return; // as it was shown
    colourBy(index);
    redraw();
  };
  box.refit = () => {
    aimed = other;
    redraw();
  };
  // Shows all throws of the crank, each turned about z, deg; one alone without them.
  box.turns = (angles) => {
    turns = paintedAnew(turns, angles && angles.map((deg) => (deg * Math.PI) / 180));
  };
  // Takes away what lies beyond a plane x, mm, and shows the section; nothing without it.
  box.section = (x) => {
    section = paintedAnew(section, x);
  };
  // Marks a point of the throw, mm, through whatever lies before it; none without it.
  box.spot = (point) => {
    spot = paintedAnew(spot, point);
  };
  // The line of sight through a place of the window, in the frame of the first throw, mm, and what is shown of it.
  box.sight = (clientX, clientY) => {
    const { left, top, width, height } = canvas.getBoundingClientRect(), { right, up, out, target, scale, depth } = lens;
    const across = (2 * (clientX - left) / width - 1) * width / height / scale, above = (1 - 2 * (clientY - top) / height) / scale;
    const start = target.map((at, i) => at + across * right[i] + above * up[i] + depth * out[i]);
    return { start, along: out.map((part) => -part), whole: state.whole, crank: Boolean(turns), section };
  };
  // Turns the view to a point of the throw, mm, as seen from outside of the body.
  box.lookAt = (point) => {
    const body = other ?? bodies[state.body], beyond = point[2] > body.half_pitch_mm + 1e-6;
    if (beyond && !state.whole) box.querySelector("[data-whole]")?.click();
    const middle = body.low_mm.map((low, i) => low + body.size_mm[i] / 2);
    if (beyond) middle[2] = pitch(body) - middle[2];
    const out = less(point, middle);
    look({ yaw: Math.atan2(out[0], out[2]), pitch: Math.asin(out[1] / Math.hypot(...out)), zoom: 1 });
  };
  box.dataset.ready = "yes";
  box.dispatchEvent(new Event("ready"));

  // True where the processor draws: smooth edges then cost a third of the time of a picture.
  function isSoftware() {
    const probe = document.createElement("canvas").getContext("webgl2");
    const named = probe?.getExtension("WEBGL_debug_renderer_info");
    const name = named ? probe.getParameter(named.UNMASKED_RENDERER_WEBGL) : "";
    probe?.getExtension("WEBGL_lose_context")?.loseContext();
    return /swiftshader|llvmpipe|softpipe|software|basic render/i.test(name);
  }

  async function unpack(text) {
    const plain = text.startsWith(PLAIN), block = plain ? bytesOf(text.slice(1)).buffer : await inflated(text.trim());
    const length = new DataView(block).getUint32(0, true);
    const found = JSON.parse(new TextDecoder().decode(new Uint8Array(block, 4, length)));
    const kinds = { uint8: Uint8Array, int8: Int8Array, uint16: Uint16Array, uint32: Uint32Array };
    const views = found.arrays.map((a) => new kinds[a.type](block, 4 + length + a.offset, a.length));
    return { header: found, arrays: views };
  }

  function inflated(text) {
    const stream = new Blob([bytesOf(text)]).stream().pipeThrough(new DecompressionStream("deflate"));
    return new Response(stream).arrayBuffer();
  }

  function bytesOf(text) {
    const letters = atob(text), bytes = new Uint8Array(letters.length);
    for (let i = 0; i < letters.length; i++) bytes[i] = letters.charCodeAt(i);
    return bytes;
  }

  // Takes the colours of a scale, if there is one; the shader holds as many as the scale has.
  function useRamp(scale) {
    if (program && !scale) return;
    stress = scale;
    program = link();
    uniforms = Object.fromEntries(
      ["turn", "low", "size", "flip", "shift", "target", "colour0", "colour1", "scale", "nearer", "ramp",
        "ramped", "sides", "beyond", "spin", "alpha", "cut"].map((n) => [n, gl.getUniformLocation(program, n)]),
    );
  }

  function link() {
    const made = gl.createProgram();
    const stops = String(stress ? stress.ramp.length : 2);
    for (const [kind, source] of [[gl.VERTEX_SHADER, VERTEX], [gl.FRAGMENT_SHADER, FRAGMENT]]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, source.replaceAll("STOPS", stops));
      gl.compileShader(shader);
      gl.attachShader(made, shader);
    }
    ["position", "normal", "share"].forEach((name, i) => gl.bindAttribLocation(made, i, name));
    gl.linkProgram(made);
    if (!gl.getProgramParameter(made, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(made));
    return made;
  }

  function buffers(attributes, faces) {
    const shape = { vao: gl.createVertexArray(), count: faces.length, made: [] };
    gl.bindVertexArray(shape.vao);
    attributes.forEach(([values, width, type, normalized], i) => {
      if (!values) return;
      fill(shape, gl.ARRAY_BUFFER, values);
      gl.enableVertexAttribArray(i);
      gl.vertexAttribPointer(i, width, type, normalized, 0, 0);
    });
    fill(shape, gl.ELEMENT_ARRAY_BUFFER, faces);
    return shape;
  }

  function fill(shape, kind, values) {
    const buffer = gl.createBuffer();
    shape.made.push(buffer);
    gl.bindBuffer(kind, buffer);
    gl.bufferData(kind, values, gl.STATIC_DRAW);
  }

  function discard(shape) {
    shape.made.forEach((buffer) => gl.deleteBuffer(buffer));
    gl.deleteVertexArray(shape.vao);
  }

  function discardHalves(body) {
    for (const half of new Set([body, body.beyond])) {
      for (const shape of half.journals.made === half.web.made ? [half.web] : [half.web, half.journals])
        discard(shape);
      discard(half.edges);
    }
  }

  const pitch = (body) => body.half_pitch_mm + body.beyond.half_pitch_mm;

  // Bodies ready to draw, each with the half beyond the crankpin: itself, or its partner where halves differ.
  function allBuffers(packed, arrays) {
    const ready = packed.map((body) => bodyBuffers(body, arrays));
    ready.forEach((body, i) => (body.beyond = ready[i + (body.partner ?? 0)])); // pages of older sweeps name none
    return ready;
  }

  function bodyBuffers(body, arrays) {
    if (body.corners !== undefined) return smallBuffers(body, arrays);
    const faces = arrays[body.faces], edges = arrays[body.edges];
    const attributes = [
      [arrays[body.positions], 3, gl.UNSIGNED_SHORT, true],
      [arrays[body.normals], 3, gl.BYTE, true],
    ];
    if (edges) {
      const web = buffers(attributes, faces), lines = buffers(attributes.slice(0, 1), edges);
      return { ...body, shares: [], web, edges: lines, journals: { ...web, count: 0 } };
    }
    const journal = arrays[body.journal];
    const isJournal = (_, i) => journal[faces[i - (i % 3)]] > 0;
    return {
      ...body,
      shares: body.stress.map((number) => arrays[number]),
      web: buffers(attributes, faces.filter((v, i) => !isJournal(v, i))),
      journals: buffers(attributes, faces.filter(isJournal)),
      edges: buffers(attributes.slice(0, 1), sharpEdges(arrays[body.positions], faces, body.size_mm)),
    };
  }

  // Pairs of corners between faces that meet at a sharp edge; corners at one place count as one.
  function sharpEdges(positions, faces, size) {
    const places = new Map(), pairs = new Map(), found = [];
    const own = Uint32Array.from({ length: positions.length / 3 }, (_, v) => {
      const place = positions[3 * v] * 2 ** 32 + positions[3 * v + 1] * 2 ** 16 + positions[3 * v + 2];
      if (!places.has(place)) places.set(place, v);
      return places.get(place);
    });
    const at = (v) => size.map((length, axis) => length * positions[3 * v + axis]);
    for (let f = 0; f < faces.length; f += 3) {
      const [a, b, c] = [at(faces[f]), at(faces[f + 1]), at(faces[f + 2])];
      const across = cross(less(b, a), less(c, a)), length = Math.hypot(...across);
      if (!length) continue;
      const normal = across.map((part) => part / length);
      for (let i = 0; i < 3; i++) {
        const from = own[faces[f + i]], to = own[faces[f + ((i + 1) % 3)]];
        const pair = Math.min(from, to) * 2 ** 24 + Math.max(from, to), other = pairs.get(pair);
        if (!other) pairs.set(pair, normal);
        else if (dot(normal, other) < SHARP) found.push(from, to);
      }
    }
    return Uint32Array.from(found);
  }

  function less(u, v) {
    return u.map((x, axis) => x - v[axis]);
  }

  function cross(u, v) {
    return [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
  }

  function dot(u, v) {
    return u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
  }

  // A body that comes without normals: they are means over the faces at a corner that meet at no sharp edge.
  function smallBuffers(body, arrays) {
    const points = Float32Array.from(arrays[body.points], (step) => step / body.steps);
    let named = 0;
    const faces = Uint32Array.from(arrays[body.corners], (newer) => newer ? named - newer : named++);
    const at = (v) => body.size_mm.map((size, axis) => size * points[3 * v + axis]);
    const across = [], meeting = Array.from({ length: named }, () => []);
    for (let f = 0; 3 * f < faces.length; f++) {
      const corners = [...faces.subarray(3 * f, 3 * f + 3)], [a, b, c] = corners.map(at);
      across.push(cross(less(b, a), less(c, a)));
      corners.forEach((corner) => meeting[corner].push(f));
    }
    const lengths = across.map((n) => Math.hypot(...n) || 1);
    const positions = new Float32Array(3 * faces.length), normals = new Int8Array(3 * faces.length);
    faces.forEach((v, corner) => {
      const own = Math.floor(corner / 3), sum = [0, 0, 0];
      for (const f of meeting[v])
        if (dot(across[own], across[f]) > SHARP * lengths[own] * lengths[f])
          across[f].forEach((part, axis) => (sum[axis] += part));
      const length = Math.hypot(...sum) || 1;
      positions.set(points.subarray(3 * v, 3 * v + 3), 3 * corner);
      normals.set(sum.map((part) => Math.round(127 * part / length)), 3 * corner);
    });
    const attributes = [[positions, 3, gl.FLOAT, false], [normals, 3, gl.BYTE, true]];
    const web = buffers(attributes, Uint32Array.from(faces.keys()));
    const lines = buffers(
      [[points, 3, gl.FLOAT, false]],
      sharpEdges(arrays[body.points], faces, body.size_mm.map((size) => size / body.steps)),
    );
    return { ...body, shares: [], web, edges: lines, journals: { ...web, count: 0 } };
  }

  // Shows a packed body in place of the page's own, or that again; false where another was asked for since.
  async function show(text) {
    const mine = ++asked, found = text && await unpack(text);
    if (mine !== asked) return false;
    if (other) discardHalves(other);
    [other] = found ? allBuffers(found.header.bodies, found.arrays) : [null];
    if (found) useRamp(found.header.stress);
    if (found) colourBy(state.colour);
    draw();
    return true;
  }

  // Draws a packed body over what is shown, as a ghost; none without it.
  async function showGhost(text) {
    const found = text && await unpack(text);
    if (ghost) discardHalves(ghost);
    [ghost] = found ? allBuffers(found.header.bodies, found.arrays) : [null];
    redraw();
  }

  // A picture of a packed body as the address of an image; the view stays as it is.
  async function picture(text) {
    const found = await unpack(text), before = other;
    [other] = allBuffers(found.header.bodies, found.arrays);
    draw();
    const address = canvas.toDataURL();
    discardHalves(other);
    other = before;
    draw();
    return address;
  }

  // Gives the surfaces the stresses of a load case, or takes them away.
  function colourBy(index) {
    state.colour = index;
    for (const body of [...bodies, ...(other ? [other, other.beyond] : [])])
      for (const shape of [body.web, body.journals]) {
        gl.bindVertexArray(shape.vao);
        if (index < 0 || !body.shares[index]) {
          gl.disableVertexAttribArray(2);
          continue;
        }
        shape.share ??= gl.createBuffer();
        gl.bindBuffer(gl.ARRAY_BUFFER, shape.share);
        gl.bufferData(gl.ARRAY_BUFFER, body.shares[index], gl.STATIC_DRAW);
        gl.enableVertexAttribArray(2);
        gl.vertexAttribPointer(2, 1, gl.UNSIGNED_BYTE, true, 0, 0);
      }
  }

  // Cells denser than the cut as blocks: the faces between kept cells and the rest.
  function cellBuffers(densities, cut) {
    const [nx, ny, nz] = steps.shape, least = Math.max(1, Math.round(cut * 255));
    const value = (i, j, k) =>
      i < 0 || j < 0 || k < 0 || i >= nx || j >= ny || k >= nz ? 0 : densities[(i * ny + j) * nz + k];
    const positions = [], normals = [], share = [], faces = [];
    const quad = (cell, axis, side, density) => {
      const first = positions.length / 3, u = (axis + 1) % 3, v = (axis + 2) % 3;
      for (const [du, dv] of [[0, 0], [1, 0], [1, 1], [0, 1]]) {
        const corner = [...cell];
        corner[axis] += side;
        corner[u] += du;
        corner[v] += dv;
        const normal = [0, 0, 0];
        normal[axis] = side ? 127 : -127;
        positions.push(...corner);
        normals.push(...normal);
        share.push(density);
      }
      faces.push(first, first + 1, first + 2, first, first + 2, first + 3);
    };
    for (let i = 0; i < nx; i++)
      for (let j = 0; j < ny; j++)
        for (let k = 0; k < nz; k++) {
          const density = value(i, j, k);
          if (density < least) continue;
          for (let axis = 0; axis < 3; axis++)
            for (const side of [0, 1]) {
              const next = [i, j, k];
              next[axis] += side ? 1 : -1;
              if (value(...next) < least) quad([i, j, k], axis, side, density);
            }
        }
    const attributes = [
      [new Float32Array(positions), 3, gl.FLOAT, false],
      [new Int8Array(normals), 3, gl.BYTE, true],
      [new Uint8Array(share), 1, gl.UNSIGNED_BYTE, true],
    ];
    return buffers(attributes, new Uint32Array(faces));
  }

  // What replaces a part of the view; where it is the same, nothing is painted: a drag paints each move once.
  function paintedAnew(before, now) {
    if (String(now) !== String(before)) redraw();
    return now;
  }

  function redraw() {
    if (waiting) return;
    waiting = true;
    requestAnimationFrame(() => {
      waiting = false;
      draw();
    });
  }

  function draw() {
    const scale = Math.min(window.devicePixelRatio || 1, 2);
    const width = Math.max(1, Math.round(canvas.clientWidth * scale));
    const height = Math.max(1, Math.round(canvas.clientHeight * scale));
    if (canvas.width !== width || canvas.height !== height) [canvas.width, canvas.height] = [width, height];
    gl.viewport(0, 0, width, height);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.useProgram(program);
    const body = other ?? bodies[state.body];
    const stressed = blocks === null && body.shares[state.colour] !== undefined;
    if (stress) gl.uniform3fv(uniforms.ramp, stress.ramp.flat());
    gl.uniform1i(uniforms.ramped, stressed ? 1 : 0);
    gl.uniform1f(uniforms.alpha, 1);
    aim(aimed ?? bodies[state.body], width / height);
    box.dataset.triangles = (body.journals.count + (blocks ?? body.web).count) / 3;
    (turns ?? [0]).forEach((angle, number) => {
      gl.uniform2f(uniforms.spin, Math.cos(angle), Math.sin(angle));
      drawHalves(body, number * pitch(body), JOURNAL, WEB);
    });
    if (spot && !turns) drawSpot(body);
    if (!ghost || turns) return;
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
    gl.depthMask(false);
    gl.enable(gl.POLYGON_OFFSET_FILL);
    gl.polygonOffset(2, 8); // where both are the same, the body itself is seen
    gl.uniform1i(uniforms.ramped, 0);
    gl.uniform1f(uniforms.alpha, 0.3);
    drawHalves(ghost, 0, GHOST, GHOST);
    gl.depthMask(true);
    gl.disable(gl.POLYGON_OFFSET_FILL);
    gl.disable(gl.BLEND);
  }

  function drawSpot(body) {
    dot3 ??= buffers([[Float32Array.of(1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1), 3, gl.FLOAT, false],
      [Int8Array.of(127, 0, 0, -127, 0, 0, 0, 127, 0, 0, -127, 0, 0, 0, 127, 0, 0, -127), 3, gl.BYTE, true]],
      Uint32Array.of(0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4, 2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5));
    const radius = SPOT_SHARE * Math.max(...body.size_mm);
    gl.disable(gl.DEPTH_TEST);
    gl.uniform1i(uniforms.ramped, 0);
    gl.uniform3f(uniforms.flip, 1, 1, 1);
    gl.uniform1f(uniforms.cut, NEVER);
    gl.uniform3f(uniforms.shift, ...spot);
    place([0, 0, 0], [radius, radius, radius]);
    paint(dot3, SPOT, SPOT);
    gl.enable(gl.DEPTH_TEST);
  }

  function drawHalves(body, along, journal, web) {
    for (const mirrored of state.whole || turns ? [false, true] : [false]) {
      const half = mirrored ? body.beyond : body;
      gl.uniform3f(uniforms.flip, 1, 1, mirrored ? -1 : 1);
      gl.frontFace(mirrored ? gl.CW : gl.CCW);
      gl.uniform1f(uniforms.cut, section ?? NEVER);
      if (section === null && blocks === null) gl.enable(gl.CULL_FACE); // else what is inside is seen
      gl.uniform3f(uniforms.shift, 0, 0, along + (mirrored ? pitch(body) : 0));
      place(half.low_mm, half.size_mm, half.sides_mm);
      gl.uniform3fv(uniforms.beyond, journal);
      paint(half.journals, journal, journal);
      if (blocks === null) {
        paint(half.web, web, web);
        if (web === WEB) paint(half.edges, EDGE, EDGE, gl.LINES);
      } else {
        place(steps.origin_mm, steps.cell_mm);
        paint(blocks, THIN, WEB);
      }
      gl.disable(gl.CULL_FACE);
    }
  }

  function aim(body, aspect) {
    const out = [
      Math.sin(state.yaw) * Math.cos(state.pitch),
      Math.sin(state.pitch),
      Math.cos(state.yaw) * Math.cos(state.pitch),
    ];
    const right = [Math.cos(state.yaw), 0, -Math.sin(state.yaw)];
    const up = [
      out[1] * right[2] - out[2] * right[1],
      out[2] * right[0] - out[0] * right[2],
      out[0] * right[1] - out[1] * right[0],
    ];
    const turn = [0, 1, 2].flatMap((i) => [right[i], up[i], out[i]]);
    const size = [...body.size_mm];
    const target = body.low_mm.map((low, i) => low + size[i] / 2);
    if (state.whole) {
      [target[2], size[2]] = [pitch(body) / 2, pitch(body)];
      for (const i of [0, 1]) size[i] = Math.max(size[i], body.beyond.size_mm[i]);
    }
    if (turns) {
      const reach = Math.max(...[0, 1].flatMap((i) => [-body.low_mm[i], body.low_mm[i] + body.size_mm[i]]));
      size.splice(0, 3, 2 * reach, 2 * reach, turns.length * pitch(body));
      target.splice(0, 3, 0, 0, size[2] / 2);
    }
    const radius = Math.hypot(...size) / 2;
    const scale = 1.06 * state.zoom * Math.min(aspect, 1) / radius; // parallel projection, as on a drawing
    lens = { right, up, out, target, scale, depth: 2 * radius };
    gl.uniformMatrix3fv(uniforms.turn, false, turn);
    gl.uniform3fv(uniforms.target, target);
    gl.uniform3f(uniforms.scale, scale / aspect, scale, -1 / (1.2 * radius));
  }

  function place(low, size, sides = EVERYWHERE) {
    gl.uniform3fv(uniforms.low, low);
    gl.uniform3fv(uniforms.size, size);
    gl.uniform2fv(uniforms.sides, sides);
    gl.uniform3fv(uniforms.beyond, JOURNAL);
  }

  function paint(shape, colour0, colour1, kind = gl.TRIANGLES) {
    const edge = kind === gl.LINES;
    gl.uniform1f(uniforms.nearer, edge ? 0.002 : 0); // than the faces that an edge bounds
    if (edge) gl.uniform3fv(uniforms.beyond, EDGE);
    gl.uniform3fv(uniforms.colour0, colour0);
    gl.uniform3fv(uniforms.colour1, colour1);
    gl.bindVertexArray(shape.vao);
    gl.drawElements(kind, shape.count, gl.UNSIGNED_INT, 0);
  }

  function turnBy(yaw, pitch) {
    state.yaw += yaw;
    state.pitch = Math.max(-1.55, Math.min(1.55, state.pitch + pitch));
    redraw();
  }

  function zoomBy(factor) {
    state.zoom = Math.max(0.4, Math.min(8, state.zoom * factor));
    redraw();
  }

  function controls() {
    const find = (name) => box.querySelector(`[data-${name}]`);
    pointer();
    canvas.addEventListener("keydown", (event) => {
      const keys = {
        ArrowLeft: () => turnBy(-0.12, 0), ArrowRight: () => turnBy(0.12, 0),
        ArrowUp: () => turnBy(0, 0.12), ArrowDown: () => turnBy(0, -0.12),
        "+": () => zoomBy(1.15), "=": () => zoomBy(1.15), "-": () => zoomBy(1 / 1.15),
        Home: () => look(START), 0: () => look(START),
      };
      if (!keys[event.key] || event.ctrlKey || event.metaKey || event.altKey) return;
      event.preventDefault();
      keys[event.key]();
    });
    box.querySelectorAll("[data-view]").forEach((button) => {
      button.addEventListener("click", () => {
        const [yaw, pitch] = button.dataset.view.split(",").map(Number);
        look({ yaw, pitch, zoom: 1 });
      });
    });
    find("whole").addEventListener("change", (event) => {
      state.whole = event.target.checked;
      redraw();
    });
    const body = find("body");
    body?.addEventListener("change", () => {
      state.body = Number(body.value);
      redraw();
    });
    const colour = find("colour");
    colour?.addEventListener("change", () => {
      colourBy(Number(colour.value));
      legend();
      redraw();
    });
    if (steps) stepControls(find("step"), find("step-text"), find("cut"), find("cut-row"), find("play"));
  }

  // Says what the colours mean: parts and densities, or stresses.
  function legend() {
    const stressed = state.colour >= 0 && blocks === null;
    box.querySelectorAll("[data-parts]").forEach((entry) => (entry.hidden = stressed));
    const select = box.querySelector("[data-colour]"), entry = box.querySelector("[data-stress]");
    if (!stress) return;
    select.disabled = blocks !== null;
    entry.hidden = !stressed;
    if (!stressed) return;
    const [swatch, text] = entry.children, found = stress.cases[state.colour];
    const stops = stress.ramp.map((rgb) => `rgb(${rgb.map((part) => Math.round(255 * part)).join()})`);
    swatch.style.background = `linear-gradient(90deg, ${stops.join()})`;
    text.textContent = `von Mises stress, ${found.label}: 0 to ${found.top_MPa.toPrecision(3)} MPa and more`;
  }

  function stepControls(slider, text, cut, cutRow, play) {
    const last = steps.iterations.length;
    let timer = 0;
    const show = () => {
      state.step = Number(slider.value);
      if (blocks) discard(blocks);
      blocks = state.step === last ? null : cellBuffers(arrays[steps.densities[state.step]], state.cut);
      const iteration = steps.iterations[state.step];
      const line = blocks ? `Iteration ${iteration}: ${steps.notes[state.step]}` : "Final surface";
      text.textContent = line;
      slider.setAttribute("aria-valuetext", line);
      cutRow.hidden = !blocks;
      legend();
      redraw();
    };
    const stop = () => {
      clearInterval(timer);
      timer = 0;
      play.textContent = "Play";
    };
    slider.addEventListener("input", () => {
      stop();
      show();
    });
    cut.addEventListener("input", () => {
      state.cut = Number(cut.value);
      show();
    });
    play.addEventListener("click", () => {
      if (timer) return stop();
      if (state.step === last) slider.value = 0;
      show();
      play.textContent = "Stop";
      timer = setInterval(() => {
        slider.value = state.step + 1;
        show();
        if (state.step === last) stop();
      }, 220);
    });
    show();
  }

  function look(view) {
    Object.assign(state, view);
    redraw();
  }

  function pointer() {
    let held = null, way = 0;
    canvas.addEventListener("pointerdown", (event) => {
      held = [event.clientX, event.clientY];
      way = 0;
      canvas.setPointerCapture(event.pointerId);
      canvas.focus({ preventScroll: true });
    });
    canvas.addEventListener("pointermove", (event) => {
      if (!held) return;
      way += Math.hypot(event.clientX - held[0], event.clientY - held[1]);
      turnBy(-(event.clientX - held[0]) * 0.01, (event.clientY - held[1]) * 0.01);
      held = [event.clientX, event.clientY];
    });
    for (const end of ["pointerup", "pointercancel"])
      canvas.addEventListener(end, ({ type, clientX, clientY }) => {
        if (held && type === "pointerup" && way < PRESSED) box.dispatchEvent(new CustomEvent("press", { detail: box.sight(clientX, clientY) }));
        held = null;
      });
    canvas.addEventListener(
      "wheel",
      (event) => {
        if (document.activeElement !== canvas && !event.ctrlKey) return;
        event.preventDefault();
        zoomBy(Math.exp(-event.deltaY * 0.0012));
      },
      { passive: false },
    );
  }
})();
