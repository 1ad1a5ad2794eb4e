"""Rules of FMI 2.0.4 and 3.0 for an archive, checked without a library of FMI.

    fmu_rules.py ARCHIVE...

Says nothing where all hold; else what is broken, and exit code 1."""

import json
import re
import struct
import sys
import xml.etree.ElementTree as ET
import zipfile

NAME = re.compile(
    r"^(der\()?[A-Za-z_][A-Za-z0-9_]*(\[\d+\])?(\.[A-Za-z_][A-Za-z0-9_]*(\[\d+\])?)*\)?$")
# causality: variability: the initial values that a start value needs (True), forbids (False)
ALLOWED = {
    ("parameter", "fixed"): {"exact": True},
    ("parameter", "tunable"): {"exact": True},
    ("calculatedParameter", "fixed"): {"calculated": False, "approx": True},
    ("input", "continuous"): {None: True},
    ("output", "continuous"): {"exact": True, "approx": True, "calculated": False},
    ("output", "discrete"): {"exact": True, "approx": True, "calculated": False},
    ("local", "continuous"): {"exact": True, "approx": True, "calculated": False},
    ("independent", "continuous"): {None: False},
}
FILES = {
    "2.0": {"modelDescription.xml", "model.png", "documentation/index.html"},
    "3.0": {"modelDescription.xml", "documentation/index.html", "terminalsAndIcons/icon.png",
            "terminalsAndIcons/terminalsAndIcons.xml"},
}
# What the elements may have, of what is used here.
ATTRIBUTES = {
    "ModelExchange": {
        "2.0": {"modelIdentifier", "completedIntegratorStepNotNeeded", "canNotUseMemoryManagementFunctions",
                "canGetAndSetFMUstate", "canSerializeFMUstate", "providesDirectionalDerivative"},
        "3.0": {"modelIdentifier", "canGetAndSetFMUState", "canSerializeFMUState",
                "providesDirectionalDerivatives", "providesAdjointDerivatives"}},
    "CoSimulation": {
        "2.0": {"modelIdentifier", "canHandleVariableCommunicationStepSize", "canNotUseMemoryManagementFunctions",
                "canGetAndSetFMUstate", "canSerializeFMUstate", "providesDirectionalDerivative"},
        "3.0": {"modelIdentifier", "canHandleVariableCommunicationStepSize", "canGetAndSetFMUState",
                "canSerializeFMUState", "providesDirectionalDerivatives", "providesAdjointDerivatives",
                "hasEventMode", "mightReturnEarlyFromDoStep", "providesIntermediateUpdate",
                "canReturnEarlyAfterIntermediateUpdate"}},
}
OF_VARIABLE = {"name", "valueReference", "description", "causality", "variability", "initial"}
OF_NUMBERS = {"unit", "min", "max", "nominal", "start", "derivative"}
ORDER = ["ModelExchange", "CoSimulation", "UnitDefinitions", "LogCategories", "DefaultExperiment",
         "ModelVariables", "ModelStructure"]


