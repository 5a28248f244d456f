"""One HTML file with its pictures inside, which can be sent on as it is."""

import base64
import html
import os
from pathlib import Path

STYLE = """body{font:15px/1.45 sans-serif;max-width:1100px;margin:2em auto;padding:0 1em;color:#222}img{max-width:100%}
table{border-collapse:collapse;margin:1em 0;display:block;overflow-x:auto}td,th{padding:.2em .8em;border-bottom:1px solid #ddd;text-align:right}
td:first-child,th:first-child{text-align:left}figure{margin:1.2em 0}figcaption{color:#555}.small{color:#666;font-size:90%}"""


def table(header, rows):
    """HTML of a table of texts."""
    cells = [["th", header], *(["td", row] for row in rows)]
    return "<table>" + "".join("<tr>" + "".join(f"<{kind}>{html.escape(str(cell))}" for cell in row) for kind, row in cells) + "</table>"


def picture(path, caption):
    data = base64.b64encode(Path(path).read_bytes()).decode()
    caption = html.escape(caption)
    return f"<figure><img alt='{caption}' src='data:image/png;base64,{data}'><figcaption>{caption}</figcaption></figure>"


def paragraph(text, small=False):
    return f"<p{' class=small' if small else ''}>{html.escape(text)}</p>"


def heading(text):
    return f"<h2>{html.escape(text)}</h2>"


def write(path, title, parts):
    head = f"<!doctype html><html lang=en><meta charset=utf-8><title>{html.escape(title)}</title><style>{STYLE}</style>"
    text = head + f"<h1>{html.escape(title)}</h1>" + "\n".join(parts) + "\n"
    temporary = Path(path).with_name(f".part_{Path(path).name}")
    temporary.write_text(text)
    os.replace(temporary, path)
