"""The command `bladeroot`: one file a subcommand. Read `main` first.

In: what a person types. Out: text, files, and an exit code that is not 0 where something is wrong.
"""
