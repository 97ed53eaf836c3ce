// What all views share: the facts, the time, the chosen vehicle, and who wants to know.

const errors = [];
window.addEventListener("error", (event) => {
  errors.push(String(event.message));
  document.documentElement.dataset.errors = String(errors.length);
  document.documentElement.dataset.error = errors[0];
});

const element = (id) => document.getElementById(id);
const data = JSON.parse(element("data").textContent);
const scene = data.scene;
// The name of SVG's namespace, from the map, so that no address stands in this page.
const SVG = element("plan").namespaceURI;

/** An SVG element with attributes. */
function svg(name, attributes = {}, parent = null) {
  const made = document.createElementNS(SVG, name);
  for (const key in attributes) made.setAttribute(key, attributes[key]);
  if (parent) parent.append(made);
  return made;
}

/** An HTML element with a class and text. */
function html(name, className = "", text = "") {
  const made = document.createElement(name);
  if (className) made.className = className;
  made.textContent = text;
  return made;
}

const clamp = (value, least, most) => Math.min(Math.max(value, least), most);
/** More vehicles than this are drawn without names, waypoints and curtains, but for a chosen one. */
const MANY = 40;
/** From 1 for a few vehicles down to a third: how much smaller and fainter many are drawn. */
const crowd = clamp(Math.sqrt(30 / scene.vehicles.length), 0.33, 1);
const colourOf = (vehicle) => "v" + (vehicle % data.colours.length);

/** The value of a colour of the style sheet, as light or dark has it. */
const themed = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

/** Seconds as minutes and seconds, or with hours. */
function clockText(seconds) {
  const whole = Math.round(Math.abs(seconds));
  const two = (value) => String(value).padStart(2, "0");
  const sign = seconds < 0 && whole > 0 ? "−" : "";
  const hours = Math.floor(whole / 3600), minutes = Math.floor(whole / 60) % 60;
  return sign + (hours ? hours + ":" + two(minutes) : minutes) + ":" + two(whole % 60);
}

/** Calls back now, and in the frame after an element has got another size: it may change sizes itself. */
function whenResized(watched, act) {
  act();
  new ResizeObserver(() => requestAnimationFrame(act)).observe(watched);
}

/** Builds now, and again after an element has got another width. */
function whenWidened(host, build) {
  let width = -1;
  whenResized(host, () => {
    if (host.clientWidth === width) return;
    width = host.clientWidth;
    build();
  });
}

/** The next of 1, 2, 5, 10, ... at or above. */
function roundStep(least) {
  const decade = 10 ** Math.floor(Math.log10(least));
  return [1, 2, 5, 10].map((step) => step * decade).find((step) => step >= least * 0.999999);
}

/** Digits behind the point that multiples of a round step need. */
const digitsFor = (step) => clamp(Math.ceil(-Math.log10(step) - 1e-6), 0, 9);

/** Metres with a unit that fits. */
function lengthText(metres, digits = 1) {
  return metres >= 2000 ? (metres / 1000).toFixed(digits) + " km" : metres.toFixed(metres < 10 ? 1 : 0) + " m";
}

// Distances along each track, for the profiles.
for (const vehicle of scene.vehicles) {
  const track = vehicle.track;
  track.d = [0];
  for (let at = 1; at < track.t.length; at++) {
    track.d.push(track.d[at - 1] + Math.hypot(track.e[at] - track.e[at - 1], track.n[at] - track.n[at - 1]));
  }
}

/** The number of the fix at or after a value in a growing list. */
function indexAfter(list, value) {
  let low = 0, high = list.length - 1;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (list[middle] < value) low = middle + 1; else high = middle;
  }
  return low;
}

/** Where a track is at a time, or (by "d") at a distance; before and after, at its ends. */
function fixAt(track, value, by = "t") {
  const list = track[by];
  if (!list.length) return null;
  const after = Math.max(indexAfter(list, value), Math.min(1, list.length - 1)), before = Math.max(after - 1, 0);
  const span = list[after] - list[before];
  const share = span > 0 ? clamp((value - list[before]) / span, 0, 1) : 0;
  const mix = (column) => track[column][before] + (track[column][after] - track[column][before]) * share;
  return {
    e: mix("e"), n: mix("n"), z: mix("z"), t: mix("t"), d: mix("d"), item: track.item[after],
    flying: by === "d" || (value >= list[0] && value <= list[list.length - 1]),
  };
}

