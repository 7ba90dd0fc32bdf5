#include "pbrt/spectra/color_space.h"

#include <algorithm>
#include <cctype>

#include "pbrt/core/error.h"
#include "pbrt/spectra/rgb_primaries.h"
#include "pbrt/spectra/rgb_table.h"

extern "C" {
extern const float pbrt_rgb_table_srgb[];
extern const float pbrt_rgb_table_dci_p3[];
extern const float pbrt_rgb_table_rec2020[];
extern const float pbrt_rgb_table_aces2065_1[];
}

namespace pbrt {

namespace {

constexpr std::array<Float, RgbTableResolution> kScales = RgbTableScales();

const std::vector<ColorSpace> &AllSpaces() {
    static const std::vector<ColorSpace> spaces = [] {
        const float *tables[] = {pbrt_rgb_table_srgb, pbrt_rgb_table_dci_p3, pbrt_rgb_table_rec2020,
                                 pbrt_rgb_table_aces2065_1};
        std::vector<ColorSpace> all;
        for (const RgbPrimaries &p : KnownRgbPrimaries())
            all.emplace_back(p.name, p.r, p.g, p.b, NamedSpectrum(p.illuminant), tables[all.size()]);
        return all;
    }();
    return spaces;
}

/// The cell of the scale axis that holds z. Six steps without branches: z is as good as random.
size_t ScaleCell(Float z) {
    static_assert(RgbTableResolution == 64);
    size_t cell = 0;
    for (size_t step = 32; step > 0; step /= 2)
        cell += kScales[cell + step] <= z ? step : 0;
    return std::min(cell, RgbTableResolution - 2);
}

bool NearlyEqual(const Point2 &a, const Point2 &b) {
    auto near = [](Float x, Float y) { return x == y || std::abs(x - y) < Float(1e-3) * std::abs(y); };
    return near(a.x, b.x) && near(a.y, b.y);
}

}  // namespace

Float SigmoidPolynomial::MaxValue() const {
    Float result = std::max((*this)(LambdaMin), (*this)(LambdaMax));
    Float extremum = -c1 / (2 * c0);
    if (extremum >= LambdaMin && extremum <= LambdaMax) result = std::max(result, (*this)(extremum));
    return result;
}

const ColorSpace *ColorSpace::Find(const std::string &name) {
    auto sameLetter = [](char a, char b) {
        return std::tolower(static_cast<unsigned char>(a)) == std::tolower(static_cast<unsigned char>(b));
    };
    for (const ColorSpace &space : AllSpaces())
        if (std::equal(name.begin(), name.end(), space.Name().begin(), space.Name().end(), sameLetter)) return &space;
    return nullptr;
}

const ColorSpace &ColorSpace::SRGB() { return AllSpaces().front(); }

std::vector<std::string> ColorSpace::Names() {
    std::vector<std::string> names;
    for (const ColorSpace &space : AllSpaces())
        names.push_back(space.Name());
    return names;
}

const ColorSpace *ColorSpace::FromChromaticities(const Point2 &r, const Point2 &g, const Point2 &b, const Point2 &w) {
    for (const ColorSpace &space : AllSpaces())
        if (NearlyEqual(r, space.R()) && NearlyEqual(g, space.G()) && NearlyEqual(b, space.B()) &&
            NearlyEqual(w, space.White()))
            return &space;
    return nullptr;
}

ColorSpace::ColorSpace(std::string name, Point2 r, Point2 g, Point2 b, SpectrumPtr illuminant, const float *table)
    : name_(std::move(name)), r_(r), g_(g), b_(b), illuminant_(std::make_shared<DenseSpectrum>(*illuminant)),
      table_(table) {
    Vector3 white = SpectrumToXyz(*illuminant_);
    w_ = Chromaticity(white);
    xyzFromRgb_ = ComputeXyzFromRgb(r, g, b, white);
    rgbFromXyz_ = glm::mat3(glm::inverse(glm::dmat3(xyzFromRgb_)));
}

SigmoidPolynomial ColorSpace::ToPolynomial(const Rgb &rgb) const {
    PBRT_DCHECK(!std::isnan(rgb.x + rgb.y + rgb.z));
    Rgb c = glm::clamp(rgb, Rgb(0), Rgb(1));
    // Greys are flat: the sigmoid of a constant, solved for it. Infinite for black and white.
    if (c.x == c.y && c.y == c.z) return {0, 0, (c.x - Float(0.5)) / std::sqrt(c.x * (1 - c.x))};

    constexpr int kLast = static_cast<int>(RgbTableResolution) - 1;
    int m = c.x > c.y ? (c.x > c.z ? 0 : 2) : (c.y > c.z ? 1 : 2);
    Float z = c[m], toGrid = static_cast<Float>(kLast) / z;
    Float x = c[(m + 1) % 3] * toGrid, y = c[(m + 2) % 3] * toGrid;

    int xi = std::min(static_cast<int>(x), kLast - 1), yi = std::min(static_cast<int>(y), kLast - 1);
    size_t zi = ScaleCell(z);
    Float dx = x - static_cast<Float>(xi), dy = y - static_cast<Float>(yi);
    Float dz = (z - kScales[zi]) / (kScales[zi + 1] - kScales[zi]);

    constexpr size_t kRow = 3 * RgbTableResolution, kPlane = kRow * RgbTableResolution;
    const float *corner =
        table_ + RgbTableIndex(static_cast<size_t>(m), zi, static_cast<size_t>(yi), static_cast<size_t>(xi));
    auto alongX = [&](const float *p) { return glm::mix(Vector3(p[0], p[1], p[2]), Vector3(p[3], p[4], p[5]), dx); };
    auto plane = [&](const float *p) { return glm::mix(alongX(p), alongX(p + kRow), dy); };
    Vector3 v = glm::mix(plane(corner), plane(corner + kPlane), dz);
    return {v.x, v.y, v.z};
}

glm::mat3 ConvertRgbMatrix(const ColorSpace &from, const ColorSpace &to) {
    if (&from == &to) return glm::mat3(1);
    return to.RgbFromXyz() * from.XyzFromRgb();
}

namespace {
/// The polynomial reaches at most 1, so colours are halved relative to their largest component: smoother fits.
Float UnboundedScale(const Rgb &rgb) { return 2 * std::max({rgb.x, rgb.y, rgb.z}); }
Rgb Unscaled(const Rgb &rgb, Float scale) { return scale != 0 ? rgb / scale : Rgb(0); }
}  // namespace

RgbUnboundedSpectrum::RgbUnboundedSpectrum(const ColorSpace &cs, const Rgb &rgb)
    : scale_(UnboundedScale(rgb)), poly_(cs.ToPolynomial(Unscaled(rgb, scale_))) {}

RgbIlluminantSpectrum::RgbIlluminantSpectrum(const ColorSpace &cs, const Rgb &rgb)
    : scale_(UnboundedScale(rgb)), poly_(cs.ToPolynomial(Unscaled(rgb, scale_))), illuminant_(&cs.Illuminant()) {}

Float SpectrumToPhotometric(const Spectrum &s) {
    if (auto *rgb = dynamic_cast<const RgbIlluminantSpectrum *>(&s)) return InnerProduct(CieY(), rgb->Illuminant());
    return InnerProduct(CieY(), s);
}

}  // namespace pbrt
