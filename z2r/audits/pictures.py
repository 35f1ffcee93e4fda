"""What do the pictures show? Something that moves when the robot does, and no two cameras the same."""

from collections.abc import Iterator
from functools import partial

import numpy as np

from z2r.audits.cameras import CAMERA_FORMAT, CAMERA_TWIN
from z2r.audits.looks import Look, Looks, Suspects
from z2r.audits.stats import STATS, numbers
from z2r.audits.structure import VIDEO_FILE
from z2r.check import Answer, Check
from z2r.errors import Fault
from z2r.format.rules import and_more, episodes_of
from z2r.format.tables import STATS_PATH, TASKS_PATH
from z2r.reading.stored import episodes_named

_OTHER_COLOUR = 0.1  # of white: some of the pictures may be that far from all of them
_OTHER_SPREAD, _FINE = 2, 0.05  # times as large; and of white, which what is finer than the small pictures may add
_LATE = 0.25  # s: most cameras are late by less


@VIDEO_FILE.of(Looks)
def videos_can_be_decoded(looks: Looks) -> Iterator[Answer]:
    """Can the pictures of every video be decoded?"""
    yield from (fault for fault in looks.faults if not fault.field)


@CAMERA_FORMAT.of(Looks)
def images_can_be_decoded(looks: Looks) -> Iterator[Answer]:
    """Can every image be decoded that was looked at?"""
    yield from (fault for fault in looks.faults if fault.field)


CAMERA_FLAT = Check("camera-flat", "no camera shows one colour or noise, as if covered or unplugged", "warning")


@CAMERA_FLAT.of(Looks)
def no_camera_shows_one_colour(looks: Looks) -> Iterator[Answer]:
    """Does a camera show one flat colour, or noise, throughout an episode, or at times?"""
    for look in looks.cameras:
        for suspects in (look.flat, look.blank):
            yield from _looks_wrong(look, suspects, "a picture of something")
        for fault in _looks_wrong(look, look.dark, "a picture of something"):
            yield "note", fault  # a camera on a wrist may well come close to something


@CAMERA_FLAT.of(Looks)
def no_picture_has_bars(looks: Looks) -> Iterator[Answer]:
    """Are all pictures of a camera black on two sides? They were made to fit a shape that is not the camera's."""
    for look in looks.cameras:
        if look.bars:
            mend = "Harmless if a policy sees the same when it acts; pixels are lost: crop or scale without bars"
            yield "note", Fault(look.place, look.camera, look.bars, "a picture of something up to its edges", mend)


CAMERA_FROZEN = Check(
    "camera-frozen", "no camera shows the same picture for an episode while the robot moves", "warning"
)


@CAMERA_FROZEN.of(Looks)
def no_camera_is_frozen(looks: Looks) -> Iterator[Answer]:
    """Does a camera show the same picture throughout an episode? One that always does may not see the robot: a note."""
    for look in looks.cameras:
        still = look.still._replace(wrong=look.still.wrong & ~look.flat.wrong)
        for fault in _looks_wrong(look, still, "pictures that change, as the robot moves"):
            yield ("note" if still.wrong.mean() > 0.5 else "warning"), fault
        for fault in _looks_wrong(look, look.hung, "pictures that change, as the robot moves"):
            yield "note", fault._replace(mend="Did the camera hang, or was the robot out of the picture? Look at it")
        for fault in _looks_wrong(look, look.slow, "pictures that change, as the robot moves"):
            mend = "Is the camera slower than fps? Then a picture is older than its frame says"
            yield ("note" if look.slow.wrong.mean() > 0.5 else "warning"), fault._replace(mend=mend)


