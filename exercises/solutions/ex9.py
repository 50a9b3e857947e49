BETS = """
              k x 4    dt / 4    sweeps x 4    beta x 4
    sink        -        =           =            =
    dive        =        -           =            =
    hop         =        -           =            +
    sag         =        -           -            -
    trembling   +        -           =            =
"""
# six balls lie on the lowest: each step its sweep pushes 6 m g dt, while beta depth / dt opens
SAG = 6 * 9.81 * 0.001**2 / 0.5 / 0.1
