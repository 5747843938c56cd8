"""The thesis, number by number: what it prints, what is computed here, and a verdict."""
