"""The checker of shapes and types: `pytest --jaxtyping-packages=bladeroot,shapes.checked`."""

from beartype import BeartypeConf, beartype

# A whole number is a float, as PEP 484 has it: files say 7850.
checked = beartype(conf=BeartypeConf(is_pep484_tower=True))
