#include "pbrt/cmd/imgtool/preetham_sky.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace pbrt::imgtool {
namespace {

constexpr double kPi = 3.14159265358979323846;

double Polynomial(const std::array<double, 4> &c, double x) { return ((c[0] * x + c[1]) * x + c[2]) * x + c[3]; }

/// Zenith chromaticity: (turbidity^2, turbidity, 1) times cubic polynomials in the sun's zenith angle.
double Zenith(const std::array<std::array<double, 4>, 3> &m, double turbidity, double theta) {
    return (Polynomial(m[0], theta) * turbidity + Polynomial(m[1], theta)) * turbidity + Polynomial(m[2], theta);
}
constexpr std::array<std::array<double, 4>, 3> kZenithX = {
    {{0.00166, -0.00375, 0.00209, 0}, {-0.02903, 0.06377, -0.03202, 0.00394}, {0.11693, -0.21196, 0.06052, 0.25886}}};
constexpr std::array<std::array<double, 4>, 3> kZenithY = {
    {{0.00275, -0.00610, 0.00317, 0}, {-0.04214, 0.08970, -0.04153, 0.00516}, {0.15346, -0.26756, 0.06670, 0.26688}}};

/// Ozone absorption in 1/cm at 450, 460, ... 780 nm (Chappuis bands; Leckner 1978).
constexpr std::array<double, 34> kOzone = {.003, .006, .009, .014, .021, .030, .040, .048, .063, .075, .085, .103,
                                           .120, .120, .115, .125, .120, .105, .090, .079, .067, .057, .048, .036,
                                           .028, .023, .018, .014, .011, .010, .009, .007, .004, 0};
constexpr double kOzoneColumn = 0.35;  // cm
constexpr double kSunKelvin = 5778;

double Ozone(double lambda) {
    const double x = (lambda - 450) / 10;
    if (!(x > 0 && x < double(kOzone.size() - 1))) return 0;
    const auto i = size_t(x);
    return std::lerp(kOzone[i], kOzone[i + 1], x - std::floor(x));
}

/// Angstrom's turbidity formula; lambda in micrometres.
double AerosolDepth(double turbidity, double lambda) {
    return std::max(0.0, 0.04608 * turbidity - 0.04586) * std::pow(lambda, -1.3);
}

Xyz SunThroughAir(double theta, double turbidity) {
    const double degrees = theta * 180 / kPi;
    const double airMass = 1 / (std::cos(theta) + 0.15 * std::pow(93.885 - degrees, -1.253));
    std::vector<Float> radiance;
    for (Float lambda = LambdaMin; lambda <= LambdaMax; ++lambda) {
        const double um = double(lambda) * 1e-3;
        const double depth =
            0.008735 * std::pow(um, -4.08) + AerosolDepth(turbidity, um) + kOzoneColumn * Ozone(um * 1e3);
        radiance.push_back(Float(double(Blackbody(lambda, Float(kSunKelvin))) * 1e-9 * std::exp(-depth * airMass)));
    }
    return SpectrumToXyz(DenseSpectrum(radiance));
}

}  // namespace

double PreethamSky::Perez::operator()(double cosTheta, double gamma) const {
    const double c2 = std::cos(gamma) * std::cos(gamma);
    return factor * (1 + a * std::exp(b / cosTheta)) * (1 + c * std::exp(d * gamma) + e * c2);
}

PreethamSky::PreethamSky(double elevation, double turbidity, double albedo) {
    const double t = turbidity, theta = (90 - elevation) * kPi / 180;
    sun_ = Vector3(0, Float(std::sin(theta)), Float(std::cos(theta)));
    const double chi = (4.0 / 9 - t / 120) * (kPi - 2 * theta);
    const double luminance = 1000 * ((4.0453 * t - 4.9710) * std::tan(chi) - 0.2155 * t + 2.4192);
    perez_ = {Perez{0.1787 * t - 1.4630, -0.3554 * t + 0.4275, -0.0227 * t + 5.3251, 0.1206 * t - 2.5771,
                    -0.0670 * t + 0.3703, luminance},
              Perez{-0.0193 * t - 0.2592, -0.0665 * t + 0.0008, -0.0004 * t + 0.2125, -0.0641 * t - 0.8989,
                    -0.0033 * t + 0.0452, Zenith(kZenithX, t, theta)},
              Perez{-0.0167 * t - 0.2608, -0.0950 * t + 0.0092, -0.0079 * t + 0.2102, -0.0441 * t - 1.6537,
                    -0.0109 * t + 0.0529, Zenith(kZenithY, t, theta)}};
    for (Perez &p : perez_) p.factor = p.zenith / p(1, theta);
    sunRadiance_ = SunThroughAir(theta, t);

    // Interreflection between ground and sky, as a geometric series.
    const double share = albedo * (0.0685 + 0.16 * (1 - std::exp(-1.66 * AerosolDepth(t, 0.55))));
    const Xyz sky = SkyIrradiance();
    const double solidAngle = 2 * kPi * (1 - std::cos(SunRadius));
    const double all = double(sky.y) + double(sunRadiance_.y) * solidAngle * std::cos(theta);
    returned_ = sky / sky.y * Float(all * share / (1 - share) / kPi);
}

Xyz PreethamSky::Radiance(const Vector3 &w) const {
    if (!(w.z > 0)) return Xyz(0);
    const double gamma = double(AngleBetween(w, sun_)), cosTheta = double(w.z);
    const double luminance = std::max(0.0, perez_[0](cosTheta, gamma)) / CandelasPerY;
    const double x = perez_[1](cosTheta, gamma), y = perez_[2](cosTheta, gamma);
    return returned_ + Xyz(x / y * luminance, luminance, (1 - x - y) / y * luminance);
}

Xyz PreethamSky::SkyIrradiance() const {
    // Midpoints of equal strata of the projected hemisphere.
    constexpr int kSteps = 256;
    glm::dvec3 sum(0);
    for (int i = 0; i < kSteps; ++i)
        for (int j = 0; j < kSteps; ++j) {
            const double sin2 = (i + 0.5) / kSteps, phi = 2 * kPi * (j + 0.5) / kSteps, r = std::sqrt(sin2);
            sum += glm::dvec3(Radiance(Vector3(r * std::cos(phi), r * std::sin(phi), std::sqrt(1 - sin2))));
        }
    return Xyz(sum * (kPi / (kSteps * kSteps)));
}

}  // namespace pbrt::imgtool
