#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "pbrt/math/vec.h"

namespace pbrt {

inline constexpr Float LambdaMin = 360;  ///< nm
inline constexpr Float LambdaMax = 830;  ///< nm
inline constexpr int SpectrumSamples = 4;

/// Values at the wavelengths of a SampledWavelengths.
class SampledSpectrum {
  public:
    SampledSpectrum() : v_{} {}
    explicit SampledSpectrum(Float c) { v_.fill(c); }
    Float operator[](int i) const { return v_[i]; }
    Float &operator[](int i) { return v_[i]; }

    SampledSpectrum &operator+=(const SampledSpectrum &o) { return Zip(o, std::plus()); }
    SampledSpectrum &operator-=(const SampledSpectrum &o) { return Zip(o, std::minus()); }
    SampledSpectrum &operator*=(const SampledSpectrum &o) { return Zip(o, std::multiplies()); }
    SampledSpectrum &operator/=(const SampledSpectrum &o) { return Zip(o, std::divides()); }
    SampledSpectrum &operator*=(Float s) {
        for (Float &v : v_) v *= s;
        return *this;
    }
    SampledSpectrum &operator/=(Float s) { return *this *= 1 / s; }
    friend SampledSpectrum operator+(SampledSpectrum a, const SampledSpectrum &b) { return a += b; }
    friend SampledSpectrum operator-(SampledSpectrum a, const SampledSpectrum &b) { return a -= b; }
    friend SampledSpectrum operator*(SampledSpectrum a, const SampledSpectrum &b) { return a *= b; }
    friend SampledSpectrum operator/(SampledSpectrum a, const SampledSpectrum &b) { return a /= b; }
    friend SampledSpectrum operator*(SampledSpectrum a, Float s) { return a *= s; }
    friend SampledSpectrum operator*(Float s, SampledSpectrum a) { return a *= s; }
    friend SampledSpectrum operator/(SampledSpectrum a, Float s) { return a /= s; }
    SampledSpectrum operator-() const { return *this * Float(-1); }

    explicit operator bool() const {  ///< true if any value is not 0
        for (Float v : v_)
            if (v != 0) return true;
        return false;
    }
    Float Average() const { return (v_[0] + v_[1] + v_[2] + v_[3]) / SpectrumSamples; }
    Float MaxComponent() const { return std::max(std::max(v_[0], v_[1]), std::max(v_[2], v_[3])); }
    Float MinComponent() const { return std::min(std::min(v_[0], v_[1]), std::min(v_[2], v_[3])); }
    /// f(i) at wavelength i.
    static SampledSpectrum Of(auto f) {
        SampledSpectrum r;
        for (int i = 0; i < SpectrumSamples; ++i) r[i] = f(i);
        return r;
    }
    SampledSpectrum Map(auto f) const {
        return Of([&](int i) { return f((*this)[i]); });
    }

  private:
    SampledSpectrum &Zip(const SampledSpectrum &o, auto f) {
        for (size_t i = 0; i < SpectrumSamples; ++i) v_[i] = f(v_[i], o.v_[i]);
        return *this;
    }
    std::array<Float, SpectrumSamples> v_;
};

/// Root mean square, without overflow or underflow.
inline double RootMeanSquare(const SampledSpectrum &s) {
    double sum = 0;
    for (int i = 0; i < SpectrumSamples; ++i) sum += double(s[i]) * double(s[i]);
    return std::sqrt(sum / SpectrumSamples);
}
/// a/b where b != 0, else 0.
inline SampledSpectrum SafeDivide(const SampledSpectrum &a, const SampledSpectrum &b) {
    return SampledSpectrum::Of([&](int i) { return b[i] != 0 ? a[i] / b[i] : 0; });
}
inline SampledSpectrum Clamp(const SampledSpectrum &s, Float low, Float high) {
    return s.Map([=](Float v) { return std::clamp(v, low, high); });
}
inline SampledSpectrum ClampZero(const SampledSpectrum &s) {
    return s.Map([](Float v) { return std::max(Float(0), v); });
}

/// The wavelengths of one path (nm) and their densities (1/nm).
class SampledWavelengths {
  public:
    /// Stratified wavelengths with density proportional to 1/cosh^2(0.0072 (lambda - 538)), as in stock pbrt-v4.
    static SampledWavelengths SampleVisible(Float u);
    static SampledWavelengths SampleUniform(Float u, Float low = LambdaMin, Float high = LambdaMax);
    /// Proxy for all wavelengths, used for light importance in light samplers. A light's emission there is its root
    /// mean square over the visible range by the density of SampleVisible; not the mean, because errors are squared per
    /// wavelength. Positive if the light emits anywhere. Other spectra are evaluated at SampleVisible(0.5).
    static const SampledWavelengths &WholeRange();
    bool IsWholeRange() const { return isWholeRange_; }

