#include "pbrt/images/metrics.h"

#include <algorithm>

#include "pbrt/core/error.h"
#include "pbrt/core/parallel.h"

namespace pbrt {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr int kRowsPerTask = 16;
constexpr size_t kMaxExposures = 16;
constexpr double kPixelsPerDegree = 67;  // a 0.69 m wide screen of 3840 pixels viewed from 0.70 m

// 2020, section 4: exponent of the colour difference, knee of its remapping (fraction of the largest difference, and
// the value there), detector width in degrees, exponent of the feature difference.
constexpr double kColorExponent = 0.7, kKnee = 0.4, kKneeValue = 0.95;
constexpr double kFeatureWidth = 0.082, kFeatureExponent = 0.5;

// Contrast sensitivity as a sum of Gaussians a sqrt(pi/b) exp(-pi^2 d^2 / b), d in degrees (2020, table 1).
struct Sensitivity {
    double a, b;
};
constexpr Sensitivity kAchromatic = {1, 0.0047}, kRedGreen = {1, 0.0053};
constexpr Sensitivity kBlueYellow[] = {{34.1, 0.04}, {13.5, 0.025}};
constexpr double kWidestSensitivity = 0.04;

using Plane = std::vector<float>;
using Kernel = std::vector<float>;  // of odd length

// Convolves with `alongX` along x and `alongY` along y, extending border pixels.
Plane Filter(const Plane &in, Point2i size, const Kernel &alongX, const Kernel &alongY) {
    const int width = size.x, height = size.y;
    const int rx = int(alongX.size() / 2), ry = int(alongY.size() / 2);
    auto row = [width](auto *data, int y) { return data + size_t(y) * width; };
    Plane across(in.size()), out(in.size());
    ParallelFor(height, kRowsPerTask, [&](int64_t begin, int64_t end) {
        Plane padded(width + 2 * rx);
        for (int y = int(begin); y < int(end); ++y) {
            const float *from = row(in.data(), y);
            for (int x = 0; x < width + 2 * rx; ++x) padded[x] = from[std::clamp(x - rx, 0, width - 1)];
            float *to = row(across.data(), y);
            for (int k = 0; k <= 2 * rx; ++k)
                for (int x = 0; x < width; ++x) to[x] += alongX[k] * padded[x + k];
        }
    });
    ParallelForEach(height, [&](int64_t y) {
        float *to = row(out.data(), int(y));
        for (int k = -ry; k <= ry; ++k) {
            const float *from = row(across.data(), std::clamp(int(y) + k, 0, height - 1));
            for (int x = 0; x < width; ++x) to[x] += alongY[k + ry] * from[x];
        }
    });
    return out;
}

template <typename F>
Kernel Tabulate(int radius, F f) {
    Kernel kernel;
    for (int x = -radius; x <= radius; ++x) kernel.push_back(float(f(x)));
    return kernel;
}

void Scale(Kernel &kernel, double factor) {
    for (float &w : kernel) w = float(double(w) * factor);
}

// Normalises the positive weights to sum 1 and the negative ones to -1.
void Balance(Kernel &kernel) {
    double positive = 0, negative = 0;
    for (float w : kernel) (w > 0 ? positive : negative) += double(w);
    for (float &w : kernel) w = float(double(w) / (w > 0 ? positive : negative < 0 ? -negative : 1));
}

double Sum(const std::vector<float> &values) { return std::accumulate(values.begin(), values.end(), 0.0); }

// Filters with one Gaussian of a contrast sensitivity, normalised; `mass`: its sum over both axes before.
Plane SensitivityFilter(const Plane &in, Point2i size, const Sensitivity &s, double *mass) {
    const int radius = int(std::ceil(3 * std::sqrt(kWidestSensitivity / (2 * kPi * kPi)) * kPixelsPerDegree));
    Kernel kernel = Tabulate(radius, [&](int x) {
        const double d = x / kPixelsPerDegree;
        return std::exp(-kPi * kPi * d * d / s.b);
    });
    const double sum = Sum(kernel);
    *mass = s.a * std::sqrt(kPi / s.b) * sum * sum;
    Scale(kernel, 1 / sum);
    while (kernel.size() > 1 && kernel.front() < 1e-9f) {
        kernel.erase(kernel.begin());
        kernel.pop_back();
    }
    return Filter(in, size, kernel, kernel);
}

Plane BlueYellowFilter(const Plane &in, Point2i size) {
    double mass[2];
    Plane out = SensitivityFilter(in, size, kBlueYellow[0], &mass[0]);
    const Plane other = SensitivityFilter(in, size, kBlueYellow[1], &mass[1]);
    const auto weight = float(mass[0] / (mass[0] + mass[1]));
    for (size_t i = 0; i < out.size(); ++i) out[i] = weight * out[i] + (1 - weight) * other[i];
    return out;
}

Plane FeatureLength(const Plane &lightness, Point2i size, const Kernel &detector, const Kernel &smooth) {
    Plane alongX = Filter(lightness, size, detector, smooth);
    const Plane alongY = Filter(lightness, size, smooth, detector);
    for (size_t i = 0; i < alongX.size(); ++i) alongX[i] = std::hypot(alongX[i], alongY[i]);
    return alongX;
}

// From linear sRGB to XYZ relative to its white.
glm::mat3 RelativeXyzFromRgb() {
    const ColorSpace &srgb = ColorSpace::SRGB();
    const Xyz white = srgb.ToXyz(Rgb(1, 1, 1));
    glm::mat3 m = srgb.XyzFromRgb();
    for (int column = 0; column < 3; ++column) m[column] = m[column] / white;
    return m;
}

float LabCurve(float t) {
    constexpr float kLimit = 6.f / 29;
    return t > kLimit * kLimit * kLimit ? std::cbrt(t) : t / (3 * kLimit * kLimit) + 4.f / 29;
}

// CIELAB with chroma scaled by lightness (Hunt effect).
void ToHuntLab(const Xyz &c, float *l, float *a, float *b) {
    const float fx = LabCurve(c.x), fy = LabCurve(c.y), fz = LabCurve(c.z);
    *l = 116 * fy - 16;
    *a = 0.01f * *l * 500 * (fx - fy);
    *b = 0.01f * *l * 200 * (fy - fz);
}

// Distance for large colour differences: city block between lightness and chroma (HyAB).
float ColorDistance(float l, float a, float b) { return std::abs(l) + std::hypot(a, b); }

// Rational fit of the ACES tone curve (Narkowicz 2015) including HDR-FLIP's prefactor 0.6: (k0 x^2 + k1 x) / (k2 x^2 +
// k3 x + k4).
constexpr double kTone[] = {0.9036, 0.018, 0.8748, 0.354, 0.14};

float ToneMap(float x) {
    const auto k = [](int i) { return float(kTone[i]); };
    if (!(x > 0)) return 0;
    x = std::min(x, 1e9f);
    return std::clamp((k(0) * x + k(1)) * x / ((k(2) * x + k(3)) * x + k(4)), 0.f, 1.f);
}

double InverseToneMap(double t) {
    const double a = kTone[0] - t * kTone[2], b = kTone[1] - t * kTone[3], c = -t * kTone[4];
    return (-b + std::sqrt(b * b - 4 * a * c)) / (2 * a);
}

// 2021, section 4: exposures that map the largest to the median luminance to 0.85. The median excludes black pixels.
std::vector<double> ChooseExposures(const std::vector<float> &planes) {
    const size_t n = planes.size() / 3;
    const Rgb weights = ColorSpace::SRGB().Luminance();
    std::vector<float> luminance;
    for (size_t i = 0; i < n; ++i) {
        const float y = weights.x * planes[i] + weights.y * planes[n + i] + weights.z * planes[2 * n + i];
        if (y > 0) luminance.push_back(y);
    }
    if (luminance.empty()) return {0};
    auto middle = luminance.begin() + luminance.size() / 2;
    std::nth_element(luminance.begin(), middle, luminance.end());
    const double median = double(*middle);
    const double largest = double(*std::max_element(luminance.begin(), luminance.end()));
    const double shown = InverseToneMap(0.85);
    const double start = std::log2(shown / largest), stop = std::log2(shown / median);
    if (stop <= start) return {start};
    const size_t count = std::clamp(size_t(std::ceil(stop - start)), size_t(2), kMaxExposures);
    std::vector<double> exposures;
    for (size_t i = 0; i < count; ++i) exposures.push_back(start + (stop - start) * double(i) / double(count - 1));
    return exposures;
}

}  // namespace

