# SPDX-License-Identifier: GPL-3.0-or-later
"""The data of a page, as a browser has them (report/page.h, and base.js of its pages)."""
import json
import re


def unpack(text):
    keys, shared, root = json.loads(text)

    def opened(value):
        if isinstance(value, list):
            return [opened(v) for v in value]
        if not isinstance(value, dict):
            return value
        if "#" in value:
            return opened(shared[value["#"]])
        if "~" in value:
            names = keys[value["~"][0]]
            return dict(zip(names, map(opened, value["~"][1:]), strict=True))
        return {name: opened(v) for name, v in value.items()}
    return opened(root)


def data(page, name):
    return unpack(re.search(f'<script type="application/json" id="{name}">(.*?)</script>', page, re.S)[1])
