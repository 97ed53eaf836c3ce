// The tightest limits of each vehicle, from the table of margins.

const tightest = (() => {
  const COUNT = 3, rows = [...element("margins").tBodies[0].rows];

  /** The other vehicle of a separation, as words behind its name. */
  const from = (vehicles, vehicle) => vehicles.filter((other) => other !== vehicle).map((other) => " from " + scene.vehicles[other].id).join("");

  /** A button with a limit: its worst value, what is allowed, and when; it leads there. */
  function button(row, vehicle) {
    const { what, vehicles, ok, at } = data.margins[row], cells = rows[row].cells;
    const made = html("button", ok ? "" : "bad");
    made.type = "button";
    made.dataset.row = row;
    if (at) made.title = cells[8].textContent;
    made.append(html("span", "what", what + from(vehicles, vehicle)), html("strong", "", cells[3].textContent),
      html("span", "when", at ? `${cells[6].textContent} · item ${cells[7].textContent}` : ""), html("span", "allowed", cells[4].textContent));
    return made;
  }

  /** A list of a vehicle's tightest limits: the table has broken ones first, then the tightest. */
  return (vehicle) => {
    const list = html("ul", "tightest");
    const own = [...data.margins.keys()].filter((row) => data.margins[row].vehicles.includes(vehicle));
    for (const row of own.slice(0, COUNT)) {
      const entry = html("li");
      entry.append(button(row, vehicle));
      list.append(entry);
    }
    return list;
  };
})();
