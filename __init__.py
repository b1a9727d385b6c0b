"""residuum: symbolic residual observers for Universal Robots arms.

The repository root is this package; see README.md for the first ten minutes.
"""

__version__ = "0.1.0"
