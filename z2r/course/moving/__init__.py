"""Pictures of the course that a reader moves by hand: a page each, self-contained, with a still for where none runs.

May import all of the course. Markup, style and scripts are in the templates of this folder.
"""

from z2r.course.moving.changes import changes_table
from z2r.course.moving.contact import push_in
from z2r.course.moving.pushes import story
from z2r.course.moving.seams import seam
from z2r.course.moving.tolerance import tolerance_box
from z2r.course.moving.yaw import yaw_slider

__all__ = ["changes_table", "push_in", "seam", "story", "tolerance_box", "yaw_slider"]
