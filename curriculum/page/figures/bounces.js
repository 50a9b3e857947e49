/* Infinitely many bounces, over at a finite time. */
import { ball, number, plot, steps } from "../draw.js";
import { runModel } from "../engine.js";
import { G, kept, R, scene, START, within } from "../parts.js";

const ROWS = 600;
const LAND = Math.sqrt((2 * (START - R)) / G); // s

// When all bounces are over [s], and when the k-th (from 1) is at its top.
export const over = (e) => (LAND * (1 + e)) / (1 - e);
const top = (e, k) => LAND * (1 + (2 * e * (1 - e ** (k - 1))) / (1 - e) + e ** k);

const run = kept((e, until) => runModel("exact", scene([START], { restitution: e }), { dt: until / ROWS }, ROWS));

function chartOf(view) {
  const e = view.get("restitution");
  const until = Math.max(1, 1.15 * over(e));
  const { t, y } = run(e, until);
  const chart = plot({
    id: "bounces",
    width: view.width,
    height: view.height,
    x: { domain: [0, until], ticks: steps(0, until, 5), label: "time (s)" },
    y: { domain: [0, 1.15], ticks: [[0, "0"], [0.5, "0.5"], [1, "1"]], label: "height (m)" },
    lines: [{ model: "exact", xs: t, ys: Array.from(y) }],
    rules: [{ x: over(e), text: `over at ${number(over(e))} s`, class: "dashed", row: 1 }],
  });
  return { ...chart, e, until, heightAt: (time) => y[Math.round((time / until) * ROWS)] };
}

function draw(view) {
  const { markup, sx, sy, e, until, heightAt } = chartOf(view);
  const r = sy(0) - sy(R);
  const tops = [1, 2, 3, 4].map((k) => top(e, k)).filter((t) => t < until);
  const balls = tops.map((t) => ball("exact", sx(t), sy(heightAt(t)), r, "ghost"));
  const text = `e = ${e.toFixed(2)}`;
  return {
    svg: balls.join("") + markup + ball("exact", sx(until), sy(R), r),
    words: `${text}: every bounce is e² = ${number(e * e, 2)} times as high as the last, and all are over at ${number(over(e))} s.`,
    handles: [{ name: "top", x: sx(top(e, 1)), y: sy(heightAt(top(e, 1))), r: 16, label: "the top of the first bounce", value: e, text }],
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
  drag(view, name, x, y) {
    const { box } = chartOf(view);
    const height = ((box.bottom - y) / (box.bottom - box.top)) * 1.15;
    set(view, Math.sqrt(Math.max(0, height - R) / (START - R)));
  },
  nudge: (view, name, dx, dy) => set(view, view.get("restitution") + 0.01 * (dx - dy)),
};
