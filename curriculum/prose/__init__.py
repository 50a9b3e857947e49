"""The chapter: its text, the marks and numbers in it, and what reads them."""
