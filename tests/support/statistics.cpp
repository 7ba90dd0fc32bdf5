#include "support/statistics.h"

#include <boost/math/special_functions/gamma.hpp>

namespace pbrt::test {

double ChiSquareTail(double statistic, int dof) {
    if (dof <= 0 || statistic <= 0) return 1;
    if (!std::isfinite(statistic)) return std::isnan(statistic) ? statistic : 0;
    return boost::math::gamma_q(dof / 2.0, statistic / 2);
}

}  // namespace pbrt::test