    Float operator[](int i) const { return lambda_[i]; }
    Float PdfAt(int i) const { return pdf_[i]; }
    SampledSpectrum Pdf() const {
        return SampledSpectrum::Of([&](int i) { return PdfAt(i); });
    }
    /// Keeps only the first wavelength (dispersion); divides its density by the number of wavelengths.
    void TerminateSecondary();
    bool SecondaryTerminated() const;

  private:
    std::array<Float, SpectrumSamples> lambda_{}, pdf_{};
    bool isWholeRange_ = false;
};

/// Function of wavelength. Immutable and thread-safe. Sample() is the hot call.
class Spectrum {
  public:
    virtual ~Spectrum() = default;
    virtual Float operator()(Float lambda) const = 0;  ///< at lambda nm
    virtual SampledSpectrum Sample(const SampledWavelengths &lambda) const;
    virtual Float MaxValue() const = 0;
    /// True if independent of wavelength (no dispersion for an index of refraction).
    virtual bool IsConstant() const { return false; }
};
using SpectrumPtr = std::shared_ptr<const Spectrum>;

class ConstantSpectrum final : public Spectrum {
  public:
    explicit ConstantSpectrum(Float c) : c_(c) {}
    Float operator()(Float) const override { return c_; }
    SampledSpectrum Sample(const SampledWavelengths &) const override { return SampledSpectrum(c_); }
    Float MaxValue() const override { return c_; }
    bool IsConstant() const override { return true; }

  private:
    Float c_;
};

/// One value per nm from 360 to 830, nearest-nm lookup. Representation of light emission.
class DenseSpectrum final : public Spectrum {
  public:
    explicit DenseSpectrum(const Spectrum &s);
    /// 471 values.
    explicit DenseSpectrum(std::span<const Float> values);
    Float operator()(Float lambda) const override;
    SampledSpectrum Sample(const SampledWavelengths &lambda) const override;
    Float MaxValue() const override { return max_; }

  private:
    void Summarise();
    std::vector<Float> values_;
    Float max_ = 0;
    Float rootMeanSquare_ = 0;  ///< at SampledWavelengths::WholeRange()
};

/// Linear interpolation of (lambda, value) pairs, lambda strictly increasing; 0 outside.
class PiecewiseLinearSpectrum final : public Spectrum {
  public:
    PiecewiseLinearSpectrum(std::vector<Float> lambdas, std::vector<Float> values);
    Float operator()(Float lambda) const override;
    Float MaxValue() const override;

  private:
    std::vector<Float> lambdas_, values_;
    std::vector<uint32_t> startOfNm_;  ///< per nm of 360-830: last sample not beyond it, the start of the search
};

/// Planck emission at T kelvin, normalised to peak 1 (Wien).
class BlackbodySpectrum final : public Spectrum {
  public:
    explicit BlackbodySpectrum(Float kelvin);
    Float operator()(Float lambda) const override;
    Float MaxValue() const override { return 1; }

  private:
    Float kelvin_, normalization_;
};

/// Planck's law: spectral radiance at lambda nm and T kelvin, W / (m^2 sr m).
Float Blackbody(Float lambda, Float kelvin);

/// CIE 1931 2-degree matching functions.
const DenseSpectrum &CieX();
const DenseSpectrum &CieY();
const DenseSpectrum &CieZ();
/// Integral of y-bar over 360-830 nm (the usual 106.857).
inline constexpr Float CieYIntegral = 106.856895f;

/// Sum of a*b over whole nanometres, 360-830 nm.
Float InnerProduct(const Spectrum &a, const Spectrum &b);
/// XYZ of an emission spectrum, divided by CieYIntegral.
Vector3 SpectrumToXyz(const Spectrum &s);
/// Integral of y-bar times s, the divisor of light spectra (pbrt-v4-format §9). For an RgbIlluminantSpectrum, s is only
/// its illuminant, without the RGB factor.
Float SpectrumToPhotometric(const Spectrum &s);

// Tables of data/*.csv, embedded into the binary and parsed at first use.

/// Spectrum of §16 by name ("glass-BK7", "metal-Ag-eta", "stdillum-D65", "nikon_d850_r", ...); nullptr if unknown.
/// Illuminants are scaled to SpectrumToXyz().y == 1.
SpectrumPtr NamedSpectrum(const std::string &name);
std::vector<std::string> NamedSpectrumNames();
/// Cameras of §16. Channel responses are the named spectra SENSOR_r, SENSOR_g and SENSOR_b.
std::vector<std::string> CameraSensorNames();
const std::vector<SpectrumPtr> &ColorCheckerReflectances();

struct ScatteringPreset {
    std::string name;
    std::array<Float, 3> reducedScattering, absorption;  ///< 1/mm, linear sRGB
};
/// Media of pbrt-v4-format §16, in the order of the file.
const std::vector<ScatteringPreset> &EmbeddedScatteringPresets();

struct ThreeColumnTable {
    std::vector<Float> lambdas;  ///< nm
    std::array<std::vector<Float>, 3> columns;
};
/// Components of CIE daylight.
const ThreeColumnTable &EmbeddedDaylight();

}  // namespace pbrt
