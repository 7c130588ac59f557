"""MkDocs hook: the pages of the book are the Markdown files of the repository, each at its own path.

A link between two pages is therefore the same in the book, on a forge and on disk.
"""

import logging
import re
import subprocess
from pathlib import Path

from mkdocs.structure.files import File, Files

# Folders with files that pages show or link to.
FOLDERS = ("docs/", "example-programs/", "worlds/", "sims/", "robis/")

LOG = logging.getLogger("mkdocs.hooks.files")


def on_files(files, config):
    """Replaces the files below `docs_dir` with those of the repository."""
    root = Path(config.config_file_path).parent
    command = ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"]
    listed = subprocess.run(command, cwd=root, check=True, capture_output=True, text=True).stdout.split("\0")
    # Pages of the crate eyesim are templates of `eyesim new`.
    names = [name for name in listed if name.startswith(FOLDERS) or name.endswith(".md") and not name.startswith("eyesim/")]
    theme = [file for file in files if not Path(file.abs_src_path).is_relative_to(config.docs_dir)]
    ours = [File(name, str(root), config.site_dir, config.use_directory_urls) for name in names if (root / name).is_file()]
    return Files(theme + ours)


def on_page_markdown(markdown, **_):
    """Converts a second word after a block's language, such as `wrong`, to the block's title, since MkDocs accepts no second word."""
    return re.sub(r"^```(\S+) (\w+)$", r'```\1 title="\2"', markdown, flags=re.MULTILINE)


def on_page_content(html, page, **_):
    """Warns if a fence did not become a block; the strict mode turns the warning into an error."""
    fenced, blocks = len(re.findall(r"^```", page.markdown, flags=re.MULTILINE)) // 2, html.count("<pre>")
    if blocks < fenced:
        LOG.warning("%s: %d blocks of %d fences", page.file.src_uri, blocks, fenced)
