#include "pbrt/spectra/spectrum.h"

#include <algorithm>

#include "pbrt/core/error.h"

namespace pbrt {
namespace {

constexpr int kFirstNm = 360, kLastNm = 830;
constexpr size_t kNmCount = kLastNm - kFirstNm + 1;

// Fit to the eye's sensitivity, truncated to the visible range: density kPeak / cosh^2((lambda - kMid) / kWidth).
constexpr Float kPeak = 0.0039398042f, kMid = 538, kWidth = 138.888889f;
constexpr Float kTanhAtMin = 0.85691062f, kTanhSpan = 1.82750197f;

/// Values are at whole nanometres; 0 outside 360-830 nm.
inline Float Nearest(const Float *values, Float lambda) {
    auto i = unsigned(int(lambda + Float(0.5)) - kFirstNm);
    return i < kNmCount ? values[i] : 0;
}

}  // namespace

SampledWavelengths SampledWavelengths::SampleVisible(Float u) {
    SampledWavelengths s;
    for (size_t i = 0; i < SpectrumSamples; ++i) {
        Float ui = u + Float(i) / SpectrumSamples;
        if (ui > 1) ui -= 1;
        Float t = kTanhAtMin - kTanhSpan * ui;
        // Clamped, because the rounded constants reach 830.04 nm for u near 1.
        s.lambda_[i] = std::clamp(kMid - kWidth / 2 * std::log((1 + t) / (1 - t)), LambdaMin, LambdaMax);  // atanh t
        s.pdf_[i] = kPeak * (1 - t * t);  // 1/cosh^2(atanh t) = 1 - t^2
    }
    return s;
}

SampledWavelengths SampledWavelengths::SampleUniform(Float u, Float low, Float high) {
    const Float range = high - low;
    SampledWavelengths s;
    for (size_t i = 0; i < SpectrumSamples; ++i) {
        Float ui = u + Float(i) / SpectrumSamples;
        if (ui > 1) ui -= 1;
        s.lambda_[i] = low + ui * range;
        s.pdf_[i] = 1 / range;
    }
    return s;
}

const SampledWavelengths &SampledWavelengths::WholeRange() {
    static const SampledWavelengths range = [] {
        SampledWavelengths s = SampleVisible(Float(0.5));
        s.isWholeRange_ = true;
        return s;
    }();
    return range;
}

void SampledWavelengths::TerminateSecondary() {
    if (SecondaryTerminated()) return;
    for (size_t i = 1; i < SpectrumSamples; ++i) pdf_[i] = 0;
    pdf_[0] /= SpectrumSamples;
}

bool SampledWavelengths::SecondaryTerminated() const {
    return std::all_of(pdf_.begin() + 1, pdf_.end(), [](Float p) { return p == 0; });
}

SampledSpectrum Spectrum::Sample(const SampledWavelengths &lambda) const {
    return SampledSpectrum::Of([&](int i) { return (*this)(lambda[i]); });
}

DenseSpectrum::DenseSpectrum(const Spectrum &s) : values_(kNmCount) {
    for (size_t i = 0; i < kNmCount; ++i) values_[i] = s(Float(kFirstNm + int(i)));
    Summarise();
}

DenseSpectrum::DenseSpectrum(std::span<const Float> values) : values_(values.begin(), values.end()) {
    PBRT_CHECK_MSG(values.size() == kNmCount, "{} values, {} required", values.size(), kNmCount);
    Summarise();
}

void DenseSpectrum::Summarise() {
    static const std::vector<double> weights = [] {  // of the density of SampleVisible
        std::vector<double> weight(kNmCount);
        double sum = 0;
        for (size_t i = 0; i < kNmCount; ++i) {
            const double x = (kFirstNm + int(i) - double(kMid)) / double(kWidth);
            sum += weight[i] = 1 / (std::cosh(x) * std::cosh(x));
        }
        for (double &w : weight) w /= sum;
        return weight;
    }();
    max_ = *std::max_element(values_.begin(), values_.end());
    double square = 0;
    for (size_t i = 0; i < kNmCount; ++i) square += weights[i] * double(values_[i]) * double(values_[i]);
    rootMeanSquare_ = Float(std::sqrt(square));
}

Float DenseSpectrum::operator()(Float lambda) const { return Nearest(values_.data(), lambda); }

SampledSpectrum DenseSpectrum::Sample(const SampledWavelengths &lambda) const {
    if (lambda.IsWholeRange()) [[unlikely]]
        return SampledSpectrum(rootMeanSquare_);
    const Float *values = values_.data();
    return SampledSpectrum::Of([&](int i) { return Nearest(values, lambda[i]); });
}

PiecewiseLinearSpectrum::PiecewiseLinearSpectrum(std::vector<Float> lambdas, std::vector<Float> values)
    : lambdas_(std::move(lambdas)), values_(std::move(values)), startOfNm_(kNmCount) {
    PBRT_CHECK(!lambdas_.empty() && lambdas_.size() == values_.size());
    for (size_t i = 1; i < lambdas_.size(); ++i)
        PBRT_CHECK_MSG(lambdas_[i - 1] < lambdas_[i], "{} nm is followed by {} nm", lambdas_[i - 1], lambdas_[i]);
    uint32_t start = 0;
    for (size_t nm = 0; nm < kNmCount; ++nm) {
        auto lambda = Float(kFirstNm + int(nm));
        while (start + 1 < lambdas_.size() && lambdas_[start + 1] <= lambda) ++start;
        startOfNm_[nm] = start;
    }
}

Float PiecewiseLinearSpectrum::operator()(Float lambda) const {
    if (!(lambda >= lambdas_.front() && lambda <= lambdas_.back())) return 0;
    auto nm = unsigned(int(lambda) - kFirstNm);
    size_t i = nm < kNmCount
                   ? startOfNm_[nm]
                   : size_t(std::upper_bound(lambdas_.begin(), lambdas_.end(), lambda) - lambdas_.begin()) - 1;
    while (i + 1 < lambdas_.size() && lambdas_[i + 1] <= lambda) ++i;
    if (i + 1 == lambdas_.size()) return values_.back();
    Float t = (lambda - lambdas_[i]) / (lambdas_[i + 1] - lambdas_[i]);
    return Lerp(t, values_[i], values_[i + 1]);
}

Float PiecewiseLinearSpectrum::MaxValue() const { return *std::max_element(values_.begin(), values_.end()); }

Float Blackbody(Float lambda, Float kelvin) {
    if (!(kelvin > 0)) return 0;
    constexpr double c = 299792458, h = 6.62606957e-34, kB = 1.3806488e-23;
    constexpr auto kFirst = Float(2 * h * c * c), kSecond = Float(h * c / kB);
    Float l = lambda * 1e-9f, l2 = l * l;
    return kFirst / (l2 * l2 * l * std::expm1(kSecond / (l * kelvin)));
}

BlackbodySpectrum::BlackbodySpectrum(Float kelvin) : kelvin_(kelvin) {
    constexpr Float kWien = 2.8977721e-3f;  // m K
    Float peak = Blackbody(kWien / kelvin * 1e9f, kelvin);
    normalization_ = peak > 0 ? 1 / peak : 0;
}

Float BlackbodySpectrum::operator()(Float lambda) const { return Blackbody(lambda, kelvin_) * normalization_; }

Float InnerProduct(const Spectrum &a, const Spectrum &b) {
    double sum = 0;
    for (int nm = kFirstNm; nm <= kLastNm; ++nm) {
        auto lambda = Float(nm);
        sum += double(a(lambda)) * double(b(lambda));
    }
    return Float(sum);
}

Vector3 SpectrumToXyz(const Spectrum &s) {
    return Vector3(InnerProduct(CieX(), s), InnerProduct(CieY(), s), InnerProduct(CieZ(), s)) / CieYIntegral;
}

}  // namespace pbrt
