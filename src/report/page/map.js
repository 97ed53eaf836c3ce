// The map: the plan view that is in the page already, with zoom, and what moves on it.

const map = (() => {
  const plan = element("plan"), figure = element("map"), moving = element("moving");
  const whole = { x: 0, y: 0, w: plan.viewBox.baseVal.width, h: plan.viewBox.baseVal.height };
  const perMetre = whole.w / (scene.bounds.east - scene.bounds.west);
  const x = (e) => (e - scene.bounds.west) * perMetre, y = (n) => (scene.bounds.north - n) * perMetre;
  let view = { ...whole };
  /** With more obstacles than this, a name that is free nowhere is not written; with fewer it stands on a path, without its heights. */
  const MAX_ON_PATHS = 30;

  plan.classList.toggle("many", scene.vehicles.length > MANY);
  plan.style.setProperty("--crowd", crowd);
  figure.style.setProperty("--tall", whole.h / whole.w);
  const now = scene.vehicles.map((_, vehicle) => {
    const group = svg("g", { class: colourOf(vehicle) }, moving);
    svg("path", { class: "now-ring", d: "M0 0h0" }, group);
    svg("path", { class: "now", d: "M0 0h0" }, group);
    return group;
  });
  const here = svg("circle", { class: "here", visibility: "hidden" }, moving);
  const bar = element("bar"), barText = element("bar-text"), furniture = element("furniture");
  const interval = element("interval"), hatch = element("hatch");
  const north = furniture.querySelectorAll(".ink-fill, .small:last-child");

  const names = [...plan.querySelectorAll("text[data-at]")].map((text) => {
    const [x, y] = text.dataset.at.split(" ").map(Number);
    return { text, at: { x, y }, side: text.dataset.side, obstacle: text.dataset.obstacle, heights: text.querySelector("tspan") };
  });
  /** Every obstacle on the map: its whole name, ring and box. Threats come first, then zones. */
  const obstacles = [...scene.threats.map((threat) => ({ id: threat.id, ring: solids.circle(threat) })), ...scene.zones].map(({ id, ring }, number) => {
    const points = ring.map(([e, n]) => [x(e), y(n)]), [xs, ys] = [0, 1].map((axis) => points.map((point) => point[axis]));
    const box = { left: Math.min(...xs), right: Math.max(...xs), top: Math.min(...ys), bottom: Math.max(...ys) };
    const written = names.find(({ obstacle }) => obstacle === String(number));
    const holds = (x, y) => x >= box.left && x <= box.right && y >= box.top && y <= box.bottom && isInside(points, x, y);
    return { name: written ? written.text.textContent : id, points, box, holds, middle: [(box.left + box.right) / 2, (box.top + box.bottom) / 2] };
  });
  for (const obstacle of obstacles) {
    obstacle.isOther = (x, y) => obstacles.some((other) => other !== obstacle && other.holds(x, y) && !other.holds(...obstacle.middle));
  }

  /** Map units in a CSS pixel. */
  const unit = () => {
    const box = figure.getBoundingClientRect();
    return box.width ? Math.max(view.w / box.width, view.h / box.height) : 1;
  };

  function show() {
    const k = unit(), box = figure.getBoundingClientRect();
    plan.setAttribute("viewBox", [view.x, view.y, view.w, view.h].join(" "));
    plan.style.setProperty("--n", k);
    hatch.setAttribute("patternTransform", "rotate(45) scale(" + k + ")");
    figure.classList.toggle("zoomed", view.w < whole.w * 0.99);
    // Scale bar and arrow stay in the corners of what is seen.
    const left = view.x + view.w / 2 - (box.width * k) / 2, bottom = view.y + view.h / 2 + (box.height * k) / 2;
    const seen = { left: Math.max(left, view.x), right: Math.min(left + box.width * k, view.x + view.w) };
    const low = Math.min(bottom, view.y + view.h), high = Math.max(bottom - box.height * k, view.y);
    const metres = roundStep((90 * k) / perMetre);
    const x0 = seen.left + 16 * k, y0 = low - 18 * k;
    bar.setAttribute("d", `M${x0} ${y0}v${5 * k}h${metres * perMetre}v${-5 * k}`);
    barText.textContent = metres >= 1000 ? metres / 1000 + " km" : metres + " m";
    barText.parentNode.setAttribute("x", x0);
    barText.parentNode.setAttribute("y", y0 - 5 * k);
    interval.style.display = box.width < 330 ? "none" : "";
    const top = { x: seen.right - 24 * k, y: high + 14 * k };
    north[0].setAttribute("d", `M${top.x} ${top.y}l${7 * k} ${20 * k}-${7 * k}-${4.5 * k}-${7 * k} ${4.5 * k}z`);
    north[1].setAttribute("x", top.x);
    north[1].setAttribute("y", top.y + 34 * k);
    here.setAttribute("r", 15 * k);
    writeNames({ left: seen.left + 4 * k, right: seen.right - 4 * k, top: high + 4 * k, bottom: low - 4 * k }, k,
      [{ left: top.x - 12 * k, right: top.x + 12 * k, top: high, bottom: top.y + 40 * k }, { left: x0, right: x0 + Math.max(metres * perMetre, 190 * k), top: y0 - 18 * k, bottom: low }]);
  }

  /** Writes the names in view: all of vehicles, and those of obstacles, the nearest to a flight first, that are free. */
  function writeNames(frame, k, taken) {
    const few = scene.vehicles.length <= MANY, lines = squares(frame, 5 * k);
    for (const vehicle of few ? scene.vehicles : []) {
      for (const [e, n] of [vehicle.start, vehicle.goal, ...vehicle.stops.map((stop) => stop.at)]) taken.push(areaAt(x(e), y(n), 14 * k, 14 * k));
      lines.add(vehicle.track.e.map((e, i) => [x(e), y(vehicle.track.n[i])]));
    }
    const place = placer(frame, taken, lines.count), whole = { left: -Infinity, right: Infinity, top: -Infinity, bottom: Infinity };
    const size = 13 * k, width = (text) => textWidth(text, 13) * k;
    for (const { text, at, side } of names.filter(({ obstacle }) => obstacle === undefined)) {
      const seen = at.x >= frame.left && at.x <= frame.right && at.y >= frame.top && at.y <= frame.bottom;
      write(text, (seen ? place : placer(whole, []))(at, side, width(text.textContent), size), size);
    }
    const outlines = squares(frame, 5 * k);
    for (const { points } of obstacles) outlines.add(points);
    const placeFree = obstaclePlacer(frame, taken, (area) => lines.some(area) || outlines.some(area));
    const placeOnPaths = obstacles.length > MAX_ON_PATHS ? () => null : obstaclePlacer(frame, taken, outlines.some);
    for (const { text, obstacle, heights } of names.filter(({ obstacle }) => obstacle !== undefined)) {
      // Without its heights where the whole name is not free.
      const of = obstacles[obstacle], forms = heights ? [of.name, text.firstChild.data] : [of.name], widths = forms.map(width);
      const free = placeFree(of, widths, size), found = free ?? placeOnPaths(of, widths.slice(-1), size);
      if (found && heights) heights.style.display = free && free.form === 0 ? "" : "none";
      write(text, found, size);
    }
  }

  /** Moves a name to where it was placed, or hides it. */
  function write(text, found, size) {
    text.setAttribute("visibility", found ? "visible" : "hidden");
    if (!found) return;
    text.setAttribute("x", found.x);
    text.setAttribute("y", found.y);
    text.style.fontSize = size * found.share + "px";
  }

  const tip = element("tip"), MAX_LINES = 8;
  // The script shows these, also where a finger taps.
  plan.querySelectorAll(":is(.threat, .zone) > title").forEach((title) => title.remove());
  /** Names every obstacle under a point of the figure, CSS pixels. */
  function point({ clientX, clientY }) {
    const box = figure.getBoundingClientRect(), k = unit(), [px, py] = [clientX - box.left, clientY - box.top];
    const at = [view.x + view.w / 2 + (px - box.width / 2) * k, view.y + view.h / 2 + (py - box.height / 2) * k];
    const under = [...new Set(obstacles.filter(({ holds }) => holds(...at)).map(({ name }) => name))];
    const more = under.length - MAX_LINES;
    tip.textContent = under.slice(0, MAX_LINES).concat(more > 0 ? [`and ${more} more`] : []).join("\n");
    tip.hidden = !under.length;
    tip.style.left = clamp(px + 12, 0, Math.max(0, box.width - tip.offsetWidth - 4)) + "px";
    tip.style.top = (py + 16 + tip.offsetHeight > box.height ? Math.max(0, py - 12 - tip.offsetHeight) : py + 16) + "px";
  }
  let moved = false;
  figure.addEventListener("pointerdown", () => { moved = false; });
  figure.addEventListener("pointermove", (event) => {
    moved ||= Math.hypot(event.movementX, event.movementY) > 2;
    if (event.buttons) tip.hidden = true; else point(event);
  });
  figure.addEventListener("click", (event) => { if (!moved && !event.target.closest("button")) point(event); });
  figure.addEventListener("pointerleave", (event) => { if (event.pointerType === "mouse") tip.hidden = true; });

  function clampView() {
    view.w = clamp(view.w, whole.w / 60, whole.w);
    view.h = (view.w * whole.h) / whole.w;
    view.x = clamp(view.x, 0, whole.w - view.w);
    view.y = clamp(view.y, 0, whole.h - view.h);
    show();
  }

  gestures(figure, {
    drag(dx, dy) {
      const k = unit();
      view.x -= dx * k;
      view.y -= dy * k;
      clampView();
    },
    zoom(factor, px, py) {
      const k = unit(), box = figure.getBoundingClientRect();
      const cx = view.x + view.w / 2 + (px - box.width / 2) * k, cy = view.y + view.h / 2 + (py - box.height / 2) * k;
      const shrink = clamp(1 / factor, whole.w / 60 / view.w, whole.w / view.w);
      view = { x: cx - (cx - view.x) * shrink, y: cy - (cy - view.y) * shrink, w: view.w * shrink, h: view.h * shrink };
      clampView();
    },
  });
  element("whole-map").addEventListener("click", () => { view = { ...whole }; show(); });
  figure.addEventListener("dblclick", () => { view = { ...whole }; show(); });
  whenResized(figure, show);

  function move() {
    scene.vehicles.forEach((vehicle, index) => {
      const fix = fixAt(vehicle.track, state.t);
      now[index].classList.toggle("chosen", state.focus === index);
      now[index].setAttribute("visibility", fix ? "visible" : "hidden");
      if (!fix) return;
      now[index].setAttribute("opacity", (fix.flying ? 1 : 0.35) * (state.focus < 0 || state.focus === index ? 1 : 0.4));
      now[index].setAttribute("transform", `translate(${x(fix.e).toFixed(2)} ${y(fix.n).toFixed(2)})`);
    });
  }

  whenChanged((what) => {
    if (what === "time" || what === "focus") move();
    if (what === "focus") {
      plan.classList.toggle("focused", state.focus >= 0);
      plan.querySelectorAll(".flight").forEach((flight) =>
        flight.classList.toggle("chosen", Number(flight.dataset.vehicle) === state.focus));
    }
    if (what === "mark") {
      here.setAttribute("visibility", state.mark ? "visible" : "hidden");
      if (!state.mark) return;
      here.setAttribute("cx", x(state.mark.e));
      here.setAttribute("cy", y(state.mark.n));
      const size = whole.w / 3;
      view = { x: x(state.mark.e) - size / 2, y: y(state.mark.n) - ((size / whole.w) * whole.h) / 2, w: size, h: 0 };
      clampView();
    }
  });
  /** Obstacles in the order in which their names are placed: numbers of `obstacles`. */
  const order = names.filter(({ obstacle }) => obstacle !== undefined).map(({ obstacle }) => Number(obstacle));
  return { show, order };
})();
