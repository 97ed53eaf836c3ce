// Profiles over true ground, and separation over time.

/** Axes: sizes in CSS pixels, scales both ways, grid and numbers. */
function frame(host, { height, x, y, ticksX, ticksY, titleX, titleY }) {
  const width = Math.max(260, host.clientWidth || 800), left = 48, right = 12, top = 20, bottom = 38;
  const root = svg("svg", { class: "chart", viewBox: `0 0 ${width} ${height}`, height }, host);
  const at = {
    x: (v) => left + ((v - x[0]) / (x[1] - x[0])) * (width - left - right),
    y: (v) => height - bottom - ((y.map(v) - y.map(y.from)) / (y.map(y.to) - y.map(y.from))) * (height - top - bottom),
    back: (px) => x[0] + ((px - left) / (width - left - right)) * (x[1] - x[0]),
  };
  for (const [v, text] of ticksX) {
    svg("path", { class: "grid", d: `M${at.x(v)} ${height - bottom}v5` }, root);
    svg("text", { x: at.x(v), y: height - bottom + 18, "text-anchor": "middle" }, root).textContent = text;
  }
  for (const [v, text] of ticksY) {
    svg("path", { class: "grid", d: `M${left} ${at.y(v)}H${width - right}` }, root);
    svg("text", { x: left - 8, y: at.y(v) + 4, "text-anchor": "end" }, root).textContent = text;
  }
  svg("text", { x: width - right, y: height - 4, "text-anchor": "end" }, root).textContent = titleX;
  svg("text", { x: 0, y: 10 }, root).textContent = titleY;
  return { root, at, width, height, left, right, top, bottom };
}

/** Round ticks between two values, about so many, with the digits that tell them apart. */
function ticks(from, to, about) {
  const step = roundStep(Math.max(to - from, 1e-6) / about), digits = digitsFor(step), list = [];
  for (let k = Math.ceil(from / step - 1e-9); k * step <= to + step * 1e-9 && list.length < 99; k++) list.push([k * step, (k * step).toFixed(digits)]);
  return list;
}

/** Path data through points, broken where y is null. */
function pathData(points) {
  let data = "", open = false;
  for (const [px, py] of points) {
    if (py === null) { open = false; continue; }
    data += (open ? "L" : "M") + px.toFixed(1) + " " + py.toFixed(1);
    open = true;
  }
  return data;
}

/** Runs of points whose value is known. */
function runs(points) {
  const list = [[]];
  for (const point of points) {
    if (point[1] === null) { if (list[list.length - 1].length) list.push([]); } else list[list.length - 1].push(point);
  }
  return list.filter((run) => run.length > 1);
}

/** Pointing at a chart: moves the time of everything. */
function pointing(chart, act) {
  const hear = (event) => {
    const box = chart.root.getBoundingClientRect();
    act(clamp(chart.at.back(((event.clientX - box.left) / box.width) * chart.width), -Infinity, Infinity));
  };
  chart.root.addEventListener("pointerdown", (event) => { if (!event.target.dataset.row) hear(event); });
  chart.root.addEventListener("pointermove", (event) => { if (event.buttons) hear(event); });
}

