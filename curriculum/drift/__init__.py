"""What the gate reads in texts: numbers, formulas, names, commands, and passages it hashes."""
