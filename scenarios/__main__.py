"""`python -m scenarios` in a checkout: the command line of `python -m bogie_braking`."""

import sys

from bogie_braking.__main__ import main

sys.exit(main())
