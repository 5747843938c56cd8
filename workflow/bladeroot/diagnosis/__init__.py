"""What the simulation gets wrong, which mechanism explains it, and what is gained by adding it."""
