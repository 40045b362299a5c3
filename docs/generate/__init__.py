"""Reference pages of the documentation site that follow from the code.

`pages.pages` returns all of them as text in Markdown. The hook of MkDocs (hooks.py) adds them to the site; nothing is
written into docs/.
"""
