"""Settings of numerical libraries, Hydra and Matplotlib, applied before their import."""

import logging
import os


def quiet_environment() -> None:
    """Keep numerical libraries to one thread, and let Hydra's exceptions through; call before importing numpy.

    Matplotlib says its errors alone: in a home that cannot be written it warns of each folder that it makes elsewhere.
    """
    for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
        os.environ.setdefault(name, "1")
    os.environ["HYDRA_FULL_ERROR"] = "1"
    logging.getLogger("matplotlib").setLevel(logging.ERROR)
