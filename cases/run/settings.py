"""Settings of a what-if: `mpm:/residual_strength/factor=0.5` is the stage whose case file is meant, and what its program takes
as --set. Values are checked by the programs; here they are put into the case's content so that equal inputs are known as equal.
"""

import difflib
import json
import re
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from case_part import read_case  # noqa: E402

STAGES = ("fem", "import", "transfer", "mpm")
EXAMPLE = "mpm:/residual_strength/factor=0.5"
# Blanks part settings where the next one begins; within a JSON value they do not.
BETWEEN = re.compile(r"\s+(?=(?:[A-Za-z_]\w*:)?/\S*=|[A-Za-z_]\w*:\S*=)")


class SettingError(Exception):
    """A setting that no program can be asked about."""


def parse(text):
    """{"mpm": ["/residual_strength/factor=0.5", ...], ...} of a text with any number of settings."""
    found = {}
    for word in BETWEEN.split(text.strip()) if text.strip() else []:
        stage, colon, setting = word.partition(":")
        if word.startswith("/") or not colon:
            raise SettingError(f"SET: '{word}' does not say whose case file it is for; write {' or '.join(s + ':' for s in STAGES)} "
                               f"before it, as {EXAMPLE}")
        if stage not in STAGES:
            near = difflib.get_close_matches(stage, STAGES, 1, 0.4)
            hint = f" Did you mean '{near[0]}:'?" if near else ""
            raise SettingError(f"SET: '{word}': there is no stage '{stage}'.{hint} Stages are {', '.join(STAGES)}, as in {EXAMPLE}")
        if not re.match(r"/[^=]*=", setting):
            raise SettingError(f"SET: '{word}': after '{stage}:' a setting is /pointer=value, as in {EXAMPLE}")
        found.setdefault(stage, []).append(setting)
    return found


def words(settings):
    """The settings as they are given: ["mpm:/residual_strength/factor=0.5", ...]."""
    return [f"{stage}:{text}" for stage in STAGES for text in settings.get(stage, [])]


def value_of(text):
    """JSON, or else the text itself."""
    try:
        return json.loads(text)
    except ValueError:
        return text


def place(content, keys, value):
    """Puts `value` at the end of the way `keys`, making objects that are not there as the programs do; False where there is no way."""
    for key in keys[:-1]:
        if isinstance(content, list) and key.isdigit() and int(key) < len(content):
            content = content[int(key)]
        elif isinstance(content, dict):
            content = content.setdefault(key, {})
        else:
            return False
    if isinstance(content, dict):
        content[keys[-1]] = value
    elif isinstance(content, list) and keys[-1].isdigit() and int(keys[-1]) < len(content):
        content[int(keys[-1])] = value
    else:
        return False
    return True


def case_with(path, texts):
    """Content of a case file without comments, with settings in their places. One that has no place there stays what it
    is, for the program to refuse with its own words."""
    content = read_case(path)
    lost = []
    for text in texts:
        pointer, _, value = text.partition("=")
        keys = [key.replace("~1", "/").replace("~0", "~") for key in pointer.split("/")[1:]]
        if not place(content, keys, value_of(value)):
            lost.append(text)
    if lost:
        content = {"": lost, **content}
    return json.loads(json.dumps(content), parse_int=float)  # 1 is 1.0
