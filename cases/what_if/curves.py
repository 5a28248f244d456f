"""The picture of a grid as curves: headline numbers over one of its lists, a line for each combination of the others.

"curves": {
  "over": "hand_over_time", "axis": "time of the hand-over (s)",       the list along the axis (numbers), and the axis' words
  "chance": ["motion_scale"],      lists whose values differ in nothing physical: mean and standard deviation are taken over them
  "numbers": ["flow_front_m", "moved_mass_kg"]      of headline.py
}
"""

import paths  # noqa: F401
from headline import BY_NAME
from json_keys import DesignError, Keys, near


def read_curves(keys, parameters, kind):
    """{"over", "axis", "chance", "numbers"} of a design, None without; `parameters` are those of the design (design.Parameter)."""
    if not keys.has("curves"):
        return None
    if kind != "grid":
        raise DesignError(f"{keys.at('curves')}: curves are drawn of the design 'grid', this one is '{kind}'")
    own = Keys(keys.file, f"{keys.pointer}/curves", keys.content["curves"])
    known = {parameter.name: parameter for parameter in parameters}
    over, chance, numbers = own.text("over", required=True), own.value("chance", []), own.value("numbers", required=True)
    for key, given in (("chance", chance), ("numbers", numbers)):
        if not isinstance(given, list) or not all(isinstance(name, str) for name in given):
            own.refuse(key, given, "a list of names")
    for key, names in (("over", [over]), ("chance", chance)):
        for name in names:
            if name not in known:
                raise DesignError(f"{own.at(key)}: there is no parameter '{name}'.{near(name, known)} There are {', '.join(known)}")
    if over in chance:
        raise DesignError(f"{own.at('chance')}: '{over}' is what curves are drawn over")
    if known[over].choices is None or not known[over].numeric:
        raise DesignError(f"{own.at('over')}: '{over}' is no list of numbers")
    if not numbers:
        own.refuse("numbers", numbers, "a list with a number at least")
    for name in numbers:
        if name not in BY_NAME:
            raise DesignError(f"{own.at('numbers')}: there is no such number.{near(name, BY_NAME)} There are {', '.join(BY_NAME)}")
    axis = own.text("axis", over.replace("_", " "))
    own.finish()
    return {"over": over, "axis": axis, "chance": chance, "numbers": numbers}
