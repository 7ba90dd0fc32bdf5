#pragma once
#include <span>

#include "pbrt/math/vec.h"

namespace ext {
using namespace pbrt;

/// One point of a light, drawn with density p(y) (solid angle, or discrete for delta lights), as seen from the shading
/// point.
struct LightPoint {
    Float value = 0;  ///< |f Le cos V / p(y)|: the estimate of the light's contribution from this point alone
    Float ratio = 0;  ///< BSDF sampling's density for this direction over p(y); 0 if it cannot find the point
};

/// The probabilities of choosing a light that minimise the variance of the estimate of direct light, with expectations
/// over a light replaced by means over its points: `points` holds the same number of points for each light, light by
/// light.
///
/// Without MIS (all ratios 0) the second moment of "choose light l, draw y" is S(p) = sum_l m_l / p_l with
/// m_l = mean of value^2; its minimum is at p_l ~ sqrt(m_l).
///
/// With ratios r: one light sample and one BSDF sample, combined by the power heuristic with weights p_l^2/(p_l^2 +
/// r^2) and r^2/(p_l^2 + r^2). The sum of both second moments is S(p) = sum_l mean of value^2 (p_l^3 + r^3) / (p_l^2 +
/// r^2)^2, falling in every p_l. At the minimum all -dS/dp_l are equal; p_l <- p_l sqrt(-dS/dp_l), normalised, is
/// repeated until they are. One step is exact where r is 0. S can have more than one minimum; the one found was the
/// lowest or within 2 % of it in 200 random pairs of lights (tests/unit/ext/baselines/oracle).
///
/// Writes probabilities that sum to 1 to `pmf` (one per light); returns false and does not change `pmf` if all values
/// are 0 or their sum overflows.
bool LeastVariancePmf(std::span<const LightPoint> points, std::span<double> pmf);

/// S(p) of LeastVariancePmf, with these points as the lights.
double SecondMoment(std::span<const LightPoint> points, std::span<const double> pmf);

}  // namespace ext
