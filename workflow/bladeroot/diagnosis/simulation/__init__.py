"""What is judged: a parametric structure, a table of frequencies, or the linear baseline."""
