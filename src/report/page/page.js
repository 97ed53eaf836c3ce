// The clock, the tables, and what clicking does.

const views = document.querySelector(".views");

function showView(name) {
  views.dataset.view = name;
  element("switch").querySelectorAll("button").forEach((button) => button.setAttribute("aria-pressed", String(button.dataset.view === name)));
}
element("switch").addEventListener("click", (event) => {
  const button = event.target.closest("button");
  if (button) showView(button.dataset.view);
});

// Time.
const clock = element("clock"), slider = element("time"), play = element("play"), speed = element("speed");
let playing = false, before = 0;
for (const factor of [1, 5, 10, 30, 60, 120]) {
  const option = html("option", "", factor + " ×");
  option.value = factor;
  speed.append(option);
}
speed.value = [1, 5, 10, 30, 60, 120].find((factor) => (state.last - state.first) / factor < 60) || 120;
slider.min = state.first;
slider.max = state.last;
element("end").textContent = clockText(state.last);
element("transport").hidden = times.length === 0;

function setPlaying(on) {
  playing = on;
  play.textContent = on ? "❚❚" : "▶";
  play.setAttribute("aria-label", on ? "Pause" : "Play");
  if (!on) return;
  if (state.t >= state.last) setTime(state.first);
  before = 0;
  requestAnimationFrame(tick);
}

function tick(now) {
  if (!playing) return;
  if (before) setTime(state.t + ((now - before) / 1000) * Number(speed.value));
  before = now;
  if (state.t >= state.last) setPlaying(false); else requestAnimationFrame(tick);
}
play.addEventListener("click", () => setPlaying(!playing));
slider.addEventListener("input", () => { setPlaying(false); setTime(Number(slider.value)); });
document.addEventListener("keydown", (event) => {
  if (event.key === " " && event.target === document.body) {
    event.preventDefault();
    setPlaying(!playing);
  }
});

// One vehicle alone.
const chips = [...element("legend").querySelectorAll(".chip")], fleetRows = [...document.querySelectorAll("#fleet tbody tr")];
const toggle = (vehicle) => setFocus(state.focus === vehicle ? -1 : vehicle);
chips.forEach((chip) => chip.addEventListener("click", () => toggle(Number(chip.dataset.vehicle))));
fleetRows.forEach((row) => row.addEventListener("click", () => toggle(Number(row.dataset.vehicle))));

whenChanged((what) => {
  if (what === "time") {
    clock.textContent = clockText(state.t);
    slider.value = state.t;
  }
  if (what === "focus") {
    chips.forEach((chip) => chip.setAttribute("aria-pressed", String(Number(chip.dataset.vehicle) === state.focus)));
    fleetRows.forEach((row) => row.classList.toggle("chosen", Number(row.dataset.vehicle) === state.focus));
  }
});

// Margins: sorting, and jumping to where they are worst.
const table = element("margins"), body = table.tBodies[0], rows = [...body.rows];

function jump(number, scroll = true) {
  const margin = data.margins[number];
  rows.forEach((row) => row.classList.toggle("chosen", Number(row.dataset.row) === number));
  setPlaying(false);
  if (margin.vehicles.length === 1) setFocus(margin.vehicles[0]); else setFocus(-1);
  if (!margin.at) return;
  const [e, n, z, t] = margin.at;
  setTime(t);
  state.mark = { e, n, z };
  changed("mark");
  if (scroll) element("view-bar").scrollIntoView({ block: "start" });
}

document.addEventListener("click", (event) => {
  const leads = event.target.closest("[data-row]");
  if (leads) jump(Number(leads.dataset.row), !leads.closest(".chart"));
});
for (const host of [body, document.querySelector("#fleet tbody")]) {
  host.addEventListener("keydown", (event) => {
    if (event.key === "Enter" && event.target.tagName === "TR") event.target.click();
  });
}

const heads = [...table.tHead.rows[0].cells];
heads.forEach((head, column) => head.firstElementChild.addEventListener("click", () => {
  const down = head.getAttribute("aria-sort") === "ascending";
  heads.forEach((other) => other.removeAttribute("aria-sort"));
  head.setAttribute("aria-sort", down ? "descending" : "ascending");
  const numeric = head.dataset.by === "number";
  const key = (row) => (numeric ? Number(row.cells[column].dataset.sort) : row.cells[column].textContent);
  const order = (a, b) => (numeric ? key(a) - key(b) : key(a).localeCompare(key(b), "en", { numeric: true })) || a.dataset.row - b.dataset.row;
  rows.sort((a, b) => (down ? order(b, a) : order(a, b)));
  body.append(...rows);
}));
element("broken-only").addEventListener("change", (event) => table.classList.toggle("broken-only", event.target.checked));
element("broken-only").parentNode.hidden = !rows.some((row) => row.classList.contains("bad"));

// #t=120, #row=3, #view=scene: a link to a moment.
function follow() {
  const wish = new URLSearchParams(location.hash.slice(1));
  if (wish.has("view")) showView(wish.get("view") === "scene" ? "scene" : "map");
  if (wish.has("row") && data.margins[Number(wish.get("row"))]) jump(Number(wish.get("row")), false);
  if (wish.has("t") && Number.isFinite(Number(wish.get("t")))) setTime(Number(wish.get("t")));
}
addEventListener("hashchange", follow);

setTime(Math.max(0, state.first));
follow();
document.documentElement.dataset.ready = scene3d.ready ? "3d" : "2d";
