/* The corner: of gap and force one is always zero. */
import { corner, LAWS } from "../corners.js";

export const figure = corner(LAWS.corner, {
  title: "The corner: gap to the right, force upwards",
  caption: "Lift the ball and the gap grows with no force; press it and the force grows with no gap.",
});
