"""Records of a campaign as one: loads, clampings, groups and the sensors of one motion.

In: curves and plateaus of all records. Out: stick frequencies by record and level (`stick`, whose
mean and errors are `components`'; from a table: `stick_table`), the mean curve of a level with its
covariance (`level_curve`) and those of all levels as a file (`curves`), groups compared (`groups`),
records unlike their repeats or unlike other sensors of their motion (`repeats`, `sensors`, told by
`judgement`). Read `stick` first. `variables.csv` says what each output variable is.
"""