@Check("camera-leap", "pictures go on smoothly, in their order: none is another one at once", "warning").of(Looks)
def no_picture_leaps(looks: Looks) -> Iterator[Answer]:
    """Is each picture much like the next one, and does the camera stay where it is?"""
    for look in looks.cameras:
        for fault in _looks_wrong(look, look.flicker, "a picture that is much like the next one"):
            yield fault._replace(mend="Are pictures broken, or of two cameras in turn? Look at some in a row")
        for fault in _looks_wrong(look, look.leap, "a picture that stays"):
            yield fault._replace(mend="Was the camera pushed, or does another recording begin there? Look at it")
        for fault in _looks_wrong(look, look.broken, "pictures that go on smoothly"):
            yield "note", fault._replace(mend="Were parts of them lost on their way? Look at some in a row")
        for fault in _looks_wrong(look, look.swing, "light that stays"):
            yield "note", fault._replace(mend="Lamps on mains flicker: set the shutter to 1/50 or 1/60 s")
        for fault in _looks_wrong(look, look.focus, "pictures that are as sharp throughout"):
            yield "note", fault._replace(mend="Does the camera hunt for its focus? Fix it, where the driver can")
        for fault in _looks_wrong(look, look.disorder, "pictures in the order in which they were taken"):
            yield fault._replace(mend="Was each written when it was ready, and not in its turn? Look at some in a row")


@Check("camera-unlike", "the pictures of an episode look like those of the others of its camera", "warning").of(Looks)
def no_episode_looks_otherwise(looks: Looks) -> Iterator[Answer]:
    """Do the pictures of an episode look otherwise than those of the others? Where it is not told how: a note."""
    for look in looks.cameras:
        for each in look.unlike:
            rows, usual = (look.number[some].tolist() for some in (each.rows, each.usual))
            place = f"{look.camera} in {episodes_named(rows)}"
            found = f"pictures {each.says or 'of something else'}, compared with those of {episodes_named(usual)}"
            mend = "Was the camera moved, turned, covered or exchanged? Look at them"
            if not each.few:
                mend = "Nobody can tell which of them are right: look at both"
            fault = Fault(look.place, place, found, "pictures that are alike", mend, tuple(sorted(rows)))
            yield ("warning" if each.few and each.says else "note"), fault


CAMERA_QUALITY = Check("camera-quality", "pictures are made in the same way in all episodes", "note")


@CAMERA_QUALITY.of(Looks)
def pictures_are_of_one_kind(looks: Looks) -> Iterator[Answer]:
    """Does a number of the pictures part the episodes in two, as where a lens, or what a driver does, changed?"""
    for look in looks.cameras:
        for each in look.parted:
            named, others = (look.number[rows].tolist() for rows in (each.some, each.others))
            found = f"pictures with {each.says} {each.own:.2g}, where {episodes_named(others)} have {each.its:.2g}"
            place, expected = f"{look.camera} in {episodes_named(named)}", "pictures that are made in the same way"
            yield Fault(look.place, place, found, expected, each.mend, tuple(named))


@CAMERA_QUALITY.of(Looks)
def no_camera_sinks(looks: Looks) -> Iterator[Answer]:
    """Does the view of a camera move a little from each episode to the next, or once between two of them?"""
    for look in looks.cameras:
        if look.drift:
            mend = "Was it pushed, or is a screw of its mount loose? Compare the first episode with the last"
            yield Fault(look.place, look.camera, look.drift, "a camera that stays where it is", mend)


@CAMERA_TWIN.of(Looks)
def no_two_cameras_show_the_same(looks: Looks) -> Iterator[Answer]:
    """Do two cameras show the same pictures throughout an episode? Of those of one colour, that is no wonder."""
    for twin in looks.twins:
        found = partial("the same pictures as {}".format, twin.other.camera)
        same = Suspects(twin.same & ~twin.look.flat.wrong, found)
        yield from _looks_wrong(twin.look, same, "pictures of its own")


@CAMERA_TWIN.of(Looks)
def no_two_episodes_show_the_same(looks: Looks) -> Iterator[Answer]:
    """Are the pictures of an episode those of another one, whose robot goes another way? One of the two is wrong."""
    for look in looks.cameras:
        for fault in _looks_wrong(look, look.again, "pictures of its own"):
            yield fault._replace(
                mend="Which of the two they belong to, the other cameras and the robot tell: look at both"
            )


