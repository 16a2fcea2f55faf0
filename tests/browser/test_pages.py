# SPDX-License-Identifier: GPL-3.0-or-later
"""All tests of pages, one after the other in one browser; each module runs by itself, too."""
import unittest

MODULES = ["test_pictures", "test_report", "test_show", "test_odd", "test_view"]  # pictures before a hand has been anywhere


def load_tests(loader, _tests, _pattern):
    return loader.loadTestsFromNames(MODULES)


if __name__ == "__main__":
    unittest.main()
