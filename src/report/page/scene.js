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
  const { low, high, top, floor, span } = solids;
  const steps = [1, 2, 3, 5, 8];
  let exaggeration = steps.find((step) => ((top - low) * step) / span > 0.085) || 8;
  // No lines on a plain, as in the map.
  const interval = high - low < 1 ? 0 : roundStep((high - low) / 14);

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

  const [terrain, walls, curtains, lines, dots] = ["terrain", "walls", "curtains", "lines", "dots"].map((name) => program(...SHADERS[name]));

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

  const rgb = (name) => {
    const hex = themed(name).slice(1);
    return [0, 2, 4].map((i) => parseInt(hex.slice(i, i + 2), 16) / 255);
  };
  const ground = solids.relief(), flown = solids.flights();
  const shape = mesh(ground.values, [3, 2], 0, ground.indices);
  const flight = { legs: mesh(flown.legs, [3, 3, 2], 1), points: mesh(flown.points, [3, 2]) };
  const { circle, dense } = solids, rings = (list) => mesh(solids.rings(list), [3, 3, 2], 1);
  const threatRings = rings(scene.threats.map((t) => ({ ring: circle(t), z: null })));
  const zoneRings = rings(scene.zones.flatMap((z) => [{ ring: dense(z.ring), z: null }].concat(
    z.below_m === null || z.below_m > top ? [] : [{ ring: z.ring, z: z.below_m }])));
  const areaRing = rings([{ ring: dense(scene.area), z: null }]);
  let colours, side, closed;
  function dress() {
    colours = Object.fromEntries(["low", "mid", "high", "ink", "sky", "halo", "threat", "zone", "side", "soft"].map((name) => [name, rgb("--" + name)]));
    colours.pal = data.colours.flatMap((_, i) => rgb("--v" + i));
    side = mesh(solids.sides(colours.side), [3, 4]);
    closed = mesh(solids.walls(colours.threat, colours.zone), [3, 4]);
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
    const { az, el, target } = camera, distance = camera.distance * Math.max(1, 1.3 / aspect);
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
    drawLines(flight.legs, 1.4 * crowd, colours.ink, 0.3 * crowd);
    gl.depthFunc(gl.LESS);
    use(curtains);
    gl.uniform1f(curtains.at("base"), floor);
    gl.bindVertexArray(flight.legs.array);
    // Of many vehicles only the chosen one has a curtain and waypoints that can be told apart.
    const single = scene.vehicles.length <= MANY || state.focus >= 0;
    if (flight.legs.count && single) gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, flight.legs.count);
    use(walls);
    gl.bindVertexArray(closed.array);
    gl.drawArrays(gl.TRIANGLES, 0, closed.count);
    use(lines);
    drawLines(flight.legs, 2.8 * crowd, colours.ink, 1);
    use(dots);
    gl.uniform1f(dots.at("width"), 7 * devicePixelRatio);
    gl.uniform3fv(dots.at("plain"), colours.halo);
    gl.bindVertexArray(flight.points.array);
    if (flight.points.count && single) gl.drawArrays(gl.POINTS, 0, flight.points.count);
  }

  // Over the model: axes, names, and the vehicles.
  function name(text, at, colour, align = "center", bold = true, size = 12) {
    if (!at) return;
    pen.font = (bold ? "600 " : "") + size + "px system-ui, sans-serif";
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
    const soft = themed("--soft"), step = roundStep((b.east - b.west) / 5), text = (m) => (m / 1000).toFixed(digitsFor(step / 1000));
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
    let last = Infinity;
    for (let z = Math.ceil(low / rise) * rise; z <= top; z += rise) {
      const at = project(...left.c, z);
      if (!at || last - at.y < 14) continue;
      last = at.y;
      stroke([at, at && { x: at.x - 5, y: at.y }], soft, 1);
      name(z + (z === Math.ceil(low / rise) * rise ? " m" : ""), at && { x: at.x - 9, y: at.y + 4 }, soft, "right", false);
    }
  }

  /** What the discs of the vehicles cover, for names to stay off them. */
  const vehiclesNow = () => scene.vehicles.slice(0, MANY).flatMap(({ track }) => {
    const fix = fixAt(track, state.t), p = fix && project(fix.e, fix.n, fix.z);
    return p ? [{ left: p.x - 8, right: p.x + 8, top: p.y - 8, bottom: p.y + 8 }] : [];
  });

  function markers() {
    const few = scene.vehicles.length <= MANY, halo = themed("--halo");
    // Off the buttons and the vehicles.
    const taken = [{ left: width - 270, right: width, top: 0, bottom: 42 }, ...vehiclesNow()];
    const place = placer({ left: 4, top: 4, right: width - 4, bottom: height - 4 }, taken);
    /** A name where it has space; one whose point is out of view is not written. */
    const written = (text, at, colour, side) => {
      if (!at || at.x < 0 || at.x > width || at.y < 0 || at.y > height) return;
      const found = place(at, side, textWidth(text, 12), 12, side === "middle");
      if (found) name(text, { x: found.x, y: found.y + 4 }, colour, "center", true, 12 * found.share);
    };
    // The planned way under what was flown.
    scene.vehicles.forEach((vehicle, index) => {
      pen.globalAlpha = state.focus < 0 || state.focus === index ? 0.45 : 0.12;
      for (const way of vehicle.flown?.planned ?? []) {
        const colour = themed("--v" + (index % data.colours.length));
        for (let i = 1; i < way.length; i++) stroke([project(...way[i - 1]), project(...way[i])], colour, 6);
      }
      pen.globalAlpha = 1;
    });
    scene.vehicles.forEach((vehicle, index) => {
      const colour = themed("--v" + (index % data.colours.length));
      pen.globalAlpha = state.focus < 0 || state.focus === index ? 1 : 0.25;
      const station = (at, radius, square, hollow) => {
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
        station(vehicle.home, 4, true, false);
        station(vehicle.start, 4.5, false, false);
        station(vehicle.goal, 4.5, false, true);
        for (const stop of vehicle.stops) station(stop.at, 3.5, true, true);
      }
      const fix = fixAt(vehicle.track, state.t);
      if (fix) {
        const p = project(fix.e, fix.n, fix.z);
        stroke([p, project(fix.e, fix.n, reliefAt(fix.e, fix.n) ?? low)], colour, 1.3);
        if (p) {
          pen.globalAlpha *= fix.flying ? 1 : 0.45;
          pen.beginPath();
          const size = state.focus === index ? 1 : crowd;
          pen.arc(p.x, p.y, 7 * size, 0, 7);
          pen.fillStyle = colour;
          pen.strokeStyle = "#fff";
          pen.lineWidth = 2 * size;
          pen.fill();
          pen.stroke();
          // A vehicle that has not departed, or is down, has a name to read all the same.
          pen.globalAlpha = state.focus < 0 || state.focus === index ? 1 : 0.45;
          if (few || state.focus === index) written(vehicle.id, p, themed("--ink"), "right");
        }
      }
      pen.globalAlpha = 1;
    });
    // Obstacles after the vehicles, the nearest to a flight first, as on the map.
    for (const number of map.order) {
      const threat = scene.threats[number], zone = scene.zones[number - scene.threats.length];
      if (threat) {
        written(threat.id, project(...threat.at, top), themed("--threat"), "middle");
        continue;
      }
      const count = zone.ring.length - 1, sum = (axis) => zone.ring.slice(0, count).reduce((a, c) => a + c[axis], 0) / count;
      written(zone.name, project(sum(0), sum(1), zone.below_m === null ? top : Math.min(zone.below_m, top)), themed("--zone"), "middle");
    }
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
