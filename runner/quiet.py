"""What the numerical libraries and Hydra are told by environment variables, before either is imported."""

import os


def quiet_environment() -> None:
    """Keep numerical libraries to one thread, and let Hydra's exceptions through; call before importing numpy."""
    for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
        os.environ.setdefault(name, "1")
    os.environ["HYDRA_FULL_ERROR"] = "1"
