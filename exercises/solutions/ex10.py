from contact import RADIUS

# At rest (1 - d) g = d K d depth, K = 1 / (d1 timeconst dampratio)^2, and d = d1: no mass is left.
DEPTH = (1.0 - 0.8) * 9.81 * 0.05**2 / RADIUS
