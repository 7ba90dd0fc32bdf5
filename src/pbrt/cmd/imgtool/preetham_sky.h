#pragma once
#include <array>

#include "pbrt/math/vec.h"
#include "pbrt/spectra/color_space.h"

namespace pbrt::imgtool {

/// Daylight after Preetham, Shirley and Smits, "A Practical Analytic Model for Daylight" (SIGGRAPH 1999). Sky luminance
/// and chromaticity: Perez' formula with the coefficients of appendix A.2. Sunlight: Rayleigh scattering, aerosols and
/// ozone of appendix A.1.
///
/// Departures: the sun above the atmosphere is a black body of 5778 K, which gives the solar constant; the weak bands
/// of oxygen and water vapour are omitted. Ground of albedo above 0 reflects light, part of which the sky returns
/// uniformly (Bird and Hulstrom 1981, "A Simplified Clear Sky Model").
///
/// XYZ are those of a spectrum in W / (m^2 sr nm), divided by CieYIntegral, so luminance is CandelasPerY * Y.
class PreethamSky {
  public:
    static constexpr double CandelasPerY = 683 * 106.856895;  ///< cd/m^2
    static constexpr double SunRadius = 0.004651;             ///< radians, at mean distance

    /// Solar elevation in degrees, [0, 90]; turbidity 2 (clear) to 10 (haze); albedo [0, 1].
    PreethamSky(double elevation, double turbidity, double albedo);

    /// Unit vector; z up, the sun in the half-plane of +y.
    const Vector3 &SunDirection() const { return sun_; }
    /// Radiance of the sky excluding the sun's disc; 0 below the horizon.
    Xyz Radiance(const Vector3 &w) const;
    /// Mean radiance of the sun's disc.
    const Xyz &SunRadiance() const { return sunRadiance_; }
    /// Irradiance of a horizontal surface by Radiance().
    Xyz SkyIrradiance() const;

  private:
    struct Perez {
        double a, b, c, d, e, zenith;
        double operator()(double cosTheta, double gamma) const;
        double factor = 1;  ///< scales the formula to the zenith value
    };

    Vector3 sun_;
    std::array<Perez, 3> perez_;  ///< Y in cd/m^2, x, y
    Xyz sunRadiance_, returned_{0};
};

}  // namespace pbrt::imgtool
