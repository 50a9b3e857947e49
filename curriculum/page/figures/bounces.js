/* Infinitely many bounces, over at a finite time. */
import { ball, number, steps } from "../draw.js";
import { runModel } from "../engine.js";
import { axis, charted, G, handle, kept, R, scene, START, within } from "../parts.js";

const ROWS = 600;
const LAND = Math.sqrt((2 * (START - R)) / G); // s

// When all bounces are over [s], and when the k-th (from 1) is at its top.
const over = (e) => (LAND * (1 + e)) / (1 - e);
const top = (e, k) => LAND * (1 + (2 * e * (1 - e ** (k - 1))) / (1 - e) + e ** k);

const run = kept((e, until) => runModel("exact", scene([START], { restitution: e }), { dt: until / ROWS }, ROWS));

function draw(view) {
  const e = view.get("restitution");
  const until = Math.max(1, 1.15 * over(e));
  const { t, y } = run(e, until);
  const { markup, sx, sy, box } = charted(view, 0, {
    id: "bounces",
    x: { domain: [0, until], ticks: steps(0, until, 5), label: "time (s)" },
    y: axis([0, 1.15], "height (m)", 0, 0.5, 1),
    lines: [{ model: "exact", xs: t, ys: Array.from(y) }],
    rules: [{ x: over(e), text: `over at ${number(over(e))} s`, class: "dashed", row: 1 }],
  });
  view.own.heightAt = (at) => (1.15 * (box.bottom - at)) / (box.bottom - box.top);
  const r = sy(0) - sy(R);
  const tops = [1, 2, 3, 4].map((k) => top(e, k)).filter((time) => time < until);
  const balls = tops.map((time) => [sx(time), sy(y[Math.round((time / until) * ROWS)])]);
  const text = `e = ${e.toFixed(2)}`;
  return {
    svg: balls.map((at) => ball("exact", ...at, r, "ghost")).join("") + markup + ball("exact", sx(until) - r, sy(R), r),
    words: `${text}: every bounce is e² = ${number(e * e, 2)} times as high as the last, and all are over at ${number(over(e))} s.`,
    handles: [handle("top", ...balls[0], 16, "the top of the first bounce", e, text)],
  };
}

const set = (view, e) => view.set({ restitution: within(0, Number(e.toFixed(2)), 0.95) });

export const figure = {
  title: "Bounces that end",
  caption: "There are infinitely many bounces, and they are over at a finite time: drag the top of the first.",
  height: 250,
  uses: ["restitution"],
  shows: { scene: "bounce", restitution: 0.7 },
  draw,
  drag: (view, name, x, y) => set(view, Math.sqrt(Math.max(0, view.own.heightAt(y) - R) / (START - R))),
  nudge: (view, name, dx, dy) => set(view, view.get("restitution") + 0.01 * (dx - dy)),
};
