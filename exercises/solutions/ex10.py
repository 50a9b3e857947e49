import contact

# At rest the mixture is zero: (1 - d) g = d K d depth, with K = 1 / (d1 timeconst dampratio)^2.
# Here d = d1 = 0.8 at every depth, so d^2 K = 1 / timeconst^2, and no mass is left.
DEPTH = (1.0 - 0.8) * -contact.GRAVITY * 0.05**2 / contact.RADIUS
