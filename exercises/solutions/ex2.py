PREDICTION = "C"
WHY = "penalty's force stays as it was for a whole step; lcp's velocity is right at its end"
