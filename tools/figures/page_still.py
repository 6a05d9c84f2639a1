#!/usr/bin/env python3
"""How a browser shows a page that computes, at the setting in its address, once it is done.

    page_still.py PAGE#SETTING WIDTHxHEIGHT PICTURE.png
"""

import base64
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.realpath(__file__)), "../../tests/interactive"))
from browser import Page  # noqa: E402

address, size, picture = sys.argv[1:]
width, height = map(int, size.split("x"))
with Page("file://" + address, width=width, height=height) as page:
    page.ask("Emulation.setScrollbarsHidden", hidden=True)
    page.wait("document.body.dataset.ready")
    with open(picture, "wb") as file:
        file.write(base64.b64decode(page.ask("Page.captureScreenshot")["data"]))
