"""Records of a campaign as one: loads, clampings, groups and the sensors of one motion.

In: curves and plateaus of all records. Out: mean curves (`curves`), stick frequencies by record and
load (`stick`), groups compared (`groups`), records unlike their repeats (`judgement`). Read `stick`
first.
"""
