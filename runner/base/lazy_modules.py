"""Pinocchio, eigenpy, PyBullet and parts of SciPy, imported on first use, because checks of a config do not need them.

eigenpy is Pinocchio's interface to Eigen. Its factorisations of small matrices have the same bits on every x86-64
processor; those of NumPy and SciPy do not.
"""

from collections.abc import Callable
from types import ModuleType
from typing import TYPE_CHECKING, Any

from runner.base.engine_output import quiet_stderr

if TYPE_CHECKING:
    import eigenpy as eigen
    import pinocchio as pin
    import pybullet
    from scipy import interpolate as splines
    from scipy.linalg import lapack
else:

    class _Loaded:
        """Names of a module."""

    class _LazyModule(_Loaded):
        """Names of a module that is imported on the first use of one of them."""

        def __init__(self, load: Callable[[], ModuleType]) -> None:
            self._load = load

        def __getattr__(self, name: str) -> Any:
            if name.startswith("__"):
                raise AttributeError(name)
            module = self._load()
            self.__dict__.update(vars(module))
            self.__class__ = _Loaded  # a lookup without this method is as fast as in a module
            return getattr(module, name)

    def _pinocchio() -> ModuleType:
        import pinocchio

        return pinocchio

    def _eigenpy() -> ModuleType:
        import eigenpy

        return eigenpy

    def _pybullet() -> ModuleType:
        with quiet_stderr():  # it prints its build time
            import pybullet

        return pybullet

    def _interpolate() -> ModuleType:
        from scipy import interpolate

        return interpolate

    def _lapack() -> ModuleType:
        from scipy.linalg import lapack

        return lapack

    pin, eigen = _LazyModule(_pinocchio), _LazyModule(_eigenpy)
    pybullet, splines, lapack = _LazyModule(_pybullet), _LazyModule(_interpolate), _LazyModule(_lapack)

__all__ = ["eigen", "lapack", "pin", "pybullet", "splines"]
