"""Recursive maximum likelihood of a dead zone, a linear process and AR noise, in information form.

Every sample gives a prediction error e and its gradient psi = -de/dtheta by the recursions of
:mod:`lostmotion.kernels.likelihood` (`advance`); their products are summed over a block (`run`). At the end of a block
the normal equations of everything remembered are solved (`information`): a Gauss-Newton step (Ljung and Soderstrom,
*Theory and Practice of Recursive Identification*, section 3.7, with information instead of covariance matrices).

What is remembered: `reference`, a sum over old blocks, and a ring of the newest blocks, which carry full weight.
A block that leaves the ring enters the reference, which forgets, direction by direction, as much as comes in and
no more: without excitation nothing is lost (`equations.merge`). Linearised equations are kept about the origin of
theta, so they add. How fast the break points walk is found beside it (`drift`): the reference loses what a walk makes
uncertain. Errors, commands and their steps are watched (`watch`). The ring also holds the samples themselves, to look
back at them after an alarm (`change`).

Order of theta: a (na), b (nb+1), offset, left, right, log_ratio, d (p). Right slope 1. Where all of it lies:
:mod:`lostmotion.kernels.recursive_ml.state`.
"""
