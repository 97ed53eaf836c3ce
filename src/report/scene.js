// The three-dimensional view: relief, walls of what is closed, paths, and names over them.

const scene3d = (() => {
  const figure = element("scene"), canvas = element("gl"), over = element("over");
  const gl = canvas.getContext("webgl2", { antialias: true, alpha: false, preserveDrawingBuffer: true });
  if (!gl) {
    element("no-gl").hidden = false;
    figure.querySelector(".tools").hidden = true;
    return { ready: false };
  }
  const pen = over.getContext("2d");
  const b = scene.bounds, middle = [(b.west + b.east) / 2, (b.south + b.north) / 2];
  const scale = 2 / Math.hypot(b.east - b.west, b.north - b.south);
  const known = scene.relief.heights_dm.filter((height) => height !== null);
  const low = known.reduce((a, h) => Math.min(a, h), known.length ? Infinity : 0) / 10;
  const high = known.reduce((a, h) => Math.max(a, h), known.length ? -Infinity : 0) / 10;
  const flown = scene.vehicles.reduce((top, vehicle) => vehicle.track.z.reduce((a, z) => Math.max(a, z), top), high);
  const span = Math.max(b.east - b.west, b.north - b.south);
  const top = flown + Math.max(60, (flown - low) * 0.18), floor = low - Math.max(30, (high - low) * 0.14);
  const steps = [1, 2, 3, 5, 8];
  let exaggeration = steps.find((step) => ((top - low) * step) / span > 0.085) || 8;
  const interval = roundStep(Math.max(high - low, 1) / 14);

  const SHARED = `#version 300 es
    precision highp float;
    uniform mat4 m; uniform vec4 box; uniform float ex; uniform vec2 size; uniform vec3 pal[8]; uniform float focus;
    vec4 at(vec3 p) { return m * vec4((p.xy - box.xy) * box.w, (p.z - box.z) * box.w * ex, 1.0); }
    float dim(float who) { return focus < 0.0 || who < 0.0 || abs(who - focus) < 0.5 ? 1.0 : 0.22; }`;
  const COLOUR = `#version 300 es
    precision highp float; in vec4 colour; out vec4 o; void main() { o = colour; }`;

  function program(vertex, fragment) {
    const made = gl.createProgram();
    for (const [kind, text] of [[gl.VERTEX_SHADER, SHARED + vertex], [gl.FRAGMENT_SHADER, fragment]]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, text);
      gl.compileShader(shader);
      if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
      gl.attachShader(made, shader);
    }
    gl.linkProgram(made);
    const found = new Map();
    return { made, at: (name) => {
      if (!found.has(name)) found.set(name, gl.getUniformLocation(made, name));
      return found.get(name);
    } };
  }

  const terrain = program(`
    layout(location=0) in vec3 p; layout(location=1) in vec2 slope;
    out vec3 normal; out float z;
    void main() { gl_Position = at(p); normal = vec3(-slope * ex, 1.0); z = p.z; }`, `#version 300 es
    precision highp float; in vec3 normal; in float z; out vec4 o;
    uniform vec3 low, mid, high, ink; uniform vec3 range;
    void main() {
      float share = clamp((z - range.x) / max(range.y - range.x, 1.0), 0.0, 1.0);
      vec3 tint = share < 0.5 ? mix(low, mid, share * 2.0) : mix(mid, high, share * 2.0 - 1.0);
      vec3 n = normalize(normal);
      float light = dot(n, normalize(vec3(-0.55, 0.5, 0.8)));
      float sky = 0.5 + 0.5 * n.z;
      tint *= 0.34 + 0.30 * sky + 0.50 * max(light, 0.0);
      float line = z / range.z, width = fwidth(line);
      float near = abs(fract(line - 0.5) - 0.5) / max(width, 1e-6);
      float index = abs(fract(line / 5.0 - 0.5) - 0.5) * 5.0 / max(width, 1e-6);
      float drawn = max((1.0 - smoothstep(0.4, 1.3, near)) * 0.16, (1.0 - smoothstep(0.6, 1.7, index)) * 0.26);
      o = vec4(mix(tint, ink, drawn * (1.0 - smoothstep(0.25, 0.6, width))), 1.0);
    }`);
  const walls = program(`
    layout(location=0) in vec3 p; layout(location=1) in vec4 c; out vec4 colour;
    void main() { gl_Position = at(p); colour = c; }`, COLOUR);
  const curtains = program(`
    layout(location=0) in vec3 a; layout(location=1) in vec3 b; layout(location=2) in vec2 who; uniform float base; out vec4 colour;
    void main() {
      vec3 p = (gl_VertexID & 2) == 0 ? a : b;
      if ((gl_VertexID & 1) == 0) p.z = base;
      gl_Position = at(p); colour = vec4(pal[int(who.x)], 0.17 * dim(who.y));
    }`, COLOUR);
  const lines = program(`
    layout(location=0) in vec3 a; layout(location=1) in vec3 b; layout(location=2) in vec2 who;
    uniform float width, alpha; uniform vec3 plain; out vec4 colour;
    void main() {
      vec4 A = at(a), B = at(b);
      vec2 along = B.xy / B.w * size - A.xy / A.w * size;
      along = length(along) > 1e-4 ? normalize(along) : vec2(1.0, 0.0);
      float end = (gl_VertexID & 2) == 0 ? -1.0 : 1.0, side = (gl_VertexID & 1) == 0 ? -1.0 : 1.0;
      vec4 P = end < 0.0 ? A : B;
      P.xy += (vec2(-along.y, along.x) * side + along * end * 0.4) * width / size * P.w;
      P.z -= 0.0012 * P.w;
      gl_Position = P;
      colour = vec4(who.x < 0.0 ? plain : pal[int(who.x)], alpha * dim(who.y));
    }`, COLOUR);
  const dots = program(`
    layout(location=0) in vec3 p; layout(location=1) in vec2 who; uniform float width; uniform vec3 plain; out vec4 colour; out vec3 eye;
    void main() { gl_Position = at(p); gl_Position.z -= 0.002 * gl_Position.w; gl_PointSize = width;
      colour = vec4(pal[int(who.x)], dim(who.y)); eye = plain; }`, `#version 300 es
    precision highp float; in vec4 colour; in vec3 eye; out vec4 o;
    void main() { float r = length(gl_PointCoord - 0.5) * 2.0; if (r > 1.0) discard; o = r < 0.42 ? vec4(eye, colour.a) : colour; }`);

  /** Vertex arrays: `sizes` are the floats of each attribute; `divisor` 1 for one instance each. */
  function mesh(values, sizes, divisor = 0, indices = null) {
    const array = gl.createVertexArray(), stride = sizes.reduce((a, s) => a + s, 0);
    gl.bindVertexArray(array);
    gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(values), gl.STATIC_DRAW);
    let offset = 0;
    sizes.forEach((size, place) => {
      gl.enableVertexAttribArray(place);
      gl.vertexAttribPointer(place, size, gl.FLOAT, false, stride * 4, offset * 4);
      gl.vertexAttribDivisor(place, divisor);
      offset += size;
    });
    if (indices) {
      gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, gl.createBuffer());
      gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, new Uint32Array(indices), gl.STATIC_DRAW);
    }
    return { array, count: indices ? indices.length : values.length / stride };
  }

  function reliefMesh() {
    const { columns, rows, heights_dm: heights } = scene.relief, values = [], indices = [];
    const de = (b.east - b.west) / (columns - 1), dn = (b.north - b.south) / (rows - 1);
    const at = (column, row) => {
      const height = heights[clamp(row, 0, rows - 1) * columns + clamp(column, 0, columns - 1)];
      return height === null ? null : height / 10;
    };
    const slope = (before, here, after, step) => ((after ?? here) - (before ?? here)) / (step * ((before === null ? 0 : 1) + (after === null ? 0 : 1) || 1));
    for (let row = 0; row < rows; row++) {
      for (let column = 0; column < columns; column++) {
        const here = at(column, row);
        values.push(b.west + column * de, b.south + row * dn, here ?? low,
          slope(at(column - 1, row), here ?? low, at(column + 1, row), de), slope(at(column, row - 1), here ?? low, at(column, row + 1), dn));
        const corner = row * columns + column;
        if (column + 1 < columns && row + 1 < rows && ![corner, corner + 1, corner + columns, corner + columns + 1].some((i) => heights[i] === null)) {
          indices.push(corner, corner + 1, corner + columns, corner + 1, corner + columns + 1, corner + columns);
        }
      }
    }
    return mesh(values, [3, 2], 0, indices);
  }

  /** The cut sides of the block of ground. */
  function sidesMesh(colour) {
    const { columns, rows } = scene.relief, values = [];
    const de = (b.east - b.west) / (columns - 1), dn = (b.north - b.south) / (rows - 1);
    const strip = (count, place) => {
      for (let i = 0; i + 1 < count; i++) {
        const [p, q] = [place(i), place(i + 1)], hp = reliefAt(...p), hq = reliefAt(...q);
        if (hp === null || hq === null) continue;
        for (const [[e, n], z] of [[p, hp], [q, hq], [p, floor], [q, hq], [q, floor], [p, floor]]) values.push(e, n, z, ...colour, 1);
      }
    };
    strip(columns, (i) => [Math.min(b.west + i * de, b.east), b.south]);
    strip(columns, (i) => [Math.min(b.west + i * de, b.east), b.north]);
    strip(rows, (i) => [b.west, Math.min(b.south + i * dn, b.north)]);
    strip(rows, (i) => [b.east, Math.min(b.south + i * dn, b.north)]);
    return mesh(values, [3, 4]);
  }

  const circle = (threat) => Array.from({ length: 97 }, (_, i) => {
    const angle = (i / 96) * 2 * Math.PI;
    return [threat.at[0] + threat.radius_m * Math.cos(angle), threat.at[1] + threat.radius_m * Math.sin(angle)];
  });
  const dense = (ring) => ring.slice(1).flatMap((to, i) => {
    const from = ring[i], pieces = Math.max(1, Math.ceil(Math.hypot(to[0] - from[0], to[1] - from[1]) / (span / 150)));
    return Array.from({ length: pieces }, (_, k) => [0, 1].map((axis) => from[axis] + ((to[axis] - from[axis]) * k) / pieces));
  }).concat([ring[ring.length - 1]]);

  /** Walls from under the ground: what the ground hides is hidden. They fade where they have no top. */
  function wallsMesh(threat, zone) {
    const values = [];
    const wall = (ring, ceiling, colour, foot, head) => {
      for (let i = 0; i + 1 < ring.length; i++) {
        const [p, q] = [ring[i], ring[i + 1]];
        for (const [at, z, a] of [[p, floor, foot], [q, floor, foot], [p, ceiling, head], [q, floor, foot], [q, ceiling, head], [p, ceiling, head]]) {
          values.push(at[0], at[1], z, ...colour, a);
        }
      }
    };
    for (const t of scene.threats) wall(circle(t), top, threat, 0.36, 0.05);
    for (const z of scene.zones) wall(z.ring, z.below_m === null ? top : Math.min(z.below_m, top), zone, 0.34, z.below_m === null ? 0.05 : 0.3);
    return mesh(values, [3, 4]);
  }

  function rings(list) {
    const values = [];
    const onGround = (ring) => ring.map(([e, n]) => [e, n, (reliefAt(e, n) ?? low) + (high - low) * 0.002 + 0.5]);
    const join = (points) => {
      for (let i = 0; i + 1 < points.length; i++) values.push(...points[i], ...points[i + 1], -1, -1);
    };
    for (const { ring, z } of list) join(z === null ? onGround(ring) : ring.map(([e, n]) => [e, n, z]));
    return mesh(values, [3, 3, 2], 1);
  }

  function flights() {
    const legs = [], points = [];
    scene.vehicles.forEach(({ track, waypoints }, index) => {
      const who = [index % data.colours.length, index];
      for (let i = 0; i + 1 < track.t.length; i++) {
        legs.push(track.e[i], track.n[i], track.z[i], track.e[i + 1], track.n[i + 1], track.z[i + 1], ...who);
      }
      for (const [e, n, z] of waypoints) points.push(e, n, z, ...who);
    });
    return { legs: mesh(legs, [3, 3, 2], 1), points: mesh(points, [3, 2]) };
  }

  const rgb = (name) => {
    const hex = themed(name).slice(1);
    return [0, 2, 4].map((i) => parseInt(hex.slice(i, i + 2), 16) / 255);
  };
  const shape = reliefMesh(), flight = flights();
  const threatRings = rings(scene.threats.map((t) => ({ ring: circle(t), z: null })));
  const zoneRings = rings(scene.zones.flatMap((z) => [{ ring: dense(z.ring), z: null }].concat(
    z.below_m === null || z.below_m > top ? [] : [{ ring: z.ring, z: z.below_m }])));
  const areaRing = rings([{ ring: dense(scene.area), z: null }]);
  let colours, side, closed;
  function dress() {
    colours = Object.fromEntries(["low", "mid", "high", "ink", "sky", "halo", "threat", "zone", "side", "soft"].map((name) => [name, rgb("--" + name)]));
    colours.pal = data.colours.flatMap((_, i) => rgb("--v" + i));
    side = sidesMesh(colours.side);
    closed = wallsMesh(colours.threat, colours.zone);
  }
  dress();

  const camera = {};
  function reset() {
    Object.assign(camera, { az: -0.42, el: 0.66, distance: 2.7, target: [-0.05, -0.1, (top - low) * scale * exaggeration * 0.15] });
  }
  reset();

  const cross = (u, v) => [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
  const dot3 = (u, v) => u[0] * v[0] + u[1] * v[1] + u[2] * v[2];

  /** Column-major matrix from the world (1 is half a diagonal) to clip space. */
  function matrix(aspect) {
    const { az, el, target } = camera, distance = camera.distance * Math.max(1, 1.15 / aspect);
    const back = [Math.sin(az) * Math.cos(el), -Math.cos(az) * Math.cos(el), Math.sin(el)];
    const right = [Math.cos(az), Math.sin(az), 0], up = cross(back, right);
    const eye = target.map((value, axis) => value + back[axis] * distance);
    const f = 1 / Math.tan(0.3), near = Math.max(0.02, distance - 2.5), far = distance + 4;
    const row = (v) => [v[0], v[1], v[2], -dot3(v, eye)];
    const [r, u, k] = [row(right), row(up), row(back)];
    const out = new Float32Array(16);
    for (let i = 0; i < 4; i++) {
      out[i * 4] = (r[i] * f) / aspect;
      out[i * 4 + 1] = u[i] * f;
      out[i * 4 + 2] = (k[i] * (far + near)) / (near - far) + (i === 3 ? (2 * far * near) / (near - far) : 0);
      out[i * 4 + 3] = -k[i];
    }
    return out;
  }

  let m = null, width = 0, height = 0;
  /** Where a point is on the view, in CSS pixels; null behind the eye. */
  function project(e, n, z) {
    const p = [(e - middle[0]) * scale, (n - middle[1]) * scale, (z - low) * scale * exaggeration, 1];
    const clip = [0, 1, 3].map((i) => m[i] * p[0] + m[4 + i] * p[1] + m[8 + i] * p[2] + m[12 + i]);
    return clip[2] > 0.01 ? { x: ((clip[0] / clip[2] + 1) / 2) * width, y: ((1 - clip[1] / clip[2]) / 2) * height } : null;
  }

  function use(which) {
    gl.useProgram(which.made);
    gl.uniformMatrix4fv(which.at("m"), false, m);
    gl.uniform4f(which.at("box"), middle[0], middle[1], low, scale);
    gl.uniform1f(which.at("ex"), exaggeration);
    gl.uniform2f(which.at("size"), width, height);
    gl.uniform1f(which.at("focus"), state.focus);
    gl.uniform3fv(which.at("pal"), colours.pal);
  }

  function drawLines(which, pixels, colour, alpha) {
    if (!which.count) return;
    gl.uniform1f(lines.at("width"), pixels);
    gl.uniform1f(lines.at("alpha"), alpha);
    gl.uniform3fv(lines.at("plain"), colour);
    gl.bindVertexArray(which.array);
    gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, which.count);
  }

  function drawModel() {
    gl.viewport(0, 0, canvas.width, canvas.height);
    // Clearing heeds the mask.
    gl.depthMask(true);
    gl.clearColor(...colours.sky, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.enable(gl.DEPTH_TEST);
    gl.disable(gl.BLEND);
    use(walls);
    gl.bindVertexArray(side.array);
    gl.drawArrays(gl.TRIANGLES, 0, side.count);
    use(terrain);
    for (const name of ["low", "mid", "high", "ink"]) gl.uniform3fv(terrain.at(name), colours[name]);
    gl.uniform3f(terrain.at("range"), low, high, interval);
    gl.bindVertexArray(shape.array);
    gl.drawElements(gl.TRIANGLES, shape.count, gl.UNSIGNED_INT, 0);
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
    gl.depthMask(false);
    use(lines);
    drawLines(areaRing, 1.2, colours.ink, 0.5);
    drawLines(threatRings, 1.6, colours.threat, 0.9);
    drawLines(zoneRings, 1.6, colours.zone, 0.9);
    // Paths behind hills stay faintly visible.
    gl.depthFunc(gl.GREATER);
    drawLines(flight.legs, 1.4, colours.ink, 0.3);
    gl.depthFunc(gl.LESS);
    use(curtains);
    gl.uniform1f(curtains.at("base"), floor);
    gl.bindVertexArray(flight.legs.array);
    if (flight.legs.count) gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, flight.legs.count);
    use(walls);
    gl.bindVertexArray(closed.array);
    gl.drawArrays(gl.TRIANGLES, 0, closed.count);
    use(lines);
    drawLines(flight.legs, 2.8, colours.ink, 1);
    use(dots);
    gl.uniform1f(dots.at("width"), 7 * devicePixelRatio);
    gl.uniform3fv(dots.at("plain"), colours.halo);
    gl.bindVertexArray(flight.points.array);
    if (flight.points.count && flight.points.count < 4000) gl.drawArrays(gl.POINTS, 0, flight.points.count);
  }

  // Over the model: axes, names, and the vehicles.
  function name(text, at, colour, align = "center", bold = true) {
    if (!at) return;
    pen.font = (bold ? "600 " : "") + "12px system-ui, sans-serif";
    pen.textAlign = align;
    pen.lineWidth = 3.5;
    pen.strokeStyle = themed("--sky");
    pen.fillStyle = colour;
    pen.strokeText(text, at.x, at.y);
    pen.fillText(text, at.x, at.y);
  }

  function stroke(points, colour, pixels) {
    if (points.includes(null)) return;
    pen.beginPath();
    points.forEach((p, i) => (i ? pen.lineTo(p.x, p.y) : pen.moveTo(p.x, p.y)));
    pen.strokeStyle = colour;
    pen.lineWidth = pixels;
    pen.stroke();
  }

  function axes() {
    const soft = themed("--soft"), step = roundStep((b.east - b.west) / 5), text = (m) => (step >= 1000 ? (m / 1000).toFixed(0) : (m / 1000).toFixed(1));
    const south = Math.cos(camera.az) > 0, west = Math.sin(camera.az) <= 0;
    const n0 = south ? b.south : b.north, e0 = west ? b.west : b.east, out = 0.018 * span;
    const ticks = (from, to, place, aside, unit) => {
      for (let v = Math.ceil(from / step) * step; v <= to; v += step) {
        const at = project(...place(v), floor), end = project(...aside(v), floor), far = project(...aside(v, 2.6), floor);
        stroke([at, end], soft, 1);
        name(text(v), far && { x: far.x, y: far.y + 4 }, soft, "center", false);
      }
      const mid = project(...aside((from + to) / 2 + step * 0.5, 5.2), floor);
      name(unit, mid && { x: mid.x, y: mid.y + 4 }, soft, "center", false);
    };
    const sn = south ? -out : out, se = west ? -out : out;
    ticks(b.west, b.east, (v) => [v, n0], (v, k = 1) => [v, n0 + sn * k], "km east");
    ticks(b.south, b.north, (v) => [e0, v], (v, k = 1) => [e0 + se * k, v], "km north");
    // Heights at the leftmost corner.
    const corners = [[b.west, b.south], [b.east, b.south], [b.west, b.north], [b.east, b.north]];
    const left = corners.map((c) => ({ c, p: project(...c, floor) })).filter((x) => x.p).sort((p, q) => p.p.x - q.p.x)[0];
    if (!left || camera.el > 1.3) return;
    const rise = roundStep((top - low) / 4);
    stroke([project(...left.c, reliefAt(...left.c) ?? low), project(...left.c, top)], soft, 1);
    for (let z = Math.ceil(low / rise) * rise; z <= top; z += rise) {
      const at = project(...left.c, z);
      stroke([at, at && { x: at.x - 5, y: at.y }], soft, 1);
      name(z + (z + rise > top ? " m" : ""), at && { x: at.x - 9, y: at.y + 4 }, soft, "right", false);
    }
  }

  function markers() {
    const few = scene.vehicles.length <= 40, halo = themed("--halo");
    for (const threat of scene.threats) name(threat.id, project(...threat.at, top), themed("--threat"));
    for (const zone of scene.zones) {
      const count = zone.ring.length - 1, sum = (axis) => zone.ring.slice(0, count).reduce((a, c) => a + c[axis], 0) / count;
      name(zone.id, project(sum(0), sum(1), zone.below_m === null ? top : Math.min(zone.below_m, top)), themed("--zone"));
    }
    scene.vehicles.forEach((vehicle, index) => {
      const colour = themed("--v" + (index % data.colours.length));
      pen.globalAlpha = state.focus < 0 || state.focus === index ? 1 : 0.25;
      const spot = (at, radius, square, hollow) => {
        const p = project(...at);
        if (!p) return;
        pen.beginPath();
        if (square) pen.rect(p.x - radius, p.y - radius, 2 * radius, 2 * radius); else pen.arc(p.x, p.y, radius, 0, 7);
        pen.fillStyle = hollow ? halo : colour;
        pen.strokeStyle = hollow ? colour : halo;
        pen.lineWidth = hollow ? 2.5 : 1.2;
        pen.fill();
        pen.stroke();
      };
      if (few) {
        spot(vehicle.home, 4, true, false);
        spot(vehicle.start, 4.5, false, false);
        spot(vehicle.goal, 4.5, false, true);
      }
      const fix = fixAt(vehicle.track, state.t);
      if (fix) {
        const p = project(fix.e, fix.n, fix.z);
        stroke([p, project(fix.e, fix.n, reliefAt(fix.e, fix.n) ?? low)], colour, 1.3);
        if (p) {
          pen.globalAlpha *= fix.flying ? 1 : 0.45;
          pen.beginPath();
          pen.arc(p.x, p.y, 7, 0, 7);
          pen.fillStyle = colour;
          pen.strokeStyle = "#fff";
          pen.lineWidth = 2;
          pen.fill();
          pen.stroke();
          if (few || state.focus === index) name(vehicle.id, { x: p.x + 11, y: p.y - 8 }, themed("--ink"), "left");
        }
      }
      pen.globalAlpha = 1;
    });
    if (state.mark) {
      const p = project(state.mark.e, state.mark.n, state.mark.z);
      if (p) {
        pen.beginPath();
        pen.arc(p.x, p.y, 13, 0, 7);
        pen.strokeStyle = themed("--accent");
        pen.lineWidth = 3;
        pen.stroke();
      }
    }
  }

  function paint() {
    const box = figure.getBoundingClientRect();
    if (!box.width || !box.height) return;
    const ratio = Math.min(devicePixelRatio, 2);
    [width, height] = [box.width, box.height];
    for (const each of [canvas, over]) {
      const [w, h] = [Math.round(width * ratio), Math.round(height * ratio)];
      if (each.width !== w || each.height !== h) { each.width = w; each.height = h; }
    }
    m = matrix(width / height);
    drawModel();
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    pen.clearRect(0, 0, width, height);
    pen.lineJoin = "round";
    axes();
    markers();
  }

  let asked = false;
  /** Paints once in the next frame, however often it is asked. */
  function draw() {
    if (asked) return;
    asked = true;
    requestAnimationFrame(() => { asked = false; paint(); });
  }

  gestures(figure, {
    drag(dx, dy, second) {
      if (second) {
        const step = (camera.distance * 0.62) / height, c = Math.cos(camera.az), s = Math.sin(camera.az);
        const away = (dy * step) / Math.max(0.35, Math.sin(camera.el));
        camera.target[0] += -dx * step * c - away * s;
        camera.target[1] += -dx * step * s + away * c;
        camera.target[0] = clamp(camera.target[0], -1, 1);
        camera.target[1] = clamp(camera.target[1], -1, 1);
      } else {
        camera.az -= dx * 0.007;
        camera.el = clamp(camera.el + dy * 0.006, 0.08, 1.569);
      }
      draw();
    },
    zoom(factor) {
      camera.distance = clamp(camera.distance / factor, 0.25, 5);
      draw();
    },
  });
  canvas.addEventListener("keydown", (event) => {
    const act = { ArrowLeft: () => (camera.az -= 0.08), ArrowRight: () => (camera.az += 0.08), ArrowUp: () => (camera.el = clamp(camera.el + 0.06, 0.08, 1.569)),
      ArrowDown: () => (camera.el = clamp(camera.el - 0.06, 0.08, 1.569)), "+": () => (camera.distance = clamp(camera.distance * 0.9, 0.25, 5)), "-": () => (camera.distance = clamp(camera.distance / 0.9, 0.25, 5)) }[event.key];
    if (!act) return;
    event.preventDefault();
    act();
    draw();
  });
  const exaggerate = element("exaggerate");
  const label = () => { exaggerate.textContent = "height × " + exaggeration; };
  exaggerate.addEventListener("click", () => {
    exaggeration = steps[(steps.indexOf(exaggeration) + 1) % steps.length];
    label();
    draw();
  });
  element("from-above").addEventListener("click", () => { Object.assign(camera, { az: 0, el: 1.569, target: [0, 0, 0] }); draw(); });
  element("home-view").addEventListener("click", () => { reset(); draw(); });
  label();
  whenResized(figure, paint);
  whenChanged((what) => {
    if (what === "theme") dress();
    if (what === "mark" && state.mark) {
      camera.target = [(state.mark.e - middle[0]) * scale, (state.mark.n - middle[1]) * scale, (state.mark.z - low) * scale * exaggeration];
      camera.distance = Math.min(camera.distance, 1.5);
    }
    draw();
  });
  return { ready: true, paint };
})();
