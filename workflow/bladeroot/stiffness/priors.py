"""What is thought of each quantity beforehand: mean, standard deviation and origin.

One prior a quantity, for the joint inference, the inference with curves and the diagnosis. Damping
(`diagnosis.damping_model`) and simulations without kn and kt (`diagnosis.simulation`) have theirs.
"""

import numpy as np

REFERENCE_FORCE = 12e3  # N

# The range that the thesis searched, 33 nodes times 1e4 to 1.5e5 N/mm (section 5.3), is mean plus
# and minus one standard deviation; its middle, 1.28 GN/m, is also what contact theory gives (6.16).
LN_K = (np.log(1.28e9), 1.36, "the thesis's range of search, contact theory in its middle")
# A smooth line contact stiffens with the logarithm of the force, exponent about 0.05; a rough one
# in proportion to it, exponent 1.
EXPONENT = (0.5, 0.5, "smooth contact 0 (6.16), rough contact 1; Table 5.2 has 0.65 and 0.47")
# Of the simulation that the diagnosis judges: constant over force. Another exponent, smooth
# contact's 0.05 (6.16) too, is a cause's to explain.
SMOOTH_EXPONENT = (0.0, 0.005, "smooth contact stiffens with exponent 0 to 0.07 (6.16)")
BEND = (0.0, 0.25, "no law known to us bends; room for full contact reached only at high force")
# ln of the standard deviation of ln kn and ln kt between clampings.
SCATTER = (np.log(0.04), 0.6, "re-clamping changes k by 2 to 14 %")
CORRELATION = (0.5, 0.7, "atanh of the correlation of kn and kt between clampings")
# A model that is wrong by so much at 12 kN is wrong by this part of it more a unit of ln F: 1 % of
# modulus moves 1B by 0.39 to 0.44 % between 1.8 and 24 kN.
BIAS_TILT = 0.05
# ln of each parameter of friction.
FRICTION = {
    "ln_friction": (np.log(0.3), 0.5, "dry steel on steel, 0.11 to 0.8 within two std"),
    "ln_edge": (np.log(0.07), 1.6, "next to nothing, as a punch leaves at its edges, to even"),
    "ln_exponent": (np.log(0.5), 0.5, "elliptic pressure (6.4) and twice or half as steep"),
    "ln_spread": (np.log(0.3), 0.7, "waviness and roughness; even pressure to a factor of three"),
}
