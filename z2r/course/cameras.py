"""What did a camera see in this frame? One picture of a dataset's video, whole."""

import numpy as np
from numpy.typing import NDArray

from z2r.format.about import axes_of
from z2r.format.dataset import Dataset
from z2r.format.decoding import check_can_decode, cut_clip, decode_clip, plan_cut
from z2r.format.videos import read_films, read_video, video_features


def picture(dataset: Dataset, camera: str, frame: int) -> NDArray[np.uint8]:
    """Return what a camera saw in a frame.

    Parameters
    ----------
    dataset : Dataset
        From `z2r.load`.
    camera : str
        A feature that is stored as video, such as ``observation.images.front``.
    frame : int
        Which frame of the dataset, from 0.

    Returns
    -------
    ndarray, uint8[height, width, 3]
        The picture, in RGB.

    Raises
    ------
    DatasetError
        If the video is missing or cannot be decoded.
    MissingExtraError
        If PyAV is not installed.
    ValueError
        If there is no such camera, or the video ends before that frame.
    """
    check_can_decode()
    if camera not in (cameras := video_features(dataset.schema)):
        raise ValueError(f"found no camera {camera!r}, expected one of {', '.join(cameras)}")
    film = read_films(dataset.root, dataset.schema, dataset.episodes).value[camera]
    path, time = film.paths[film.file_number[frame]], float(film.time[frame])
    video, every = read_video(dataset.root, path), 1 / dataset.schema.fps
    cut, _ = plan_cut(video, time, time + every, max_bytes=int(video.sizes.sum()))
    if cut.end == cut.first:
        raise ValueError(f"found nothing at {time:g} s of {path}, expected a picture of frame {frame}")
    feature = dataset.schema.features[camera]
    width = axes_of(feature).get("width", feature.shape[1])
    clip = cut_clip(dataset.root, path, video, cut)
    return next(decode_clip(clip, time - float(video.times[cut.key]), every, width))
