#pragma once
#include <array>

#include "pbrt/math/vec.h"
#include "pbrt/spectra/color_space.h"

namespace pbrt::imgtool {

/// Daylight after Preetham, Shirley and Smits, "A Practical Analytic Model for Daylight" (SIGGRAPH 1999): the sky's
/// luminance and chromaticity by Perez' formula with the coefficients of its appendix A.2; the sun's light through
/// Rayleigh scattering, aerosols and ozone of its appendix A.1. Departures: the sun above the atmosphere is a black
/// body of 5778 K (that gives the solar constant), the weak bands of oxygen and water vapour are left out; ground of an
/// albedo above 0 sends light up, of which the sky returns a part evenly (Bird and Hulstrom 1981, "A Simplified Clear
/// Sky Model"). XYZ are those of a spectrum in W / (m^2 sr nm), divided by CieYIntegral, so that luminance is
/// CandelasPerY * Y.
class PreethamSky {
  public:
    static constexpr double CandelasPerY = 683 * 106.856895;  ///< cd/m^2
    static constexpr double SunRadius = 0.004651;             ///< radians, at the mean distance

    /// Elevation of the sun above the horizon in degrees, [0, 90]; turbidity 2 (clear) to 10 (haze); albedo [0, 1].
    PreethamSky(double elevation, double turbidity, double albedo);

    /// Unit vector; z up, the sun in the half plane of +y.
    const Vector3 &SunDirection() const { return sun_; }
    /// Radiance of the sky without the sun's disc; 0 below the horizon.
    Xyz Radiance(const Vector3 &w) const;
    /// Mean radiance over the sun's disc.
    const Xyz &SunRadiance() const { return sunRadiance_; }
    /// Irradiance of a horizontal surface by Radiance().
    Xyz SkyIrradiance() const;

  private:
    /// Perez' formula for one of Y, x, y.
    struct Perez {
        double a, b, c, d, e, zenith;
        double operator()(double cosTheta, double gamma) const;
        double factor = 1;  ///< scales the formula to `zenith` at the zenith
    };

    Vector3 sun_;
    std::array<Perez, 3> perez_;  ///< Y in cd/m^2, x, y
    Xyz sunRadiance_, returned_{0};
};

}  // namespace pbrt::imgtool
