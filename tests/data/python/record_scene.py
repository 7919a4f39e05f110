# SPDX-License-Identifier: LGPL-2.1-or-later
"""record_scene.py SCENE.py: prints as XML what the createScene of a SOFA Python scene adds to its root."""
import runpy
import sys
import xml.etree.ElementTree as ET


def text(value):
    if isinstance(value, (list, tuple)):
        return " ".join(text(entry) for entry in value)
    return str(value)


class Recorder:
    def __init__(self, element):
        object.__setattr__(self, "element", element)

    def __setattr__(self, name, value):
        self.element.set(name, text(value))

    def addObject(self, kind, **attributes):
        return Recorder(ET.SubElement(self.element, kind, {name: text(value) for name, value in attributes.items()}))

    def addChild(self, name):
        return Recorder(ET.SubElement(self.element, "Node", name=name))


root = Recorder(ET.Element("Node", name="root"))
runpy.run_path(sys.argv[1])["createScene"](root)
print(ET.tostring(root.element, encoding="unicode"))
