// Shapes of the three-dimensional view, as lists of numbers in planning coordinates (metres).

const solids = (() => {
  const b = scene.bounds;
  const known = scene.relief.heights_dm.filter((height) => height !== null);
  const low = known.reduce((a, h) => Math.min(a, h), known.length ? Infinity : 0) / 10;
  const high = known.reduce((a, h) => Math.max(a, h), known.length ? -Infinity : 0) / 10;
  const flown = scene.vehicles.reduce((top, vehicle) => vehicle.track.z.reduce((a, z) => Math.max(a, z), top), high);
  const span = Math.max(b.east - b.west, b.north - b.south);
  const top = flown + Math.max(60, (flown - low) * 0.18), floor = low - Math.max(30, (high - low) * 0.14);
  function relief() {
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
    return { values, indices };
  }

  /** The cut sides of the block of ground. */
  function sides(colour) {
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
    return values;
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
  function walls(threat, zone) {
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
    return values;
  }

  function rings(list) {
    const values = [];
    const onGround = (ring) => ring.map(([e, n]) => [e, n, (reliefAt(e, n) ?? low) + (high - low) * 0.002 + 0.5]);
    const join = (points) => {
      for (let i = 0; i + 1 < points.length; i++) values.push(...points[i], ...points[i + 1], -1, -1);
    };
    for (const { ring, z } of list) join(z === null ? onGround(ring) : ring.map(([e, n]) => [e, n, z]));
    return values;
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
    return { legs, points };
  }
  return { low, high, top, floor, span, relief, sides, circle, dense, walls, rings, flights };
})();
