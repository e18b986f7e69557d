"""`python -m lashloop`."""

import sys

from lashloop.cli import main

sys.exit(main())