/** Ground under a track at a distance along it, or null without data. */
function groundUnder(vehicle, d) {
  const { step_m: step, amsl_m: heights } = vehicle.ground;
  if (!heights.length) return null;
  const at = clamp(Math.floor(d / step), 0, heights.length - 1), next = Math.min(at + 1, heights.length - 1);
  const from = at * step, to = Math.min(next * step, vehicle.track.d[vehicle.track.d.length - 1]);
  if (heights[at] === null || heights[next] === null) return null;
  const share = to > from ? clamp((d - from) / (to - from), 0, 1) : 0;
  return heights[at] + (heights[next] - heights[at]) * share;
}

/** Height of the drawn relief, or null outside and in voids. */
function reliefAt(e, n) {
  const { columns, rows, heights_dm: heights } = scene.relief, b = scene.bounds;
  const x = ((e - b.west) / (b.east - b.west)) * (columns - 1), y = ((n - b.south) / (b.north - b.south)) * (rows - 1);
  if (!(x >= 0 && y >= 0 && x <= columns - 1 && y <= rows - 1)) return null;
  const column = Math.min(Math.floor(x), columns - 2), row = Math.min(Math.floor(y), rows - 2);
  const node = (right, up) => heights[(row + up) * columns + column + right];
  const corners = [node(0, 0), node(1, 0), node(0, 1), node(1, 1)];
  if (corners.includes(null)) return null;
  const fx = x - column, fy = y - row;
  const south = corners[0] + (corners[1] - corners[0]) * fx, north = corners[2] + (corners[3] - corners[2]) * fx;
  return (south + (north - south) * fy) / 10;
}

const times = scene.vehicles.flatMap(({ track }) => (track.t.length ? [track.t[0], track.t[track.t.length - 1]] : []));
const state = {
  first: Math.min(0, ...times), last: Math.max(1, ...times),
  t: 0, focus: -1, mark: null,
  listeners: [],
};

/** Calls back after every change; `what` is "time", "focus", "mark" or "theme". */
const whenChanged = (listener) => state.listeners.push(listener);
const changed = (what) => state.listeners.forEach((listener) => listener(what));

function setTime(t) {
  state.t = clamp(t, state.first, state.last);
  changed("time");
}

function setFocus(vehicle) {
  state.focus = vehicle;
  changed("focus");
}

matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => changed("theme"));

/**
 * Dragging, pinching and the wheel on a view. `act.drag(dx, dy, second)`: `second` is true with
 * shift, another button or two fingers; `act.zoom(factor, x, y)` about a place of the view.
 * The wheel zooms only a view that was clicked before, so that the page scrolls past it.
 */
function gestures(view, act) {
  const fingers = new Map();
  let awake = false;
  const spread = () => {
    const [a, b] = [...fingers.values()];
    return { x: (a.x + b.x) / 2, y: (a.y + b.y) / 2, gap: Math.hypot(a.x - b.x, a.y - b.y) };
  };
  const local = (event) => {
    const box = view.getBoundingClientRect();
    return { x: event.clientX - box.left, y: event.clientY - box.top };
  };
  view.addEventListener("pointerdown", (event) => {
    if (event.target.closest("button")) return;
    awake = true;
    fingers.set(event.pointerId, local(event));
    view.setPointerCapture(event.pointerId);
    view.classList.add("dragging");
  });
  view.addEventListener("pointermove", (event) => {
    if (!fingers.has(event.pointerId)) return;
    const before = fingers.get(event.pointerId), now = local(event);
    if (fingers.size === 2) {
      const was = spread();
      fingers.set(event.pointerId, now);
      const is = spread();
      act.drag(is.x - was.x, is.y - was.y, true);
      if (was.gap > 0) act.zoom(is.gap / was.gap, is.x, is.y);
    } else {
      fingers.set(event.pointerId, now);
      act.drag(now.x - before.x, now.y - before.y, event.shiftKey || event.buttons > 1);
    }
  });
  const release = (event) => {
    fingers.delete(event.pointerId);
    if (!fingers.size) view.classList.remove("dragging");
  };
  view.addEventListener("pointerup", release);
  view.addEventListener("pointercancel", release);
  view.addEventListener("contextmenu", (event) => event.preventDefault());
  view.addEventListener("pointerleave", () => { if (!fingers.size) awake = false; });
  view.addEventListener("wheel", (event) => {
    if (!awake && !event.ctrlKey) return;
    event.preventDefault();
    const { x, y } = local(event);
    act.zoom(Math.exp(-clamp(event.deltaY, -200, 200) * 0.002), x, y);
  }, { passive: false });
}
