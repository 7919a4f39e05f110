# SPDX-License-Identifier: LGPL-2.1-or-later
"""Decodes what a viewer shows: the element of its page, the arrays in it, and places in 16 bits."""
import base64
import html.parser
import zlib


class RunData(html.parser.HTMLParser):
    """The element that holds the data, as a browser finds it."""

    def __init__(self, page):
        super().__init__()
        self.found, self._is_in = [], False
        self.feed(page)

    def handle_starttag(self, tag, attributes):
        self._is_in = tag == "script" and ("class", "run") in attributes

    def handle_endtag(self, tag):
        self._is_in = False

    def handle_data(self, text):
        if self._is_in:
            self.found.append(text)


def unpacked(data):
    raw, at, arrays = zlib.decompress(base64.b64decode(data["data"])), 0, {}
    for entry in data["arrays"]:
        size, count, stride = entry["bits"] // 8, entry["count"], entry["stride"]
        planes = [raw[at + k * count:at + (k + 1) * count] for k in range(size)]
        values = []
        for i, parts in enumerate(zip(*planes)):
            folded = int.from_bytes(bytes(parts), "little")
            difference = -(folded + 1) // 2 if folded % 2 else folded // 2
            values.append(((values[i - stride] if i >= stride else 0) + difference) % 2 ** entry["bits"])
        arrays[entry["name"]] = values
        at += size * count
    assert at == len(raw), "bytes are left over"
    return arrays


def places(numbers, box):
    return [box[i % 3] + q / 65535 * (box[3 + i % 3] - box[i % 3]) for i, q in enumerate(numbers)]
