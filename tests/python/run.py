"""run.py BUILD: the tests of the package awtd, as installed, before the daemon in folder BUILD."""

import os
import sys
import unittest

if __name__ == "__main__":
    if len(sys.argv) > 1:
        os.environ["AWTD_BUILD"] = sys.argv[1]
    here = os.path.dirname(os.path.abspath(__file__))
    result = unittest.TextTestRunner(verbosity=2).run(unittest.defaultTestLoader.discover(here))
    failed = len(result.failures) + len(result.errors)
    print(f"{result.testsRun - failed - len(result.skipped)} passed, {failed} failed, {len(result.skipped)} skipped")
    sys.exit(failed > 0)
