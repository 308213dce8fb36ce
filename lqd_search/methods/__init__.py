"""Whole searches behind one ask/tell interface."""
