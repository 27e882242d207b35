"""How does the paper look? One HTML file with its figures and references, by pandoc.

pip install -e ".[publish]"
python paper/build.py [FILE]        # [build/paper.html]; FILE.pdf needs LaTeX
"""

import sys
from pathlib import Path

HERE = Path(__file__).parent


def build(file: Path) -> None:
    """Convert paper.md in the format of the file's suffix."""
    import pypandoc

    file.parent.mkdir(parents=True, exist_ok=True)
    options = [
        "--citeproc",
        "--standalone",
        f"--resource-path={HERE}",
        f"--bibliography={HERE / 'paper.bib'}",
    ]
    if file.suffix == ".html":
        options += ["--embed-resources", "--mathml"]
    pypandoc.convert_file(HERE / "paper.md", file.suffix[1:], outputfile=file, extra_args=options)


if __name__ == "__main__":
    made = Path(sys.argv[1]) if len(sys.argv) > 1 else HERE.parent / "build/paper.html"
    build(made)
    print(made)
