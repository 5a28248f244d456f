"""A JSON object read key by key, as the programs read case files: unknown keys, wrong types and values out of range are refused with file, pointer
and the nearest known word."""

import difflib
import json
import math


class DesignError(Exception):
    """A sweep file that cannot be meant."""


def near(word, known, alike=0.5):
    found = difflib.get_close_matches(str(word), [str(k) for k in known], 1, alike)
    return f" Did you mean '{found[0]}'?" if found else ""


class Keys:
    """An object of the file at `pointer`; finish() refuses what has not been asked for."""

    def __init__(self, file, pointer, content):
        self.file, self.pointer, self.content, self.asked = file, pointer, content, []
        if not isinstance(content, dict):
            raise DesignError(f"{file}: {pointer or '/'}: {self.word(content)} found, an object {{...}} is needed")

    @staticmethod
    def word(value):
        return json.dumps(value)[:60]

    def at(self, key):
        return f"{self.file}: {self.pointer}/{key}"

    def refuse(self, key, found, needed):
        raise DesignError(f"{self.at(key)}: {self.word(found)} found, {needed} is needed")

    def has(self, key):
        self.asked.append(key)
        return key in self.content

    def value(self, key, default=None, required=False):
        if not self.has(key):
            if required:
                raise DesignError(f"{self.file}: {self.pointer or '/'}: key '{key}' is missing; there are {', '.join(self.content) or 'none'}")
            return default
        return self.content[key]

    def number(self, key, default=None, required=False, above=None, at_least=None):
        value = self.value(key, default, required)
        if value is None and not required and key not in self.content:
            return default
        if isinstance(value, bool) or not isinstance(value, (int, float)) or not math.isfinite(value):
            self.refuse(key, value, "a finite number")
        if above is not None and not value > above:
            self.refuse(key, value, f"a number above {above:g}")
        if at_least is not None and value < at_least:
            self.refuse(key, value, f"a number of at least {at_least:g}")
        return float(value)

    def count(self, key, default, least):
        value = self.value(key, default)
        if isinstance(value, bool) or not isinstance(value, int) or value < least:
            self.refuse(key, value, f"a whole number of at least {least}")
        return value

    def text(self, key, default=None, required=False):
        value = self.value(key, default, required)
        if value is not None and not isinstance(value, str):
            self.refuse(key, value, "a text")
        return value

    def choice(self, key, known, default=None):
        value = self.value(key, default, default is None)
        if value not in known:
            raise DesignError(f"{self.at(key)}: '{value}' is not known.{near(value, known)} Allowed are {', '.join(known)}")
        return value

    def finish(self):
        for key in self.content:
            if key not in self.asked:
                raise DesignError(f"{self.file}: {self.pointer or '/'}: unknown key '{key}'.{near(key, self.asked)} "
                                  f"Known here: {', '.join(dict.fromkeys(self.asked))}")
