/* The corner as lcp meets it: once a step. */
import { corner, LAWS } from "../corners.js";

export const figure = corner(LAWS.lcp, {
  title: "lcp meets the corner once a step",
  caption: "Press, and the ball comes down step by step: each ring is one look, the last of the fall is past the wall, and the next looks bring it back.",
  knobs: ["dt"],
  uses: ["baumgarte", "iters"],
});
