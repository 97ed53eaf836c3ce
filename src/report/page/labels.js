// Names on the views: where each is written, and which have no space.

/** Width of a text in CSS pixels, in the font of names. */
const textWidth = (() => {
  const pen = document.createElement("canvas").getContext("2d"), known = new Map();
  return (text, size) => {
    pen.font = `600 100px ${getComputedStyle(document.body).fontFamily}`;
    if (!known.has(text)) known.set(text, pen.measureText(text).width / 100);
    return known.get(text) * size;
  };
})();

/** The area that two have in common. */
const shared = (a, b) => Math.max(0, Math.min(a.right, b.right) - Math.max(a.left, b.left)) * Math.max(0, Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top));

/** An area of some width and height about a point. */
const areaAt = (x, y, w, h) => ({ left: x - w / 2, top: y - h / 2, right: x + w / 2, bottom: y + h / 2 });

/** An area with as much on its left and on its right. */
const widened = (area, by) => ({ ...area, left: area.left - by, right: area.right + by });

/** Whether a point is inside of a ring. */
function isInside(ring, x, y) {
  let inside = false;
  for (let i = 1; i < ring.length; i++) {
    const [[ax, ay], [bx, by]] = [ring[i - 1], ring[i]];
    if (ay > y !== by > y && x < ax + ((y - ay) / (by - ay)) * (bx - ax)) inside = !inside;
  }
  return inside;
}

/** Ways to write a name about its place: the side of the text, and the offset in its height. */
const WAYS = (() => {
  const left = [-1, -0.85, 0], right = [1, 0.85, 0], about = [[0, 0, 1.3], [0, 0, -1.3]], far = [[0, 0, 2.5], [0, 0, -2.5]];
  return { middle: [[0, 0, 0], ...about, right, left, ...far], left: [left, right, ...about, ...far], right: [right, left, ...about, ...far] };
})();

/**
 * Places names in a frame one after the other, each in the first way that is free, in small
 * letters if need be; where none is, in the one that covers least, or (`onlyFree`) nowhere.
 * `taken` are areas to leave free ({ left, top, right, bottom }); it grows. Returns a function of
 * the place, the side, the width and the height of a name, to its middle and the share of its size.
 */
function placer(frame, taken, crossed = () => 0) {
  const inside = (value, from, to, length) => Math.max(Math.min(value, to - length / 2), from + length / 2);
  return (at, side, width, height, onlyFree = false) => {
    let best = null;
    for (const share of [1, 0.8]) {
      const [w, h] = [width * share, height * 1.2 * share];
      for (const [aside, dx, dy] of WAYS[side]) {
        const x = inside(at.x + dx * height + (aside * w) / 2, frame.left, frame.right, w), y = inside(at.y + dy * height, frame.top, frame.bottom, h);
        const area = areaAt(x, y, w, h);
        const covers = taken.reduce((sum, other) => sum + shared(area, other), crossed(area));
        if (!best || covers < best.covers) best = { x, y, share, covers, area };
        if (covers === 0) break;
      }
      if (best.covers === 0) break;
    }
    if (onlyFree && best.covers > 0) return null;
    taken.push(onlyFree ? widened(best.area, height * 0.4) : best.area);
    return best;
  };
}

/**
 * Squares of a frame that lines lead through, for names to stay off them: `add` draws a line
 * from point to point, `count` and `some` ask about an area.
 */
function squares(frame, side) {
  const crossed = new Set(), key = (column, row) => column * 65536 + row;
  const column = (x) => Math.floor((x - frame.left) / side), row = (y) => Math.floor((y - frame.top) / side);
  const [columns, rows] = [column(frame.right), row(frame.bottom)];
  const isFar = (a, b, from, to) => Math.max(a, b) < from || Math.min(a, b) > to;
  return {
    add(points) {
      for (let i = 0; i + 1 < points.length; i++) {
        const [[ax, ay], [bx, by]] = [points[i], points[i + 1]];
        if (isFar(ax, bx, frame.left, frame.right) || isFar(ay, by, frame.top, frame.bottom)) continue;
        const steps = clamp(Math.ceil(Math.hypot(bx - ax, by - ay) / side), 1, 1000);
        for (let step = 0; step <= steps; step++) {
          const [c, r] = [column(ax + ((bx - ax) * step) / steps), row(ay + ((by - ay) * step) / steps)];
          if (c >= 0 && c <= columns && r >= 0 && r <= rows) crossed.add(key(c, r));
        }
      }
    },
    count({ left, right, top, bottom }) {
      let count = 0;
      for (let c = column(left); c <= column(right); c++) for (let r = row(top); r <= row(bottom); r++) count += crossed.has(key(c, r));
      return count * side * side;
    },
    some({ left, right, top, bottom }) {
      for (let c = column(left); c <= column(right); c++) for (let r = row(top); r <= row(bottom); r++) if (crossed.has(key(c, r))) return true;
      return false;
    },
  };
}

/** Middles of a name inside of the box of an obstacle, and outside of it, the nearer first. */
function aroundBox({ left, right, top, bottom }, w, h, gap) {
  const x = (left + right) / 2, y = (top + bottom) / 2;
  // A disc leaves the corners of its box free.
  const cutX = (right - left) * 0.146, cutY = (bottom - top) * 0.146;
  const outside = [gap, gap + h].flatMap((off) => {
    const above = top - off - h / 2, below = bottom + off + h / 2, before = left - off - w / 2, after = right + off + w / 2;
    const corners = [above + cutY, below - cutY].flatMap((cy) => [[after - cutX, cy], [before + cutX, cy]]);
    const edges = [above, below].flatMap((cy) => [[left + w / 2, cy], [right - w / 2, cy]]);
    return [[x, above], [x, below], [after, y], [before, y], ...corners, ...edges];
  });
  return { inside: [0, 1.1, -1.1].map((dy) => [x, y + dy * h]), outside };
}

/**
 * Places names of obstacles, each only where it is free: in the frame, off other names, off every
 * line (`isCrossed` of an area), and not on another obstacle. Returns a function of an obstacle
 * ({ box, holds(x, y), isOther(x, y) }), the widths of its name, whole and short, and the height, to
 * the middle, the share of the size and the number of the width; null where none is free.
 */
function obstaclePlacer(frame, taken, isCrossed) {
  const isFree = (area) => area.left >= frame.left && area.right <= frame.right && area.top >= frame.top && area.bottom <= frame.bottom
    && !taken.some((other) => shared(area, other) > 0) && !isCrossed(area);
  return ({ box, holds, isOther }, widths, height) => {
    for (const [form, width] of widths.entries()) for (const where of ["inside", "outside"]) for (const share of [1, 0.8]) {
      const [w, h] = [width * share, height * 1.2 * share];
      for (const [x, y] of aroundBox(box, w, h, height * 0.42)[where]) {
        const area = areaAt(x, y, w, h);
        if ((where === "inside") !== holds(x, y) || !isFree(area) || isOther(x, y)) continue;
        taken.push(widened(area, height * 0.4));
        return { x, y, share, form };
      }
    }
    return null;
  };
}
