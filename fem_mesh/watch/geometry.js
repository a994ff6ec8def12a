// Measures of a triangle, for the eye. Signs that decide anything are the kernel's, which are exact.

// Centre and radius of the circle through three points; an infinite radius where they are collinear.
export function circumcircle(x, y, a, b, c) {
  const bx = x[b] - x[a], by = y[b] - y[a], cx = x[c] - x[a], cy = y[c] - y[a];
  const d = 2 * (bx * cy - by * cx), bb = bx * bx + by * by, cc = cx * cx + cy * cy;
  const ux = (cy * bb - by * cc) / d, uy = (bx * cc - cx * bb) / d;
  return [x[a] + ux, y[a] + uy, Math.hypot(ux, uy)];
}

// The smallest angle of a triangle, in degrees.
export function smallestAngle(x, y, a, b, c) {
  const at = (p, q, r) => {
    const ux = x[q] - x[p], uy = y[q] - y[p], vx = x[r] - x[p], vy = y[r] - y[p];
    return Math.atan2(Math.abs(ux * vy - uy * vx), ux * vx + uy * vy);
  };
  return (Math.min(at(a, b, c), at(b, c, a), at(c, a, b)) * 180) / Math.PI;
}