std::vector<float> FlipReference::Planes(const Image &image) {
    const size_t n = image.ValueCount() / image.ChannelCount();
    std::vector<float> planes(3 * n);
    for (int c = 0; c < 3; ++c) {
        const std::string name(1, "RGB"[c]);
        const int channel = image.FindChannel(name);
        if (channel < 0) throw UserError("FLIP needs the channels R, G and B; {} is missing.", name);
        size_t i = c * n;
        ForEachPixel(image, [&](Point2i p) {
            const float v = image.Get(p, channel);
            planes[i++] = std::isfinite(v) ? v : 0;
        });
    }
    return planes;
}

FlipReference::FlipReference(const Image &reference, bool isHdr) : resolution_(reference.Resolution()) {
    const std::vector<float> planes = Planes(reference);
    if (isHdr) exposures_ = ChooseExposures(planes);
    for (size_t i = 0; i < std::max(exposures_.size(), size_t(1)); ++i) percepts_.push_back(Perceive(planes, i));
    // Green and blue have the largest distance in sRGB.
    const glm::mat3 toXyz = RelativeXyzFromRgb();
    float l[2], a[2], b[2];
    ToHuntLab(toXyz * Rgb(0, 1, 0), &l[0], &a[0], &b[0]);
    ToHuntLab(toXyz * Rgb(0, 0, 1), &l[1], &a[1], &b[1]);
    largestColorDifference_ = std::pow(double(ColorDistance(l[0] - l[1], a[0] - a[1], b[0] - b[1])), kColorExponent);
}