const profiles = (() => {
  const host = element("profiles"), MOST = 6;
  let cards = [];

  /** Which vehicles: the chosen one, or the first few. */
  const chosen = () => (state.focus >= 0 && scene.vehicles.length > MOST ? [state.focus] : [...scene.vehicles.keys()].slice(0, MOST));

  /** The number of the fix nearest to a place, up to some fix. */
  function nearest(track, [e, n, z], last) {
    let best = [Infinity, 0];
    for (let i = 0; i <= last; i++) {
      const off = Math.hypot(track.e[i] - e, track.n[i] - n, track.z[i] - z);
      if (off < best[0]) best = [off, i];
    }
    return best[1];
  }

  /** Distances between which the clearance is asked for: the start is passed before the goal, whatever the way home passes. */
  function planned({ track, start, goal, returns }) {
    const last = track.t.length - 1, there = nearest(track, goal, last);
    return [track.d[nearest(track, start, there)], track.d[returns ? last : there]];
  }

  function card(index) {
    const vehicle = scene.vehicles[index], { track, ground } = vehicle;
    const figure = html("figure", "profile");
    const caption = html("figcaption");
    caption.append(html("i", "swatch " + colourOf(index)), html("strong", "", vehicle.id));
    const reading = html("span", "reading");
    caption.append(reading);
    figure.append(caption, tightest(index));
    host.append(figure);
    if (track.t.length < 2) {
      reading.textContent = "no motion that could be judged";
      return null;
    }
    const length = Math.max(track.d[track.d.length - 1], 1);
    const soil = ground.amsl_m.map((z, i) => [Math.min(i * ground.step_m, length), z]);
    const all = soil.map(([, z]) => z).filter((z) => z !== null).concat(track.z);
    const least = all.reduce((a, z) => Math.min(a, z), Infinity), most = all.reduce((a, z) => Math.max(a, z), -Infinity);
    const pad = Math.max(20, (most - least) * 0.12), narrow = host.clientWidth < 500;
    const chart = frame(figure, {
      height: narrow ? 210 : 240, x: [0, length], y: { from: least - pad, to: most + pad, map: (v) => v },
      ticksX: ticks(0, length / 1000, narrow ? 4 : 9).map(([v, text]) => [v * 1000, text]),
      ticksY: ticks(least - pad, most + pad, 4),
      titleX: "km along the track", titleY: "m AMSL",
    });
    const { root, at } = chart, base = chart.height - chart.bottom;
    const [from, to] = planned(vehicle);
    const banded = to > from ? soil.filter(([d]) => d >= from && d <= to) : soil;
    for (const run of runs(banded)) {
      const upper = run.map(([d, z]) => [at.x(d), at.y(z + scene.min_agl_m)]), lower = run.map(([d, z]) => [at.x(d), at.y(z)]).reverse();
      svg("path", { class: "band", d: pathData(upper) + pathData(lower).replace("M", "L") + "z" }, root);
    }
    for (const run of runs(soil)) {
      const line = run.map(([d, z]) => [at.x(d), at.y(z)]);
      svg("path", { class: "soil", d: `M${line[0][0]} ${base}` + pathData(line).replace("M", "L") + `V${base}z` }, root);
    }
    svg("path", { class: "line " + colourOf(index), d: pathData(track.d.map((d, i) => [at.x(d), at.y(track.z[i])])) }, root);
    // Item numbers, as many as fit, where the vehicle reaches them.
    let last = -Infinity;
    track.item.forEach((item, i) => {
      if (item === track.item[i + 1] || item === 0) return;
      const px = at.x(track.d[i]);
      svg("path", { class: "tick " + colourOf(index), d: `M${px.toFixed(1)} ${(at.y(track.z[i]) - 4).toFixed(1)}v8` }, root);
      if (px - last < 24) return;
      last = px;
      svg("text", { x: px.toFixed(1), y: (at.y(track.z[i]) - 9).toFixed(1), "text-anchor": "middle" }, root).textContent = item;
    });
    data.margins.forEach((margin, row) => {
      if (!margin.at || !margin.vehicles.includes(index) || margin.vehicles[0] !== index) return;
      if (margin.ok && !margin.is_clearance) return;
      const d = fixAt(track, margin.at[3]).d;
      const mark = svg("circle", { class: "worst" + (margin.ok ? "" : " bad"), cx: at.x(d), cy: at.y(margin.at[2]), r: 5.5, "data-row": row }, root);
      svg("title", {}, mark).textContent = margin.what;
    });
    const cursor = svg("path", { class: "cursor" }, root), dot = svg("circle", { class: "dot " + colourOf(index), r: 5.5 }, root);
    pointing(chart, (d) => setTime(fixAt(track, clamp(d, 0, length), "d").t));
    return () => {
      const fix = fixAt(track, state.t), under = groundUnder(vehicle, fix.d);
      cursor.setAttribute("d", `M${at.x(fix.d).toFixed(1)} ${chart.top}V${base}`);
      dot.setAttribute("cx", at.x(fix.d));
      dot.setAttribute("cy", at.y(fix.z));
      const agl = under === null ? "no ground data" : (fix.z - under).toFixed(0) + " m above ground";
      reading.textContent = `${agl} · ${fix.z.toFixed(0)} m AMSL · item ${fix.item}` + (fix.flying ? "" : state.t < fix.t ? " · not yet departed" : " · finished");
    };
  }

  function build() {
    host.replaceChildren();
    const key = html("p", "key");
    for (const [style, text] of [["background:var(--soil)", "true ground"], ["background:color-mix(in srgb, var(--band) 30%, transparent)", `closer than ${scene.min_agl_m} m to the ground`]]) {
      const entry = html("span");
      const patch = html("i");
      patch.style.cssText = style;
      entry.append(patch, text);
      key.append(entry);
    }
    host.append(key);
    const shown = chosen();
    cards = shown.map(card).filter(Boolean);
    if (scene.vehicles.length > shown.length) host.append(html("p", "note", "Choose a vehicle above or in the fleet to see its profile."));
    cards.forEach((move) => move());
  }

  whenWidened(host, build);
  whenChanged((what) => {
    if (what === "time") cards.forEach((move) => move());
    if (what === "focus" && scene.vehicles.length > MOST) build();
  });
  return { build };
})();

