"""Where new solutions come from: parents selected, varied, and made anew."""