class Rules:
    def __init__(self, archive):
        self.broken = []
        self.zip = zipfile.ZipFile(archive)
        self.check(self.zip.testzip() is None, "a member is damaged")
        for member in self.zip.infolist():
            self.check(member.compress_type in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED) and
                       member.extract_version <= 20 and member.flag_bits & 1 == 0 and
                       "\\" not in member.orig_filename and member.filename.isascii(), member.filename)
        self.root = ET.fromstring(self.zip.read("modelDescription.xml"))
        self.three = self.root.get("fmiVersion") == "3.0"

    def check(self, good, message):
        if not good:
            self.broken.append(message)

    def run(self):
        self.check(self.root.tag == "fmiModelDescription", "the root is " + self.root.tag)
        self.check(self.root.get("fmiVersion") in FILES, "fmiVersion")
        self.check([child.tag for child in self.root] == ORDER, "order of the elements")
        self.files()
        self.units = {unit.get("name") for unit in self.root.iter("Unit")}
        self.check(len(self.units) == len(list(self.root.iter("Unit"))), "a unit is there twice")
        self.variables()
        self.structure()
        return self.broken

    def files(self):
        names = set(self.zip.namelist())
        self.check(FILES[self.root.get("fmiVersion")] <= names, "files are missing")
        folder = "x86_64-linux" if self.three else "linux64"
        token = self.root.get("instantiationToken" if self.three else "guid")
        for kind in ("ModelExchange", "CoSimulation"):
            self.check(set(self.root.find(kind).attrib) <= ATTRIBUTES[kind][self.root.get("fmiVersion")],
                       "attributes of " + kind)
            identifier = self.root.find(kind).get("modelIdentifier")
            self.check(re.match(r"^[A-Za-z_][A-Za-z0-9_]*$", identifier), "modelIdentifier")
            binary = "binaries/%s/%s.so" % (folder, identifier)
            self.check(binary in names and self.zip.read(binary)[:4] == b"\x7fELF", "no binary")
        self.check(json.loads(self.zip.read("resources/machine.json"))["token"] == token, "token")
        icon = self.zip.read("terminalsAndIcons/icon.png" if self.three else "model.png")
        self.check(icon[:8] == b"\x89PNG\r\n\x1a\n" and
                   struct.unpack(">II", icon[16:24]) == (64, 64), "icon")
        self.check(b"<h1>" in self.zip.read("documentation/index.html"), "documentation")
        self.check("documentation/licenses/license.txt" in names, "licences")
        if self.three:
            graphics = ET.fromstring(self.zip.read("terminalsAndIcons/terminalsAndIcons.xml"))
            corners = {"x1", "y1", "x2", "y2"}
            self.check(set(graphics.find(".//CoordinateSystem").attrib) ==
                       corners | {"suggestedScalingFactorTo_mm"} and
                       set(graphics.find(".//Icon").attrib) == corners, "graphics")
        self.sources(names)

    def sources(self, names):
        """Every file that is to be compiled is there, and every file of hydrapod that one includes."""
        there = {name for name in names if name.startswith("sources/")}
        if not there:
            return
        build = ET.fromstring(self.zip.read("sources/buildDescription.xml"))
        self.check(build.get("fmiVersion") == "3.0", "fmiVersion of the build description")
        configuration = build.find("BuildConfiguration")
        self.check(configuration.get("modelIdentifier") == self.root.find("CoSimulation").get("modelIdentifier"),
                   "modelIdentifier of the build description")
        listed = ["sources/" + one.get("name") for one in configuration.iter("SourceFile")]
        if not self.three:
            for kind in ("ModelExchange", "CoSimulation"):
                files = ["sources/" + one.get("name") for one in self.root.find(kind).iter("File")]
                self.check(files == listed, "source files of " + kind)
        self.check(set(listed) == {name for name in there if name.endswith(".cpp")}, "source files")
        self.check("sources/fmu/fmi2.cpp" in there and "sources/fmu/fmi3.cpp" in there, "the interface's sources")
        for name in there:
            if name.endswith(".xml"):
                continue
            for included in re.findall(r'^#include "([^"]*)"', self.zip.read(name).decode(), re.M):
                beside = name.rsplit("/", 1)[0] + "/" + included
                self.check("sources/" + included in there or beside in there, name + " includes " + included)

    def listed(self):
        """Name, attributes of the variable and of its type, the key that the structure uses."""
        for place, element in enumerate(self.root.find("ModelVariables"), 1):
            numbers = element if self.three else element[0]
            self.check(element.tag == "Float64" if self.three else numbers.tag == "Real", "type")
            key = int(element.get("valueReference")) if self.three else place
            yield element.attrib, numbers.attrib, key

    def variables(self):
        names, references, self.by_key = set(), set(), {}
        for of, numbers, key in self.listed():
            name = of["name"]
            self.check(name not in names, "two variables are called " + name)
            self.check(of["valueReference"] not in references, name + ": value reference")
            self.check(NAME.match(name), name + " is no structured name")
            names.add(name)
            references.add(of["valueReference"])
            self.by_key[key] = (of, numbers)
            extra = {"intermediateUpdate"} if self.three else set()
            allowed = OF_VARIABLE | extra | (OF_NUMBERS if self.three else set())
            self.check(set(of) <= allowed and (self.three or set(numbers) <= OF_NUMBERS), name + ": attributes")
            if "intermediateUpdate" in of:
                self.check(of["causality"] in ("input", "output"), name + ": intermediateUpdate")
            self.combination(name, of, numbers)
            self.bounds(name, numbers)
            self.check(numbers.get("unit") in self.units, name + ": its unit is not defined")
            self.check(of.get("description"), name + " has no description")
        for of, numbers in self.by_key.values():
            if of["causality"] == "parameter":
                self.check("min" in numbers or "max" in numbers or of["name"].startswith("poses.") or
                           float(numbers["start"]) == 0 or "nominal" in numbers, of["name"] + ": no bounds, no nominal")
        independent = [of for of, _ in self.by_key.values() if of["causality"] == "independent"]
        self.check(len(independent) == 1, "there is not one independent variable")
        for of, numbers in self.by_key.values():
            if "derivative" in numbers:
                state = self.by_key[int(numbers["derivative"])][0]["name"]
                self.check(of["name"] == "der(%s)" % state, of["name"] + ": of another state")

    def combination(self, name, of, numbers):
        initials = ALLOWED.get((of["causality"], of["variability"]))
        self.check(initials is not None, name + ": causality and variability do not go together")
        if initials is None:
            return
        initial = of.get("initial")
        self.check(initial in initials, "%s: initial %s" % (name, initial))
        self.check(initials.get(initial) == ("start" in numbers), name + ": start")

    def bounds(self, name, numbers):
        low, high = float(numbers.get("min", "-inf")), float(numbers.get("max", "inf"))
        start = float(numbers.get("start", max(low, min(high, 0.0))))
        self.check(low <= start <= high, name + ": min, start, max")
        self.check(float(numbers.get("nominal", 1)) > 0, name + ": nominal")

    def unknowns(self, kind):
        structure = self.root.find("ModelStructure")
        if self.three:
            return [(int(e.get("valueReference")), e.attrib) for e in structure.findall(kind)]
        place = {"Output": "Outputs", "ContinuousStateDerivative": "Derivatives",
                 "InitialUnknown": "InitialUnknowns"}[kind]
        return [(int(e.get("index")), e.attrib) for e in structure.find(place)]

    def structure(self):
        def of(test):
            return {key for key, (v, n) in self.by_key.items() if test(v, n)}
        derivatives = of(lambda v, n: "derivative" in n)
        states = {int(self.by_key[key][1]["derivative"]) for key in derivatives}
        outputs = of(lambda v, n: v["causality"] == "output")
        inputs = of(lambda v, n: v["causality"] == "input")
        expected = {"Output": outputs, "ContinuousStateDerivative": derivatives,
                    "InitialUnknown": outputs | states | derivatives}
        for kind, keys in expected.items():
            given = self.unknowns(kind)
            self.check([key for key, _ in given] == sorted(keys), kind + "s: not all, or no order")
            for key, attributes in given:
                if self.by_key[key][0]["variability"] == "discrete":  # it may depend on all
                    self.check("dependencies" not in attributes, "dependencies of a discrete output")
                    continue
                self.dependencies(kind, key, attributes, states | inputs)
        if self.three:
            for key, attributes in self.unknowns("EventIndicator"):
                self.check(self.by_key[key][0]["causality"] == "local", "an indicator")
                self.dependencies("EventIndicator", key, attributes, states | inputs)
        else:
            self.check(int(self.root.get("numberOfEventIndicators")) >= 6, "event indicators")

    def dependencies(self, kind, key, attributes, knowns):
        if kind == "InitialUnknown":
            self.check("dependencies" not in attributes, "an initial unknown depends on all")
            return
        where = "%s %d" % (kind, key)
        on = [int(one) for one in attributes["dependencies"].split()]
        kinds = attributes.get("dependenciesKind", "").split()
        self.check(on == sorted(set(on)), where + ": order of the dependencies")
        self.check(set(on) <= knowns, where + ": depends on what is no state and no input")
        self.check(len(on) == len(kinds) and set(kinds) <= {"constant", "dependent"},
                   where + ": kinds")


broken = [archive + ": " + one for archive in sys.argv[1:] for one in Rules(archive).run()]
print("\n".join(broken), end="")
sys.exit(1 if broken or len(sys.argv) < 2 else 0)
