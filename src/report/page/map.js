// The map: the plan view that is in the page already, with zoom, and what moves on it.

const map = (() => {
  const plan = element("plan"), figure = element("map"), moving = element("moving");
  const whole = { x: 0, y: 0, w: plan.viewBox.baseVal.width, h: plan.viewBox.baseVal.height };
  const perMetre = whole.w / (scene.bounds.east - scene.bounds.west);
  const x = (e) => (e - scene.bounds.west) * perMetre, y = (n) => (scene.bounds.north - n) * perMetre;
  let view = { ...whole };

  plan.classList.toggle("many", scene.vehicles.length > MANY);
  plan.style.setProperty("--crowd", crowd);
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
    return { text, at: { x, y }, side: text.dataset.side };
  });

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

  /** Writes the names in view where they have room, away from the stations and from what else is taken. */
  function writeNames(frame, k, taken) {
    const few = scene.vehicles.length <= MANY;
    for (const vehicle of few ? scene.vehicles : []) for (const [e, n] of [vehicle.start, vehicle.goal, ...vehicle.stops.map((stop) => stop.at)]) {
      taken.push({ left: x(e) - 6 * k, right: x(e) + 6 * k, top: y(n) - 6 * k, bottom: y(n) + 6 * k });
    }
    const place = placer(frame, taken, few ? pathsCovered(frame, 5 * k) : undefined);
    for (const { text, at, side } of names) {
      const seen = at.x >= frame.left && at.x <= frame.right && at.y >= frame.top && at.y <= frame.bottom;
      const whole = { left: -Infinity, right: Infinity, top: -Infinity, bottom: Infinity };
      const spot = (seen ? place : placer(whole, []))(at, side, textWidth(text.textContent, 13) * k, 13 * k);
      text.setAttribute("x", spot.x);
      text.setAttribute("y", spot.y);
      text.style.fontSize = 13 * k * spot.share + "px";
    }
  }

  /** What an area covers of the paths, which lead through squares of this side. */
  function pathsCovered(frame, side) {
    const crossed = new Set(), key = (column, row) => column * 65536 + row;
    const column = (x) => Math.floor((x - frame.left) / side), row = (y) => Math.floor((y - frame.top) / side);
    const [columns, rows] = [column(frame.right), row(frame.bottom)];
    for (const { track } of scene.vehicles) {
      for (let i = 0; i + 1 < track.e.length; i++) {
        const from = { x: x(track.e[i]), y: y(track.n[i]) }, dx = x(track.e[i + 1]) - from.x, dy = y(track.n[i + 1]) - from.y;
        const steps = clamp(Math.ceil(Math.hypot(dx, dy) / side), 1, 1000);
        for (let step = 0; step <= steps; step++) {
          const at = [column(from.x + (dx * step) / steps), row(from.y + (dy * step) / steps)];
          if (at[0] >= 0 && at[0] <= columns && at[1] >= 0 && at[1] <= rows) crossed.add(key(...at));
        }
      }
    }
    return ({ left, right, top, bottom }) => {
      let count = 0;
      for (let c = column(left); c <= column(right); c++) for (let r = row(top); r <= row(bottom); r++) count += crossed.has(key(c, r));
      return count * side * side;
    };
  }

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
  return { show };
})();
