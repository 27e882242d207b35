"""How does a page link to a Markdown file outside ``docs/``? As to any other file: the site has a copy of
it."""

from pathlib import Path

from sphinx import addnodes
from sphinx.transforms import SphinxTransform


class RepositoryFiles(SphinxTransform):
    """MyST makes a download of a link to ``../train.py``, and of one to ``../CHANGELOG.md`` a link to a page,
    of which there is none."""

    default_priority = 300

    def apply(self, **kwargs):
        """Replace the links of one page."""
        source = Path(self.env.srcdir).resolve()
        for node in list(self.document.findall(addnodes.pending_xref)):
            if node.get("refdomain") != "doc":
                continue
            target = (source / f"{node['reftarget']}.md").resolve()
            here = (source / self.env.docname).parent
            if source in target.parents or not target.is_file():
                continue
            relative = Path(
                *[".."] * len(here.relative_to(source).parts), "..", target.relative_to(source.parent)
            )
            made = addnodes.download_reference(
                "", "", *node.children, reftarget=relative.as_posix(), refdoc=self.env.docname
            )
            made.source, made.line = node.source, node.line
            node.replace_self(made)


def setup(app):
    """Register with Sphinx."""
    app.add_transform(RepositoryFiles)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
