"""Exercise 1, a right answer: `python exercises/ex1_predict_contact.py --solution` runs it."""

PREDICTION = "C"
WHY = "penalty's spring pushes m g only at one depth; lcp asks for a speed, whatever the depth"
