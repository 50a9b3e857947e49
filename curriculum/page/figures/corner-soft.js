/* The corner, rounded on purpose. */
import { corner, LAWS } from "../corners.js";

export const figure = corner(LAWS.soft, {
  title: "soft rounds the corner off",
  caption: "soft rounds the corner: the ball gives way at first and the slope grows steeper, seen here twenty times nearer.",
  knobs: ["impedance"],
  uses: ["timeconst", "dampratio", "dt"],
});
