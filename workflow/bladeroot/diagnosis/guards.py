"""The thresholds of the diagnosis: what each guards against, and how it was set."""

# Priors are stated, not fitted. All are nats (natural logarithms of odds).
# A cause of the catalogue against its absence: of campaigns, two of five then have none of the 21
# causes that are no findings.
PRIOR = 2.9
# Something of no catalogue, smooth in what was varied, against its absence: it may be anything, and
# more is asked of it than of two causes.
PRIOR_UNKNOWN = 6.3
# Of each cause beside a first one, in whichever data, in addition: campaigns with two causes are
# rarer than if causes were independent.
FURTHER = 0.7
# Nats by which the data must raise a cause's odds for it to be spoken of as possibly shown. In 22
# drawn campaigns without a cause none rose by more than 1.3 before it was tempered.
RAISED = 1.0
# Most evidence (nats) of a cause that is less than SIGMAS from nothing: 20 to 1, never a name.
UNSURE = 3.0
# The temper of the evidence was set on some 45 tuning campaigns of a laboratory with other laws
# than these (its seeds 1 to 199, benchmarks/foreign.py) and 36 of Masing's slip, seating and drift
# by further formulas, so that no name above 0.9 was wrong but for reasons that were mended.
# Part of all that is explained (nats), times the laws' own error (TRUST), that is no evidence
# between laws: no law is exact.
MODEL_ERROR = 0.2
# A law that is not quite right invents small further causes: each must explain that error (TRUST)
# of what the best single cause explains besides. What is asked fades where a further cause explains
# such parts of it.
FURTHER_FADES = 0.2
# Times the temperature where clampings are not repeated: their scatter is told from the law's own
# misfit. An unreplicated null then needs some 8 nats to be named, not 5.
FEW_TEMPERATURE = 1.5
# Probability from which on a name is certain, and of a credible set where it is not.
CERTAIN, CREDIBLE = 0.9, 0.95
# Sets of causes less probable are not listed.
LEAST_PROBABILITY = 1e-6
# Standard deviations from nothing below which no cause is named.
SIGMAS = 3.0
ROUNDS = 4  # of the search for the most probable set
# A law is trusted to this part of its own effect (standard deviation), times `stick_model.LAWS`.
TRUST = 0.08
# The same over amplitude, where laws are cruder and each clamping's friction differs.
TRUST_CURVE = 0.15
# Standard deviations of its score beyond which the smooth competitor is fitted from two starts.
ASKED = 1.0
# Times that trust beyond which a law's own error says that it is not this law.
LAW_MISFIT = 2.0
MOST_CAUSES = 3  # a channel
# How many mechanisms, best first, are tried with a second one where none alone will do.
OPENINGS = 2
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
# Times their stated errors by which curves may miss the best explanation before that is told.
STRAINED = 2.0
# Curves of fewer forces, or of one mode, name no cause: of tuning cases one of an effect of no
# catalogue was named from curves of one force, and one was given a second cause from one mode.
CURVE_FORCES = 2
