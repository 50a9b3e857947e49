/* The corner as exact takes it: from event to event. */
import { corner, LAWS } from "../corners.js";

export const figure = corner(LAWS.exact, {
  title: "exact on the corner",
  caption: "exact keeps to the corner and asks only when the ball turns from one side into the other.",
});
