# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests of reports' pages, one after the other in one browser (those of mechanisms: test_mechanism_pages); each module runs by itself, too."""
import unittest

MODULES = ["test_pictures", "test_report"]  # pictures before a hand has been anywhere


def load_tests(loader, _tests, _pattern):
    return loader.loadTestsFromNames(MODULES)


if __name__ == "__main__":
    unittest.main()
