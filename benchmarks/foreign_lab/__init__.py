"""A foreign laboratory: specimens, laws and mistakes that share no code with what infers.

Only `run.py` calls the product; nothing here imports its bench, its mechanisms or its diagnosis.
"""
