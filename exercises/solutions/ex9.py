# 20 N press a spring of 3e5 N/m in by 0.07 mm, less than a thousandth of a radius. By its explicit
# step it would want steps below 1 ms; implicit takes 4.
MODEL, DT, STIFFNESS, DAMPING = "implicit", 0.004, 3e5, 80.0
SOLREF, SOLIMP = (0.02, 1.0), (0.9, 0.95, 0.001, 0.5, 2.0)
