"""Exercise 3, a right answer: `python exercises/ex3_dt_stability.py --solution` runs it."""

PREDICTION = "C"
WHY = "penalty's force stays as it was at the last look, lcp's speed is right whenever it is asked"
