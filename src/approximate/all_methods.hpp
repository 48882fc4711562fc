#pragma once

#include "approximate/method.hpp"

namespace bodesmith {

/// Equal ripple in log magnitude over all frequencies (or over the band): the best there is.
NormalisedApproximation minimax(const ApproximationTask& task);
/// Recursive poles and zeros, evenly spaced in log frequency (Oustaloup et al., IEEE Trans. CAS-I 47, 2000).
NormalisedApproximation oustaloup(const ApproximationTask& task);
/// Oustaloup over a wider band with a Taylor correction (Xue, Zhao and Chen, ICMA 2006), towards the term
/// itself.
NormalisedApproximation refined_oustaloup(const ApproximationTask& task);
/// Rational interpolation at real s, evenly spaced in log s (Matsuda and Fujii, J. Guid. Control Dyn. 16,
/// 1993).
NormalisedApproximation matsuda(const ApproximationTask& task);
/// Newton's iteration for P^(1/q) (Carlson and Halijak, IEEE Trans. CT 11, 1964).
NormalisedApproximation carlson(const ApproximationTask& task);
/// Continued fraction at the centre of the band: diagonal Pade approximant, zeros of a Jacobi polynomial.
NormalisedApproximation pade(const ApproximationTask& task);
/// Singularity functions (Charef et al., IEEE Trans. AC 37, 1992).
NormalisedApproximation charef(const ApproximationTask& task);

}  // namespace bodesmith
