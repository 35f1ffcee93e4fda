"""How it looks: in the terminal, as a rerun recording, and as a page.

Here stands what turns an inspection or an audit into something to look at, for any robot. Imports: `z2r.audits`,
`z2r.reading` and below.
"""