const separation = (() => {
  const host = element("separation"), section = element("separation-section"), MOST = 8, SAMPLES = 500;
  const { distance_m: limit, vertical_m: vertical, slack_s: slack } = scene.separation;
  let move = () => {};

  /** With a vertical limit, height counts in proportion: a conflict is still below `limit`. */
  const apart = (p, q) => {
    const flat = Math.hypot(p.e - q.e, p.n - q.n), rise = Math.abs(p.z - q.z);
    return vertical === null || limit === null ? Math.hypot(flat, rise) : Math.max(flat, (rise * limit) / vertical);
  };

  /** The pairs to show: those with the worst margins, or all of a small fleet. */
  function pairs() {
    const list = [], add = (a, b) => {
      if (!list.some(([c, d]) => (c === a && d === b) || (c === b && d === a))) list.push([a, b]);
    };
    for (const { vehicles } of data.margins) if (vehicles.length === 2) add(...vehicles);
    if (scene.vehicles.length <= 5) scene.vehicles.forEach((_, a) => scene.vehicles.slice(a + 1).forEach((_, i) => add(a, a + 1 + i)));
    const shown = state.focus < 0 || scene.vehicles.length <= 5 ? list : list.filter((pair) => pair.includes(state.focus));
    return shown.slice(0, MOST);
  }

  /** Distance over time while both fly: as planned, and at the worst shift allowed. */
  function series([a, b]) {
    const [A, B] = [scene.vehicles[a].track, scene.vehicles[b].track];
    if (A.t.length < 2 || B.t.length < 2) return [];
    const from = Math.max(A.t[0], B.t[0] - slack), to = Math.min(A.t[A.t.length - 1], B.t[B.t.length - 1] + slack), list = [];
    for (let i = 0; i <= SAMPLES && to > from; i++) {
      const t = from + ((to - from) * i) / SAMPLES, p = fixAt(A, t), straight = fixAt(B, t);
      let worst = Infinity;
      for (let k = -8; k <= 8; k++) {
        const q = fixAt(B, t + (slack * k) / 8);
        if (q.flying) worst = Math.min(worst, apart(p, q));
      }
      list.push([t, straight.flying ? apart(p, straight) : null, worst < Infinity ? worst : null]);
    }
    return list;
  }

  function build() {
    host.replaceChildren();
    move = () => {};
    const shown = pairs().map((pair) => ({ pair, list: series(pair) })).filter(({ list }) => list.length);
    section.hidden = scene.vehicles.length < 2;
    if (!shown.length) {
      host.append(html("p", "note", "No two vehicles are known to fly at the same time."));
      return;
    }
    const key = html("p", "key");
    const readings = shown.map(({ pair: [a, b] }) => {
      const entry = html("span", "pair");
      entry.append(html("i", colourOf(a)), html("i", colourOf(b)), `${scene.vehicles[a].id} – ${scene.vehicles[b].id} `);
      const reading = html("span", "reading");
      entry.append(reading);
      key.append(entry);
      return reading;
    });
    // Every other pair is a dot at its closest.
    const others = data.approaches.filter(({ vehicles, t_s, value }) => t_s !== null && value > 0
      && (state.focus < 0 || vehicles.includes(state.focus))
      && !shown.some(({ pair }) => vehicles.every((v) => pair.includes(v))));
    if (others.length) key.append(html("span", "", `• closest approach of ${others.length === 1 ? "another pair" : others.length + " other pairs"}`));
    const values = shown.flatMap(({ list }) => list.flatMap(([, d, w]) => [d, w])).filter((d) => d !== null).concat(others.map(({ value }) => value));
    const least = Math.max(1, Math.min(1e9, limit === null ? 1e9 : limit * 0.5, values.reduce((a, d) => Math.min(a, d), Infinity) * 0.8));
    const most = Math.min(1e12, Math.max(limit === null ? 4 : limit * 4, values.reduce((a, d) => Math.max(a, d), 0) * 1.15));
    host.append(key);
    const marks = [];
    for (let decade = 1; decade <= most; decade *= 10) for (const k of [1, 2, 5]) if (k * decade >= least && k * decade <= most) marks.push([k * decade, k * decade >= 1000 ? (k * decade) / 1000 + " km" : k * decade + " m"]);
    const narrow = host.clientWidth < 500;
    const chart = frame(host, {
      height: narrow ? 260 : 300, x: [state.first, state.last], y: { from: least, to: most, map: Math.log10 },
      ticksX: ticks(state.first / 60, state.last / 60, narrow ? 5 : 10).map(([v, text]) => [v * 60, text]),
      ticksY: marks, titleX: "minutes after T0", titleY: vertical === null || limit === null ? "distance (log)" : `distance (log), height × ${(limit / vertical).toFixed(1)}`,
    });
    const { root, at } = chart, y = (d) => (d === null ? null : at.y(Math.max(d, least))), base = chart.height - chart.bottom;
    if (limit !== null) svg("rect", { class: "beyond", x: chart.left, y: at.y(limit), width: chart.width - chart.left - chart.right, height: Math.max(0, base - at.y(limit)) }, root);
    for (const { pair: [a, b], list } of shown) {
      for (const run of runs(list.map(([t, d, w]) => [t, d === null ? null : w, d]))) {
        const upper = run.map(([t, , d]) => [at.x(t), y(d)]), lower = run.map(([t, w]) => [at.x(t), y(w)]).reverse();
        svg("path", { class: "shift " + colourOf(a), d: pathData(upper) + pathData(lower).replace("M", "L") + "z" }, root);
      }
      const d = pathData(list.map(([t, value]) => [at.x(t), y(value)]));
      svg("path", { class: "line " + colourOf(a), d }, root);
      svg("path", { class: "line " + colourOf(b), d, "stroke-dasharray": "7 7" }, root);
    }
    if (limit !== null) {
      svg("path", { class: "limit", d: `M${chart.left} ${at.y(limit)}H${chart.width - chart.right}` }, root);
      svg("text", { class: "limit-text", x: chart.left + 6, y: at.y(limit) + 15 }, root).textContent = `limit ${lengthText(limit)}`;
    }
    for (const { vehicles: [a, b], t_s, value, ok } of others) {
      const dot = svg("circle", { class: "approach" + (ok ? "" : " bad"), cx: at.x(t_s), cy: y(value), r: ok ? 3.5 : 4.5 }, root);
      svg("title", {}, dot).textContent = `${scene.vehicles[a].id} – ${scene.vehicles[b].id} ${lengthText(value)}`;
      dot.addEventListener("pointerdown", (event) => {
        event.stopPropagation();
        setTime(t_s);
        const fix = fixAt(scene.vehicles[a].track, t_s);
        if (!fix) return;
        state.mark = { e: fix.e, n: fix.n, z: fix.z };
        changed("mark");
      });
    }
    data.margins.forEach((margin, row) => {
      if (!margin.at || margin.vehicles.length !== 2 || margin.value === null) return;
      if (!shown.some(({ pair }) => margin.vehicles.every((v) => pair.includes(v)))) return;
      const mark = svg("circle", { class: "worst" + (margin.ok ? "" : " bad"), cx: at.x(margin.at[3]), cy: y(margin.value), r: 5.5, "data-row": row }, root);
      svg("title", {}, mark).textContent = margin.what;
    });
    const cursor = svg("path", { class: "cursor" }, root);
    pointing(chart, setTime);
    move = () => {
      cursor.setAttribute("d", `M${at.x(state.t).toFixed(1)} ${chart.top}V${base}`);
      shown.forEach(({ pair: [a, b] }, i) => {
        const p = fixAt(scene.vehicles[a].track, state.t), q = fixAt(scene.vehicles[b].track, state.t);
        readings[i].textContent = p.flying && q.flying ? lengthText(apart(p, q)) : "not both in the air";
      });
    };
    move();
  }

  section.hidden = scene.vehicles.length < 2;
  whenWidened(host, build);
  whenChanged((what) => {
    if (what === "time") move();
    if (what === "focus" && scene.vehicles.length > 5) build();
  });
  return { build };
})();

