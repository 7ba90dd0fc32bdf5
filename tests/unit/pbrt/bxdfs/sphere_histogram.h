#pragma once
#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <vector>

#include "pbrt/bxdfs/bxdf.h"
#include "pbrt/math/frame.h"
#include "pbrt/math/rng.h"
#include "support/statistics.h"

namespace pbrt::test {

/// Counts of directions over a grid of theta x phi. The rows are equal in theta, not in cos theta, so that a narrow
/// lobe about the normal spreads over several cells.
class SphereHistogram {
  public:
    SphereHistogram(int nTheta, int nPhi) : nTheta_(nTheta), nPhi_(nPhi), counts_(size_t(nTheta * nPhi)) {}

    void Add(const Vector3 &w, double weight = 1) {
        double theta = std::atan2(std::hypot(double(w.x), double(w.y)), double(w.z)) / M_PI;
        double phi = std::atan2(double(w.y), double(w.x)) / (2 * M_PI);
        if (phi < 0) phi += 1;
        int i = std::min(int(theta * nTheta_), nTheta_ - 1);
        int j = std::min(int(phi * nPhi_), nPhi_ - 1);
        counts_[size_t(i * nPhi_ + j)] += weight;
    }
    const std::vector<double> &Counts() const { return counts_; }

    /// The integral of a function of direction over every cell, by the midpoint rule with n x n points per cell.
    template <class F>
    std::vector<double> Integrate(F f, int n) const {
        std::vector<double> cells(counts_.size());
        for (size_t cell = 0; cell < cells.size(); ++cell) cells[cell] = IntegrateCell(f, n, int(cell));
        return cells;
    }

    /// Like Integrate with n; cells with more than 1/400 of the whole are integrated again with `fine`.
    template <class F>
    std::vector<double> IntegratePeaks(F f, int n, int fine) const {
        std::vector<double> cells = Integrate(f, n);
        const double few = std::accumulate(cells.begin(), cells.end(), 0.0) / 400;
        for (size_t cell = 0; cell < cells.size(); ++cell)
            if (cells[cell] > few) cells[cell] = IntegrateCell(f, fine, int(cell));
        return cells;
    }

  private:
    template <class F>
    double IntegrateCell(F f, int n, int cell) const {
        double dTheta = M_PI / (nTheta_ * n), dPhi = 2 * M_PI / (nPhi_ * n), sum = 0;
        for (int i = cell / nPhi_ * n, endI = i + n; i < endI; ++i) {
            double theta = (i + 0.5) * dTheta, s = std::sin(theta), c = std::cos(theta), ring = 0;
            for (int j = cell % nPhi_ * n, endJ = j + n; j < endJ; ++j) {
                double phi = (j + 0.5) * dPhi;
                ring += double(f(Vector3(s * std::cos(phi), s * std::sin(phi), c)));
            }
            sum += ring * (std::cos(i * dTheta) - std::cos((i + 1) * dTheta)) * dPhi;
        }
        return sum;
    }

    int nTheta_, nPhi_;
    std::vector<double> counts_;
};

/// The integral of f(w) over the sphere, with n x n points in each of 400 cells.
template <class F>
double SphereIntegral(F f, int n) {
    const std::vector<double> cells = SphereHistogram(20, 20).Integrate(f, n);
    return std::accumulate(cells.begin(), cells.end(), 0.0);
}

/// A sample by the next numbers of `rng`.
template <class Lobe, class... Options>
std::optional<BsdfSample> SampleLobe(const Lobe &lobe, const Vector3 &wo, Rng &rng, Options... options) {
    const Float uc = rng.Uniform();
    return lobe.Sample(wo, uc, rng.Uniform2(), options...);
}
inline std::optional<Vector3> DirectionOf(const std::optional<BsdfSample> &s) {
    return s ? std::optional(s->wi) : std::nullopt;
}
/// f cos / pdf at the first wavelength.
inline double WeightOf(const BsdfSample &s) { return double(s.f[0] * AbsCosTheta(s.wi) / s.pdf); }

/// p-value of the hypothesis that `draw(Rng &)`, which returns an optional direction, has the density `pdf(w)`; the
/// share of calls without a direction must be the mass that pdf lacks. `mass` (may be null) gets the integral of pdf.
/// `fine`: points per side of a cell with a peak.
template <class Draw, class Pdf>
double DirectionTest(Draw draw, Pdf pdf, int samples, int quadrature, double *mass, int fine = 0) {
    SphereHistogram histogram(20, 20);
    Rng rng(12345);
    double lost = 0;
    for (int s = 0; s < samples; ++s) {
        std::optional<Vector3> w = draw(rng);
        if (w) histogram.Add(*w);
        else ++lost;
    }
    std::vector<double> observed = histogram.Counts();
    std::vector<double> expected =
        fine ? histogram.IntegratePeaks(pdf, quadrature, fine) : histogram.Integrate(pdf, quadrature);
    double sum = 0;
    for (double &e : expected) {
        sum += e;
        e *= samples;
    }
    if (mass) *mass = sum;
    observed.push_back(lost);
    expected.push_back(std::max(0.0, samples - sum * samples));
    // The quadrature is not exact: cells of tiny expected counts are pooled with the calls without a direction.
    for (size_t i = 0; i + 1 < expected.size(); ++i) {
        if (expected[i] >= 5) continue;
        observed.back() += observed[i];
        expected.back() += expected[i];
        observed[i] = expected[i] = 0;
    }
    return ChiSquareTest(observed, expected);
}

constexpr TransportMode kRadiance = TransportMode::Radiance;

inline SampledSpectrum Values(Float a, Float b, Float c, Float d) {
    SampledSpectrum s;
    s[0] = a, s[1] = b, s[2] = c, s[3] = d;
    return s;
}

inline Vector3 DirectionAt(Float thetaDegrees, Float phiDegrees) {
    Float t = Radians(thetaDegrees);
    return SphericalDirection(std::sin(t), std::cos(t), Radians(phiDegrees));
}

}  // namespace pbrt::test
