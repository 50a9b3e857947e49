"""Many balls: the steps of contact.py as loops that numba compiles, and near pairs."""