// How far what was flown was from its plan, on the page of a flight.
const errorsChart = (() => {
  const host = element("errors"), section = element("errors-section"), MOST = 6;
  const flown = scene.vehicles.map((vehicle, index) => ({ index, id: vehicle.id, errors: vehicle.flown ? vehicle.flown.errors : [] })).filter(({ errors }) => errors.length > 1);
  let move = () => {};

  /** The vehicles to show: the chosen one, or the first few. */
  const chosen = () => (state.focus >= 0 ? flown.filter(({ index }) => index === state.focus) : flown.slice(0, MOST));

  function build() {
    host.replaceChildren();
    move = () => {};
    const shown = chosen();
    if (!shown.length) {
      host.append(html("p", "note", "This vehicle has no recorded flight."));
      return;
    }
    const key = html("p", "key");
    const readings = shown.map(({ index, id }) => {
      const entry = html("span", "pair");
      entry.append(html("i", colourOf(index)), id + " ");
      const reading = html("span", "reading");
      entry.append(reading);
      key.append(entry);
      return reading;
    });
    key.append(html("span", "", "full line: cross-track error; dashed: height over the planned path, negative below"));
    host.append(key);
    const values = shown.flatMap(({ errors }) => errors.flatMap(([, aside, above]) => [aside, above]));
    const pad = 0.5, least = values.reduce((a, v) => Math.min(a, v), 0) - pad, most = values.reduce((a, v) => Math.max(a, v), 2) + pad;
    const narrow = host.clientWidth < 500;
    const chart = frame(host, {
      height: narrow ? 210 : 240, x: [state.first, state.last], y: { from: least, to: most, map: (v) => v },
      ticksX: ticks(state.first / 60, state.last / 60, narrow ? 5 : 10).map(([v, text]) => [v * 60, text]),
      ticksY: ticks(least, most, 4), titleX: "minutes after T0", titleY: "metres off the plan",
    });
    const { root, at } = chart, base = chart.height - chart.bottom;
    for (const { index, errors } of shown) {
      svg("path", { class: "line " + colourOf(index), d: pathData(errors.map(([t, aside]) => [at.x(t), at.y(aside)])) }, root);
      svg("path", { class: "line " + colourOf(index), d: pathData(errors.map(([t, , above]) => [at.x(t), at.y(above)])), "stroke-dasharray": "5 5" }, root);
    }
    const cursor = svg("path", { class: "cursor" }, root);
    pointing(chart, setTime);
    move = () => {
      cursor.setAttribute("d", `M${at.x(state.t).toFixed(1)} ${chart.top}V${base}`);
      shown.forEach(({ errors }, i) => {
        const after = errors.findIndex(([t]) => t >= state.t), now = errors[after];
        readings[i].textContent = now && after > 0 ? `${now[1].toFixed(1)} m across, ${now[2].toFixed(1)} m above` : "–";
      });
    };
    move();
  }

  section.hidden = !flown.length;
  if (!flown.length) return { build };
  whenWidened(host, build);
  whenChanged((what) => {
    if (what === "time") move();
    if (what === "focus") build();
  });
  return { build };
})();
