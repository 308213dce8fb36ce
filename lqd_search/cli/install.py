"""How to install what is missing, said in one place."""

INSTALL_ALL = "run `pip install '.[all]'` in a clone of lqd-envs"
"""What to do where a package of an extra is not there; no version is released yet."""
