#include "pbrt/math/statistics.h"

#include <algorithm>
#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <limits>

namespace pbrt {
namespace {
// Boost treats more degrees of freedom as infinite anyway; the cap keeps its algorithms in range.
constexpr double kMaxDof = 1e9;
// Boost throws where a result leaves the range of double; with this policy such tails are 0 or infinite.
using Policy =
    boost::math::policies::policy<boost::math::policies::overflow_error<boost::math::policies::ignore_error>,
                                  boost::math::policies::domain_error<boost::math::policies::ignore_error>,
                                  boost::math::policies::evaluation_error<boost::math::policies::ignore_error>,
                                  boost::math::policies::promote_double<false>>;
using Student = boost::math::students_t_distribution<double, Policy>;
using Normal = boost::math::normal_distribution<double, Policy>;
}  // namespace

double StudentTwoSidedP(double t, double dof) {
    if (!(dof > 0) || std::isnan(t)) return 1;
    if (std::isinf(t)) return 0;
    return std::min(1.0, 2 * boost::math::cdf(Student(std::min(dof, kMaxDof)), -std::abs(t)));
}

double StudentCritical(double p, double dof) {
    if (!(dof > 0) || p <= 0) return std::numeric_limits<double>::infinity();
    if (p >= 1) return 0;
    return std::abs(boost::math::quantile(Student(std::min(dof, kMaxDof)), p / 2));
}

double NormalCritical(double p) {
    if (p >= 1) return 0;
    if (p <= 0) return std::numeric_limits<double>::infinity();
    return std::abs(boost::math::quantile(Normal(), p / 2));
}

double SidakLevel(double level, size_t n) { return -std::expm1(std::log1p(-level) / double(n)); }

double SidakP(double p, size_t n) { return p >= 1 ? 1 : -std::expm1(std::log1p(-p) * double(n)); }

}  // namespace pbrt
