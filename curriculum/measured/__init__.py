"""What benchmark, stress report and ledger store, and how it is known which code it is of."""
