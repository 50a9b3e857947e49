/* A ball that slides from rest off a ball that is held, as curriculum/exact.py finds it. While they
 * touch, the line of centres turns like a pendulum that stands on its head; where the force that
 * keeps them apart has fallen to zero, the upper ball flies on. */

// Angle [rad] and rate [rad/s] a time h later, where angle'' = k sin(angle) (Runge and Kutta).
function turned([angle, rate], h, k) {
  const slope = (share, [a, b]) => [rate + share * h * b, k * Math.sin(angle + share * h * a)];
  const first = slope(0, [0, 0]);
  const second = slope(0.5, first);
  const third = slope(0.5, second);
  const last = slope(1, third);
  const mean = (i) => (first[i] + 2 * second[i] + 2 * third[i] + last[i]) / 6;
  return [angle + h * mean(0), rate + h * mean(1)];
}

/* The upper ball, from `angle` on, every dt [s], with small steps: {path, last, leaves}. The path
 * holds its places [x, y], in m from the held ball's middle, `reach` m apart as long as they touch;
 * `last` is the last of them in touch, `leaves` the angle where it leaves. */
export function slideOff(angle, reach, gravity, dt, steps) {
  const k = gravity / reach;
  const force = ([at, rate]) => k * Math.cos(at) - rate * rate;
  const place = ([at]) => [reach * Math.sin(at), reach * Math.cos(at)];
  let now = [angle, 0];
  const path = [place(now)];
  for (let next = now; path.length <= steps; path.push(place(now))) {
    next = turned(now, dt, k);
    if (force(next) < 0) break;
    now = next;
  }
  let h = dt; // until the force is zero, by Newton's method
  for (let tries = 0; tries < 6; tries++) {
    const [at, rate] = turned(now, h, k);
    h += force([at, rate]) / (3 * k * Math.sin(at) * rate);
  }
  const [leaves, rate] = turned(now, h, k);
  const [x, y] = place([leaves]);
  const last = path.length - 1;
  for (let t = dt - h; path.length <= steps; t += dt)
    path.push([x + t * rate * y, y - t * (rate * x + 0.5 * t * gravity)]);
  return { path, last, leaves };
}
