"""The thresholds of the diagnosis: what each guards against, and how it was set."""

# Log evidence (nats) by which something must be better than the baseline before anything is said
# to be missing. On drawn campaigns without an effect the best of a dozen rivals had at most 2.4.
MISSING = 5.0
# The same where clampings are not repeated: their scatter is told from the law's own misfit.
MISSING_FEW = 10.0
# The same for a further cause, and its least part of the evidence that is explained already: with
# a small part of a large effect a law that is not quite right invents a second cause.
FURTHER = 8.0
FURTHER_PART = 0.06
# A law is trusted to this part of its own effect (standard deviation).
TRUST = 0.08
# The same over amplitude, where laws are cruder and each clamping's friction differs.
TRUST_CURVE = 0.15
# Nats by which the smooth competitor must beat the best mechanism before that is called not it.
SHAPE = 4.0
# Nats by which the model without a mechanism must gain from where one with it ended before all are
# fitted anew from there: less is how exactly fits end.
OTHER_SUMMIT = 1.0
# Standard deviations of its score beyond which the smooth competitor is fitted from two starts.
ASKED = 1.0
# A remainder that the smooth competitor explains counts as unexplained beyond this part of what the
# causes explain.
UNEXPLAINED_PART = 0.3
MOST_CAUSES = 3  # a channel
# How many mechanisms, best first, are tried with a second one where none alone will do.
OPENINGS = 2
# Mechanisms within this many nats of the best are in the credible set (95 % at equal priors).
CREDIBLE = 3.0
# Times the usual difference of a hold's records (and its standard error) beyond which something let
# go between them. No drawn campaign without such a step had more than a few; a fall of kn and kt by
# a tenth is thousands.
JUMP = 30.0
# A fitted size beyond its physical limit by more than this many standard deviations is not one.
IMPLAUSIBLE = 2.0
# The smallest campaign that can tell gauge and level effects from the scatter of clampings.
RECORDS = 50
FORCES = 4
HOLDS_A_FORCE = 2
MODES = 2
# Curves of fewer forces, or of one mode, name no cause: of tuning cases one of an effect of no
# catalogue was named from curves of one force, and one was given a second cause from one mode.
CURVE_FORCES = 2
# Probability of as many findings by false alarms alone below which a record mechanism is named.
FALSE_ALARM = 1e-4
