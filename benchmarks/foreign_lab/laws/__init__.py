"""The pool of laws, a file each; `foreign_lab.effect` says what a file holds."""
