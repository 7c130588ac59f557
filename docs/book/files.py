"""Hook of MkDocs: the pages of the book are the Markdown files of the repository, each at its own path.

So a link between two pages is the same in the book, on a forge and on disk.
"""

import subprocess
from pathlib import Path

from mkdocs.structure.files import File, Files

# What pages show or link to, besides pages.
FOLDERS = ("docs/", "example-programs/", "worlds/", "sims/", "robis/")


def on_files(files, config):
    """Replaces the files below `docs_dir` by those of the repository."""
    root = Path(config.config_file_path).parent
    command = ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"]
    listed = subprocess.run(command, cwd=root, check=True, capture_output=True, text=True).stdout.split("\0")
    # Pages of sim-host are templates of `eyesim new`.
    names = [name for name in listed if name.startswith(FOLDERS) or name.endswith(".md") and not name.startswith("sim-host/")]
    theme = [file for file in files if not Path(file.abs_src_path).is_relative_to(config.docs_dir)]
    ours = [File(name, str(root), config.site_dir, config.use_directory_urls) for name in names if (root / name).is_file()]
    return Files(theme + ours)
