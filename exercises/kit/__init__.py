"""What the exercises stand on: bets, blanks and how they are judged. Nothing to fill in here.

It finds contact.py and curriculum/ above the folder of the exercises, from wherever one starts.
"""

import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
if str(ROOT) not in sys.path:
    sys.path.insert(0, str(ROOT))
