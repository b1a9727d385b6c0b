"""Regressors, fits, thresholds, and generated observers run over recordings."""
