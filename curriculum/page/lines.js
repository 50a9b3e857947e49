/* The lines of code that figures light while they run: [region, what stands in one line of it]. The
 * build stops where that is not exactly one line. */
export const LINES = {
  spring: ["penalty", "return max(0.0"],
  sweep: ["sweep", "lam = max("],
  way: ["leapfrog", "iters)  # the way"],
  speed: ["leapfrog", "solve_with_momentum(closed"],
  softness: ["implicit-spring", "c.softness, c.target"],
  acceleration: ["soft", "c.target = v_n"],
  strike: ["exact", "strike(touching"],
  bias: ["lcp-target", "return bias"],
  larger: ["lcp-target", "return max(bias"],
  rising: ["soft-impedance", "rise = raised"],
  levelling: ["soft-impedance", "rise = 1.0"],
  hardest: ["soft-impedance", "return d1"],
};
