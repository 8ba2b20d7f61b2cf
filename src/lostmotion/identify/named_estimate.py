"""What every estimate offers, batch or recursive: named parameters with standard errors and intervals."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from lostmotion import _verbs
from lostmotion.arrays import FloatArray
from lostmotion.brief import Brief
from lostmotion.distributions import normal_quantile
from lostmotion.errors import ParameterError
from lostmotion.identify.predicted import Predictor, as_scans
from lostmotion.models import Hammerstein, LinearModel, NoiseModel, Nonlinearity
from lostmotion.records import LoopRecord

if TYPE_CHECKING:
    import os


class NamedEstimate(Brief):
    """Base of results that hold a model, named parameters and their covariance in the same order."""

    model: Hammerstein
    noise: NoiseModel | None
    parameters: dict[str, float]
    covariance: FloatArray

    @property
    def nonlinearity(self) -> Nonlinearity:
        """Actuator model."""
        return self.model.nonlinearity

    @property
    def linear(self) -> LinearModel:
        """Linear part."""
        return self.model.linear

    @property
    def standard_errors(self) -> dict[str, float]:
        """One standard error of each parameter, same keys as `parameters`; infinite where not known."""
        errors = np.sqrt(np.maximum(np.diag(self.covariance), 0.0))
        return dict(zip(self.parameters, errors.tolist(), strict=True))

    def interval(self, name: str, level: float = 0.95) -> tuple[float, float]:
        """Confidence interval of a parameter.

        Parameters
        ----------
        name : str
            Key of `parameters`.
        level : float
            Confidence in (0, 1).

        Raises
        ------
        ParameterError
            Unknown name or a level outside (0, 1).
        """
        if name not in self.parameters:
            raise ParameterError.expected(f"one of {list(self.parameters)}", repr(name), "see fit.parameters")
        if not 0 < level < 1:
            raise ParameterError.expected("0 < level < 1", level, "0.95 is usual")
        reach = normal_quantile(0.5 + level / 2) * self.standard_errors[name]
        return self.parameters[name] - reach, self.parameters[name] + reach

    def simulate(
        self,
        op: npt.ArrayLike | LoopRecord | str | os.PathLike[str] | Any,
        pv: float | None = None,
        *,
        initial: npt.ArrayLike | None = None,
    ) -> FloatArray:
        """PV from OP alone, without noise, in the units of the record that was identified.

        Parameters
        ----------
        op : LoopRecord, path, data frame or array_like, shape (n,)
            A record at the sampling time of the fit; in an array the samples are that far apart. A record is taken as
            the fit takes it: OP held over holes of two rows and no further than its span, and unknown where it need
            not have reached the valve (:func:`lostmotion.records.prepare`); an array as it is.
        pv : float, optional
            With an array: where PV rests before the first sample. None: where the first OP holds it; of an
            integrating process the mean PV of the fit.
        initial : array_like, shape (m,), optional
            With an array: PV measured on its first m samples, more than delay and order together. The simulation begins
            at the state that they show best, as benchmarks of nonlinear identification have it.

        Returns
        -------
        ndarray, shape (n,)
            PV on the rows of `op`. NaN where OP is missing or unknown, and on the first `delay` rows of each piece of
            a record, whose OP lies before it.

        Raises
        ------
        ParameterError
            A record of another sampling time, `pv` or `initial` beside a record or each other, too few samples in
            `initial`.
        DataError
            An array with missing values.

        Notes
        -----
        An array begins at rest. Each piece of a record begins at the state that its PV shows best, with the first
        stretch of PV that is long enough: max(na, nb) numbers by least squares, as in the fit, and of a backlash or
        stiction the place in the band. A piece without such a stretch begins at rest. The constant load of an
        integrating process is the parameter `load`; where a fit has none, an array begins with the load that its first
        OP holds, and each piece of a record has the one that its PV shows best. Swings and steps of load
        (`fit.chosen.loads`) belong to the record in which they were found, and are not simulated; nor is a
        characteristic that bends (`fit.chosen.slopes`) or a lag that differs with direction (`fit.chosen.asymmetry`):
        gain and time constant are the mean ones.

        Examples
        --------
        >>> import lostmotion as lm
        >>> tank = lm.platforms.level_tank()
        >>> u = lm.signals.prs(1000, -5, 5, hold=10, seed=1)
        >>> fit = lm.identify(u, tank.simulate(u), 0.1, nonlinearity="dead zone", orders=(3, 2, 3), noise="white")
        >>> [round(level, 3) + 0.0 for level in fit.simulate([0.0] * 5 + [3.0] * 100)[[0, 8, -1]].tolist()]
        [0.0, 0.043, 13.331]
        """
        source = as_scans(op)
        if pv is not None and initial is not None:
            raise ParameterError.expected("pv or initial", "both", "initial holds where PV begins")
        if not isinstance(source, LoopRecord):
            given = initial is not None
            return self._predictor.from_initial(source, initial) if given else self._predictor.from_rest(source, pv)
        if pv is not None or initial is not None:
            name = "pv" if initial is None else "initial"
            raise ParameterError.expected(f"no {name} beside a record", name, "its own PV says where it begins")
        return self._predictor.on_record(source)

    def predict(
        self,
        op: npt.ArrayLike | LoopRecord | str | os.PathLike[str] | Any,
        pv: npt.ArrayLike | None = None,
        horizon: int = 1,
    ) -> FloatArray:
        """PV predicted from OP, and from PV up to `horizon` samples before, with the noise model.

        Parameters
        ----------
        op : LoopRecord, path, data frame or array_like, shape (n,)
            A record, or with `pv` an array at the sampling time of the fit.
        pv : array_like, shape (n,), optional
            PV beside an array of OP; both are taken as they are.
        horizon : int
            Samples from the last PV that is used to the predicted one, at least 1. OP is known up to the predicted one.

        Returns
        -------
        ndarray, shape (n,)
            On the rows of the record, in units of its PV. NaN as in :meth:`simulate`, and where a PV that is needed
            is missing, stuck, clipped or wild, or lies before the piece.

        Raises
        ------
        ParameterError
            A record of another sampling time, no whole number of samples as horizon, arrays of different lengths, or an
            estimate without a noise model.

        Notes
        -----
        ``y(k) = z(k) + E[v(k) | v(k - horizon), v(k - horizon - 1) ..]`` with z of :meth:`simulate` and v = y - z. With
        white noise that is z for any horizon; with coloured noise it comes to z as the horizon grows. The
        initial state of z is estimated from all PV of the piece, later ones included.
        """
        source = as_scans(op)
        record = isinstance(source, LoopRecord)
        if record == (pv is not None):
            expected = "no pv beside a record" if record else "a record with OP and PV, or pv beside op"
            remedy = "give the horizon by its name" if record else "use simulate() for OP alone"
            raise ParameterError.expected(expected, "pv" if record else type(source).__name__, remedy)
        if self.noise is None:
            raise ParameterError.expected("an estimate with a noise model", "none", "use simulate(), or identify()")
        return self._predictor.ahead(source, horizon) if record else self._predictor.ahead_of(source, pv, horizon)

    def to_control(self) -> Any:
        """Whole model as a discrete ``NonlinearIOSystem`` of python-control, OP to PV in the units of the record.

        Actuator with its memory, linear part, offset, and the constant load of an integrating process, where the fit
        has one. Needs the extra ``lostmotion[control]``. The transfer function alone is ``fit.linear.to_control()``.

        Notes
        -----
        From the state zero it begins as ``fit.model.simulate`` does, the process at rest at x = 0 and PV at the
        offset; lead with OP at rest for as long as the process takes to settle.
        """
        return self.model.to_control(self.parameters.get("load", 0.0))

    def _repr_html_(self) -> str:
        """Headline and a small table, for notebooks."""
        return _verbs.panel(self).html()

    @property
    def _predictor(self) -> Predictor:
        return Predictor(self.model, (self.noise or NoiseModel()).autoregression(), self.parameters.get("load"))
