"""Figures: one small file a stage, each function takes Datasets and returns a matplotlib Figure."""
