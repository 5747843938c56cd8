"""Contact stiffness from measured stick frequencies and a reduced model of the joint.

Stick frequencies move from the measured forces to those of the models (`interpolation`); a map
from stiffness to frequency is drawn once a model (`map`), searched for the stiffness that gives
the measured pair (`search`, and `grid_search` as the thesis does it), and the answers of all
forces are put side by side (`summary`). The room needs `structure` and `contact` beside numpy.
"""
