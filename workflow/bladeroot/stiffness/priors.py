"""The prior of each quantity: mean, standard deviation and origin.

Each has one prior for the joint inference, the inference with curves and the diagnosis. Those of
damping are in `diagnosis.damping_model`, those of simulations without kn and kt in
`diagnosis.simulation`.
"""

import numpy as np

REFERENCE_FORCE = 12e3  # N, to which ln kn and ln kt of a law over the force belong

# ln of kn and of kt (N/m) at that force. The range that the thesis searched, 33 nodes times 1e4 to
# 1.5e5 N/mm (section 5.3), is mean plus and minus one standard deviation; its middle, 1.28 GN/m, is
# also what contact theory gives (6.16).
LN_K = (np.log(1.28e9), 1.36, "the thesis's range of search, contact theory in its middle")
# Exponent of k over the force. A smooth line contact stiffens with the logarithm of the force,
# exponent about 0.05; a rough one in proportion to it, exponent 1.
EXPONENT = (0.5, 0.5, "smooth contact 0 (6.16), rough contact 1; Table 5.2 has 0.65 and 0.47")
# The same for the simulation that the diagnosis judges: k is constant over the force. Any other
# exponent, even smooth contact's 0.05 (6.16), is left for a cause to explain.
SMOOTH_EXPONENT = (0.0, 0.005, "smooth contact stiffens with exponent 0 to 0.07 (6.16)")
# Coefficient of x^2 in ln k, with x = ln(F / 12 kN).
BEND = (0.0, 0.25, "no law known to us bends; room for full contact reached only at high force")
# Of each parameter of a law (`laws`). A prior of kn or of kt alone is put in here.
PRIORS = {
    "ln_kn": LN_K,
    "ln_kt": LN_K,
    "exponent": EXPONENT,
    "exponent_kn": EXPONENT,
    "exponent_kt": EXPONENT,
    "bend_kn": BEND,
    "bend_kt": BEND,
}
# ln of the standard deviation of ln kn and ln kt between clampings.
SCATTER = (np.log(0.04), 0.6, "re-clamping changes k by 2 to 14 %")
CORRELATION = (0.5, 0.7, "atanh of the correlation of kn and kt between clampings")
# How the model's relative frequency error changes with force: its slope by ln F, as a part of the
# error at 12 kN, one standard deviation. 1 % of modulus moves 1B by 0.39 to 0.44 % between 1.8 and
# 24 kN.
BIAS_TILT = 0.05
# ln of each parameter of friction (`nonlinear.uneven.Uneven`).
FRICTION = {
    "ln_friction": (np.log(0.3), 0.5, "dry steel on steel, 0.11 to 0.8 within two std"),
    "ln_edge": (np.log(0.07), 1.6, "next to nothing, as a punch leaves at its edges, to even"),
    "ln_exponent": (np.log(0.5), 0.5, "elliptic pressure (6.4) and twice or half as steep"),
    "ln_spread": (np.log(0.3), 0.7, "waviness and roughness; even pressure to a factor of three"),
}