FlipReference::Percept FlipReference::Perceive(const std::vector<float> &planes, size_t exposure) const {
    const size_t n = planes.size() / 3;
    const glm::mat3 toXyz = RelativeXyzFromRgb(), toRgb = glm::inverse(toXyz);
    const bool isHdr = !exposures_.empty();
    const float factor = isHdr ? float(std::exp2(exposures_[exposure])) : 1;
    Plane yy(n), cx(n), cz(n), lightness(n);
    ParallelForEach(n, 4096, [&](int64_t i) {
        Rgb rgb;
        for (int c = 0; c < 3; ++c) {
            const float v = planes[c * n + i];
            rgb[c] = isHdr ? ToneMap(v * factor) : std::clamp(v, 0.f, 1.f);
        }
        // Opponent space of the filters: CIELAB without the cube root.
        const Xyz xyz = toXyz * rgb;
        yy[i] = 116 * xyz.y - 16;
        cx[i] = 500 * (xyz.x - xyz.y);
        cz[i] = 200 * (xyz.y - xyz.z);
        lightness[i] = (yy[i] + 16) / 116;
    });

    Percept out;
    const double sigma = 0.5 * kFeatureWidth * kPixelsPerDegree;
    const int radius = int(std::ceil(3 * sigma));
    auto gaussian = [sigma](int x) { return std::exp(-x * x / (2 * sigma * sigma)); };
    Kernel smooth = Tabulate(radius, gaussian);
    Scale(smooth, 1 / Sum(smooth));
    Kernel first = Tabulate(radius, [&](int x) { return -x * gaussian(x); });
    Kernel second = Tabulate(radius, [&](int x) { return (x * x / (sigma * sigma) - 1) * gaussian(x); });
    Balance(first);
    Balance(second);
    out.edge = FeatureLength(lightness, resolution_, first, smooth);
    out.point = FeatureLength(lightness, resolution_, second, smooth);

    double ignored = 0;
    out.l = SensitivityFilter(yy, resolution_, kAchromatic, &ignored);
    out.a = SensitivityFilter(cx, resolution_, kRedGreen, &ignored);
    out.b = BlueYellowFilter(cz, resolution_);
    ParallelForEach(n, 4096, [&](int64_t i) {
        const float y = (out.l[i] + 16) / 116;
        const Rgb rgb = toRgb * Xyz(y + out.a[i] / 500, y, y - out.b[i] / 200);
        ToHuntLab(toXyz * glm::clamp(rgb, 0.f, 1.f), &out.l[i], &out.a[i], &out.b[i]);
    });
    return out;
}

float FlipReference::Difference(const Percept &r, const Percept &t, size_t i) const {
    const double distance = double(ColorDistance(r.l[i] - t.l[i], r.a[i] - t.a[i], r.b[i] - t.b[i]));
    const double relative = std::pow(distance, kColorExponent) / largestColorDifference_;
    const double color = relative < kKnee ? relative * kKneeValue / kKnee
                                          : kKneeValue + (relative - kKnee) / (1 - kKnee) * (1 - kKneeValue);
    const auto feature = double(std::max(std::abs(r.edge[i] - t.edge[i]), std::abs(r.point[i] - t.point[i])));
    const double structure = std::pow(std::min(feature / std::sqrt(2.0), 1.0), kFeatureExponent);
    return float(std::pow(std::min(color, 1.0), 1 - structure));
}

double FlipReference::Compare(const Image &image, Image *errorImage) const {
    if (image.Resolution() != resolution_)
        throw UserError("Images of different resolution cannot be compared: {} x {} and {} x {}.", image.Resolution().x,
                        image.Resolution().y, resolution_.x, resolution_.y);
    const std::vector<float> planes = Planes(image);
    std::vector<float> flip(planes.size() / 3, 0.f);
    for (size_t e = 0; e < percepts_.size(); ++e) {
        const Percept percept = Perceive(planes, e);
        ParallelForEach(flip.size(), 4096,
                        [&](int64_t i) { flip[i] = std::max(flip[i], Difference(percepts_[e], percept, i)); });
    }
    if (errorImage) {
        *errorImage = Image(PixelFormat::Float, resolution_, {"Y"});
        std::copy(flip.begin(), flip.end(), static_cast<float *>(errorImage->Data()));
    }
    return flip.empty() ? 0 : Sum(flip) / double(flip.size());
}

}  // namespace pbrt
