PREDICTION = "C"
WHY = "penalty's force stays as it was at the last look, lcp's speed is right whenever it is asked"
