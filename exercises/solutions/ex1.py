PREDICTION = "C"
WHY = "penalty's spring pushes m g only at one depth; lcp asks for a speed, whatever the depth"
