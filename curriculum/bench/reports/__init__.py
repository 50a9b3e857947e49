"""What is written about each measurement: a page, its goals and its figures, from the results alone."""
