/* The corner with penalty's ramp. */
import { corner, LAWS } from "../corners.js";

export const figure = corner(LAWS.penalty, {
  title: "penalty’s ramp beside the corner",
  caption: "penalty has a ramp beside the wall: the ball must get in before the table pushes.",
  knobs: ["stiffness"],
});
