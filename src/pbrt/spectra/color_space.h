#pragma once
#include <string>
#include <vector>

#include "pbrt/spectra/spectrum.h"

namespace pbrt {

using Rgb = glm::vec3;
using Xyz = glm::vec3;

/// Sigmoid of a quadratic in wavelength, the reflectance of an RGB colour (Jakob and Hanika 2019): s(c0 l^2 + c1 l +
/// c2), s(x) = 1/2 + x / (2 sqrt(1 + x^2)).
struct SigmoidPolynomial {
    Float c0 = 0, c1 = 0, c2 = 0;
    Float operator()(Float lambda) const {
        // Changes no value; avoids NaN from infinite coefficients (black, white).
        Float x = std::clamp((c0 * lambda + c1) * lambda + c2, Float(-1e18), Float(1e18));
        return Float(0.5) + x / (2 * std::sqrt(1 + x * x));
    }
    SampledSpectrum Sample(const SampledWavelengths &lambda) const {
        return SampledSpectrum::Of([&](int i) { return (*this)(lambda[i]); });
    }
    Float MaxValue() const;
};

/// RGB colour space: primaries, white, illuminant, matrices, and the RGB-to-sigmoid table.
class ColorSpace {
  public:
    /// By case-insensitive name: srgb, dci-p3, rec2020, aces2065-1. nullptr if unknown. Static lifetime.
    static const ColorSpace *Find(const std::string &name);
    static const ColorSpace &SRGB();
    static std::vector<std::string> Names();
    /// Known space with these chromaticities (relative tolerance 1e-3), else nullptr. Order r, g, b, white.
    static const ColorSpace *FromChromaticities(const Point2 &r, const Point2 &g, const Point2 &b, const Point2 &w);

    const std::string &Name() const { return name_; }
    const Spectrum &Illuminant() const { return *illuminant_; }
    SpectrumPtr IlluminantPtr() const { return illuminant_; }
    const glm::mat3 &XyzFromRgb() const { return xyzFromRgb_; }
    const glm::mat3 &RgbFromXyz() const { return rgbFromXyz_; }
    Rgb ToRgb(const Xyz &xyz) const { return rgbFromXyz_ * xyz; }
    Xyz ToXyz(const Rgb &rgb) const { return xyzFromRgb_ * rgb; }
    Rgb Luminance() const { return {xyzFromRgb_[0].y, xyzFromRgb_[1].y, xyzFromRgb_[2].y}; }
    Point2 R() const { return r_; }
    Point2 G() const { return g_; }
    Point2 B() const { return b_; }
    Point2 White() const { return w_; }

    /// Reflectance of an RGB in [0, 1]^3. Other components are clamped, NaN counts as 0.
    SigmoidPolynomial ToPolynomial(const Rgb &rgb) const;

    /// For the list of known spaces; others use Find(). `table`: embedded at build time, layout in rgb_primaries.h.
    ColorSpace(std::string name, Point2 r, Point2 g, Point2 b, SpectrumPtr illuminant, const float *table);

  private:
    std::string name_;
    Point2 r_, g_, b_, w_;
    SpectrumPtr illuminant_;
    glm::mat3 xyzFromRgb_, rgbFromXyz_;
    const float *table_;
};

/// Matrix from RGB of `from` to RGB of `to` through XYZ, without chromatic adaptation.
glm::mat3 ConvertRgbMatrix(const ColorSpace &from, const ColorSpace &to);

/// RGB uplifted to a spectrum by use (pbrt-v4-format §4), without allocation. Values are finite and >= 0: negative
/// components and NaN count as 0; others are clamped to 1 (albedo) or 1e37.
class RgbAlbedoSpectrum final : public Spectrum {
  public:
    RgbAlbedoSpectrum(const ColorSpace &cs, const Rgb &rgb) : poly_(cs.ToPolynomial(rgb)) {}
    Float operator()(Float lambda) const override { return poly_(lambda); }
    SampledSpectrum Sample(const SampledWavelengths &lambda) const override { return poly_.Sample(lambda); }
    Float MaxValue() const override { return poly_.MaxValue(); }

  private:
    SigmoidPolynomial poly_;
};

/// An RGB colour of any brightness as a multiple of a sigmoid polynomial.
struct ScaledPolynomial {
    Float scale = 0;
    SigmoidPolynomial poly;
    static ScaledPolynomial Of(const ColorSpace &cs, const Rgb &rgb);
    SampledSpectrum Sample(const SampledWavelengths &lambda) const { return scale * poly.Sample(lambda); }
};

class RgbUnboundedSpectrum final : public Spectrum {
  public:
    RgbUnboundedSpectrum(const ColorSpace &cs, const Rgb &rgb) : rgb_(ScaledPolynomial::Of(cs, rgb)) {}
    Float operator()(Float lambda) const override { return rgb_.scale * rgb_.poly(lambda); }
    SampledSpectrum Sample(const SampledWavelengths &lambda) const override { return rgb_.Sample(lambda); }
    Float MaxValue() const override { return rgb_.scale * rgb_.poly.MaxValue(); }

  private:
    ScaledPolynomial rgb_;
};

class RgbIlluminantSpectrum final : public Spectrum {
  public:
    RgbIlluminantSpectrum(const ColorSpace &cs, const Rgb &rgb) : rgb_(cs, rgb), illuminant_(&cs.Illuminant()) {}
    Float operator()(Float lambda) const override { return rgb_(lambda) * (*illuminant_)(lambda); }
    SampledSpectrum Sample(const SampledWavelengths &lambda) const override {
        return rgb_.Sample(lambda) * illuminant_->Sample(lambda);
    }
    Float MaxValue() const override { return rgb_.MaxValue() * illuminant_->MaxValue(); }
    const Spectrum &Illuminant() const { return *illuminant_; }

  private:
    RgbUnboundedSpectrum rgb_;
    const Spectrum *illuminant_;  ///< of the colour space, static lifetime
};

/// Von Kries adaptation in Bradford cone space: XYZ under white `from` to XYZ under white `to` (chromaticities).
glm::mat3 WhiteBalanceMatrix(const Point2 &from, const Point2 &to);
/// CIE D illuminant of a correlated colour temperature, scaled to Y = 1.
DenseSpectrum DaylightSpectrum(Float kelvin);

}  // namespace pbrt
