"""Reading and auditing recordings.

`residuum.recordings.audit` holds `audit` and `clean`; what everybody needs stands here.
"""

from .reading import read, read_chunks
from .recording import Recording
from .speed import speeds

__all__ = ["Recording", "read", "read_chunks", "speeds"]
