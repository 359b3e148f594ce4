"""This module brings files from outside ``docs`` into the site, and mends the links to them."""

import pathlib
import re
from typing import Any

from mkdocs.plugins import event_priority
from mkdocs.structure.files import File, Files

ROOT = pathlib.Path(__file__).parent.parent
PAGES = {
    "CONTRIBUTING.md": "project/contributing.md",
    "CHANGELOG.md": "project/changelog.md",
    "SECURITY.md": "project/security.md",
    "benchmarks/README.md": "project/benchmarks.md",
}


@event_priority(100)  # before the plugin that turns notebooks into pages
def on_files(files: Files, config: Any) -> Files:
    """Add the pages of the project, the JSON Schemas and the notebooks."""
    for path, place in PAGES.items():
        text = (ROOT / path).read_text()
        # these link to each other and to pages below docs/
        text = re.sub(r"\]\(docs/", "](../", text)
        for other, other_place in PAGES.items():
            text = text.replace(f"]({other}", f"]({pathlib.Path(other_place).name}")
        text = re.sub(r"\[([^\]]*)\]\((?!http|\.\./|#|[a-z]+\.md)[^)]*\)", r"\1", text)
        files.append(File.generated(config, place, content=text))
    for schema in sorted(ROOT.glob("hav_env/**/*.schema.json")):
        files.append(File.generated(config, f"schemas/{schema.name}", abs_src_path=str(schema)))
    for notebook in sorted(ROOT.glob("notebooks/*.ipynb")):
        place = str(notebook.relative_to(ROOT))
        files.append(File(place, str(ROOT), config.site_dir, config.use_directory_urls))
    return files


def on_page_markdown(markdown: str, page: Any, **_: Any) -> str:
    """Lead links to files outside ``docs`` to their pages, or take the link away."""
    up = "../" * page.file.src_uri.count("/")
    for path, place in PAGES.items():
        markdown = markdown.replace(f"](../{path}", f"]({up}{place}")
    if up:
        return markdown
    return re.sub(r"\[([^\]]*)\]\(\.\./[^)]*\)", r"\1", markdown)