@STATS.of(Looks)
def pictures_have_the_stored_colour(looks: Looks) -> Iterator[Answer]:
    """Are the statistics of each camera those of its pictures? Those of some of them are near, those of another not."""
    for look in looks.cameras:
        stored = numbers((looks.claims.stored.stats.value or {}).get(look.camera, {}).get("mean"))
        if stored is None or stored.shape != look.colour.shape or not stored.max() <= 1:
            continue
        off = np.abs(stored - look.colour)
        if off.max() > _OTHER_COLOUR:
            found, seen = (" ".join(f"{each:.2f}" for each in colour) for colour in (stored, look.colour))
            mend = "Are these of another camera? A policy scales its pictures by them"
            yield Fault(STATS_PATH, f"{look.camera}.mean", found, f"about {seen}, as decoded", mend)


@STATS.of(Looks)
def pictures_have_the_stored_spread(looks: Looks) -> Iterator[Answer]:
    """Is the stored std of each camera about that of its pictures? A policy divides by it."""
    for look in looks.cameras:
        stored = numbers((looks.claims.stored.stats.value or {}).get(look.camera, {}).get("std"))
        if stored is None or stored.shape != look.deviation.shape or not 0 <= stored.min() <= stored.max() <= 1:
            continue
        less, more = stored < look.deviation / _OTHER_SPREAD, stored > (look.deviation + _FINE) * _OTHER_SPREAD
        if (less | more).any():
            found, seen = (" ".join(f"{each:.2g}" for each in std) for std in (stored, look.deviation))
            mend = "A policy divides its pictures by them: compute them from pixels, not from means of pictures"
            yield Fault(STATS_PATH, f"{look.camera}.std", found, f"about {seen}, as decoded", mend)


@Check("camera-motion", "pictures show where the robot is, not where it was or will be", "warning").of(Looks)
def camera_motion(looks: Looks) -> Iterator[Answer]:
    """Do the pictures of an episode go with its robot? Those of another, or of another time, do not."""
    for look in looks.cameras:
        yield from _looks_wrong(look, look.astray, "pictures that show where the robot is")
        for fault in _looks_wrong(look, look.seam, "pictures of its own from the first frame to the last"):
            mend = (
                "Does the video begin too late or too early, or was a buffer not emptied? Shift it, or cut these frames"
            )
            yield ("warning" if look.seam.wrong.sum() > 1 else "note"), fault._replace(mend=mend)
        if look.late >= _LATE:
            found = f"pictures of where the robot was {look.late:g} s before, in all episodes"
            mend = "A policy learns with old pictures: is the camera as late where it shall act?"
            yield "note", Fault(look.place, look.camera, found, "pictures that show where the robot is", mend)


@Check(
    "task-colour", "there is something of each colour that a task names, in the pictures of its episodes", "note"
).of(Looks)
def task_colour(looks: Looks) -> Iterator[Answer]:
    """Does a task name red, yellow, green or blue, and the pictures show none of it, or end with that of another?"""
    number = looks.claims.stored.episodes.value.table.number
    for each in looks.misnamed:
        mend = "Are the texts of tasks exchanged, or red and blue? Look at an episode, and read its task"
        named = episodes_of(number, each.rows)
        yield Fault(TASKS_PATH, f"task {each.task}", each.found, f"{each.expected}, as it says", mend, named)


def _looks_wrong(look: Look, suspects: Suspects, expected: str) -> Iterator[Fault]:
    wrong, found = suspects
    if wrong.any():
        row = int(wrong.argmax())
        place = f"{look.camera} in episode {look.number[row]}"
        said = f"{found(row)}{and_more(wrong)}"
        yield Fault(look.place, place, said, expected, look.mend, episodes_of(look.number, wrong))
