"""What the gate looks at in texts: numbers, formulas, names, commands, and the passages it hashes."""
