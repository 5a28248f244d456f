"""The design "steps" of a sweep: from the case as it is to another one, a choice at a time, each added to those before.

"steps": [
  { "name": "the main case" },
  { "name": "PM4Sand for the embankment too", "set": { "fem:/materials/embankment": { "model": "pm4sand", ... } } }, ...
],
"reference": { "name": "the paper", "numbers": { "largest_displacement_mpm_m": 10 } }      what the way leads to, for the picture (of other designs: exceedance)

Parameters with lists make members of each step (the same runs with other motions, say): without them nobody knows what of a difference is chance.
"""

import json
from dataclasses import dataclass

import paths  # noqa: F401
import settings as what_if
from headline import BY_NAME
from json_keys import DesignError, Keys, near

PARAMETER = "step"


@dataclass
class Step:
    name: str
    settings: dict  # settings.parse: all that differs from the case, with what the steps before changed

    @property
    def keys(self):
        return {f"{stage}:{text.partition('=')[0]}" for stage, texts in self.settings.items() for text in texts}


def one_key(keys, name, word, contents):
    """(stage, pointer) of `mpm:/a/b`, which stands under `name` of the design; what the pointer names is for the program to check."""
    try:
        parsed = what_if.parse(f"{word}=0")
    except what_if.SettingError as error:
        raise DesignError(f"{keys.at(name)}: {str(error).removeprefix('SET: ').replace(f'{word}=0', word)}") from None
    if len(parsed) != 1 or any(len(texts) != 1 for texts in parsed.values()):
        raise DesignError(f"{keys.at(name)}: '{word}' is not one key, like {what_if.EXAMPLE.split('=')[0]}")
    stage = next(iter(parsed))
    if stage not in contents:
        raise DesignError(f"{keys.at(name)}: {word}: the case has no {stage}.json; it has {', '.join(f'{s}.json' for s in contents)}")
    return stage, word.partition(":")[2]


def read_steps(keys, contents):
    given = keys.value("steps", required=True)
    if not isinstance(given, list) or len(given) < 2:
        keys.refuse("steps", given, "a list of two steps at least")
    found, values = [], {}
    for index, entry in enumerate(given):
        own = Keys(keys.file, f"/steps/{index}", entry)
        name, changes = own.text("name", required=True), own.value("set", {})
        if not isinstance(changes, dict) or (not changes and index > 0):
            own.refuse("set", changes, "an object with a key like " + what_if.EXAMPLE.split("=")[0])
        if name in (step.name for step in found):
            raise DesignError(f"{own.at('name')}: '{name}' is there twice")
        for word, value in changes.items():
            way = one_key(own, "set", word, contents)
            # What lies within a value that is now given as a whole has gone with it.
            values = {key: text for key, text in values.items() if not (key[0] == way[0] and f"{key[1]}/".startswith(f"{way[1]}/"))}
            values[way] = json.dumps(value)
        own.finish()
        settings = {}
        for (stage, pointer), text in values.items():
            settings.setdefault(stage, []).append(f"{pointer}={text}")
        found.append(Step(name, settings))
    return found


def read_reference(keys):
    """{"name": text, "numbers": {headline: value}}, or None."""
    if not keys.has("reference"):
        return None
    own = Keys(keys.file, "/reference", keys.content["reference"])
    name, numbers = own.text("name", required=True), Keys(keys.file, "/reference/numbers", own.value("numbers", required=True))
    for headline in numbers.content:
        if headline not in BY_NAME:
            raise DesignError(f"{numbers.at(headline)}: there is no such number.{near(headline, BY_NAME)} There are {', '.join(BY_NAME)}")
    own.finish()
    return {"name": name, "numbers": {headline: numbers.number(headline, required=True) for headline in numbers.content}}
