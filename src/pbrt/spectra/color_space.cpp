#include "pbrt/spectra/color_space.h"

#include <algorithm>
#include <cstring>
#include <limits>

#include "pbrt/core/error.h"
#include "pbrt/core/files.h"
#include "pbrt/spectra/rgb_primaries.h"

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

/// Position on a table axis: `fraction` of the way from `node` to the next one.
struct AxisPlace {
    size_t node;
    Float fraction;
};

AxisPlace PlaceOfRatio(Float ratio) {
    Float nodes = ratio * Float(RgbTableResolution - 1);
    size_t node = std::min(size_t(nodes), RgbTableResolution - 2);
    return {node, nodes - Float(node)};
}

/// `scale` in [0, 1], on the nodes of RgbTableScales. Branchless binary search in six steps.
AxisPlace PlaceOfScale(Float scale) {
    static_assert(RgbTableResolution == 64);
    size_t node = 0;
    for (size_t step = 32; step > 0; step /= 2) node += kScales[node + step] <= scale ? step : 0;
    node = std::min(node, RgbTableResolution - 2);
    return {node, (scale - kScales[node]) / (kScales[node + 1] - kScales[node])};
}

/// Clamps to [0, bound]; NaN becomes 0 by the argument order of std::max.
Rgb Bounded(const Rgb &rgb, Float bound) {
    auto component = [bound](Float v) { return std::min(std::max(Float(0), v), bound); };
    return {component(rgb.x), component(rgb.y), component(rgb.z)};
}

/// Three coefficients and padding, for one register.
using Quad = std::array<Float, 4>;

Quad Between(Float t, const Quad &a, const Quad &b) {
    Quad r;
    for (size_t i = 0; i < 4; ++i) r[i] = b[i] * t + a[i] * (1 - t);
    return r;
}

/// Smallest divisor: below it quotients overflow, or are 0 / 0 where denormals count as 0.
constexpr Float kTiny = std::numeric_limits<Float>::min();

/// Bound of RGB components: products with an illuminant do not overflow.
constexpr Float kBrightest = 1e37f;

bool NearlyEqual(const Point2 &a, const Point2 &b) {
    auto near = [](Float x, Float y) { return x == y || std::abs(x - y) < Float(1e-3) * std::abs(y); };
    return near(a.x, b.x) && near(a.y, b.y);
}

}  // namespace

Float SigmoidPolynomial::MaxValue() const {
    // The sigmoid is monotonic: its maximum is at that of the parabola, an end of the range or the vertex.
    const Float vertex = c0 < 0 ? std::clamp(-c1 / (2 * c0), LambdaMin, LambdaMax) : LambdaMin;
    return std::max({(*this)(LambdaMin), (*this)(vertex), (*this)(LambdaMax)});
}

const ColorSpace *ColorSpace::Find(const std::string &name) {
    for (const ColorSpace &space : AllSpaces())
        if (space.Name() == Lower(name)) return &space;
    return nullptr;
}

const ColorSpace &ColorSpace::SRGB() { return AllSpaces().front(); }

std::vector<std::string> ColorSpace::Names() {
    std::vector<std::string> names;
    for (const ColorSpace &space : AllSpaces()) names.push_back(space.Name());
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
    const Rgb color = Bounded(rgb, 1);
    // Of the largest component; of equal ones, the last.
    const size_t slab = color.z >= std::max(color.x, color.y) ? 2 : color.y >= color.x ? 1 : 0;
    const Float largest = color[int(slab)];
    const Float next = color[int((slab + 1) % 3)], afterNext = color[int((slab + 2) % 3)];
    // A grey g has the flat spectrum s(0, 0, c2) = g; c2 is infinite for black and white.
    if ((next == largest && afterNext == largest) || largest < kTiny)
        return {0, 0, (largest - Float(0.5)) / std::sqrt(largest * (1 - largest))};

    const AxisPlace x = PlaceOfRatio(next / largest), y = PlaceOfRatio(afterNext / largest);
    const AxisPlace scale = PlaceOfScale(largest);
    const float *first = table_ + RgbTableIndex(slab, scale.node, y.node, x.node);
    constexpr size_t kUp = RgbTableIndex(0, 0, 1, 0), kAbove = RgbTableIndex(0, 1, 0, 0);
    auto row = [&](const float *left) {
        // The right node starts after this node's three coefficients and is loaded with the last of them.
        Quad a, b;
        std::memcpy(&a, left, sizeof a);
        std::memcpy(&b, left + 2, sizeof b);
        return Between(x.fraction, a, Quad{b[1], b[2], b[3], b[3]});
    };
    auto plane = [&](const float *left) { return Between(y.fraction, row(left), row(left + kUp)); };
    const Quad c = Between(scale.fraction, plane(first), plane(first + kAbove));
    return {c[0], c[1], c[2]};
}

glm::mat3 ConvertRgbMatrix(const ColorSpace &from, const ColorSpace &to) {
    if (&from == &to) return glm::mat3(1);
    return to.RgbFromXyz() * from.XyzFromRgb();
}

ScaledPolynomial ScaledPolynomial::Of(const ColorSpace &cs, const Rgb &rgb) {
    const Rgb bounded = Bounded(rgb, kBrightest);
    const Float largest = std::max({bounded.x, bounded.y, bounded.z});
    // The scaled copy has the largest component 1/2: sigmoids are at most 1, and the tables are smooth around 1/2.
    const Float scale = largest < kTiny ? 0 : 2 * largest;
    return {scale, cs.ToPolynomial(scale > 0 ? bounded / scale : Rgb(0))};
}

Float SpectrumToPhotometric(const Spectrum &s) {
    if (auto *rgb = dynamic_cast<const RgbIlluminantSpectrum *>(&s)) return InnerProduct(CieY(), rgb->Illuminant());
    return InnerProduct(CieY(), s);
}

glm::mat3 WhiteBalanceMatrix(const Point2 &from, const Point2 &to) {
    // Bradford cone responses from XYZ; GLM takes columns.
    const glm::dmat3 conesFromXyz(0.8951, -0.7502, 0.0389, 0.2664, 1.7135, -0.0685, -0.1614, 0.0367, 1.0296);
    glm::dvec3 gain =
        (conesFromXyz * glm::dvec3(XyzFromChromaticity(to))) / (conesFromXyz * glm::dvec3(XyzFromChromaticity(from)));
    glm::dmat3 scale(gain.x, 0, 0, 0, gain.y, 0, 0, 0, gain.z);
    return glm::mat3(glm::inverse(conesFromXyz) * scale * conesFromXyz);
}

DenseSpectrum DaylightSpectrum(Float kelvin) {
    const auto normalized = [](const Spectrum &s) {
        std::vector<Float> values;
        for (Float lambda = LambdaMin; lambda <= LambdaMax; ++lambda) values.push_back(s(lambda));
        const Float y = SpectrumToXyz(DenseSpectrum(values)).y;
        for (Float &v : values) v /= y;
        return DenseSpectrum(values);
    };
    // The illuminants were defined with the radiation constant c2 = 1.4380e-2, to which nominal temperatures refer.
    double cct = double(kelvin) * (1.4388 / 1.4380);
    // CIE daylight is undefined below 4000 K; stock pbrt-v4 uses a black body there.
    if (cct < 4000) return normalized(BlackbodySpectrum(static_cast<Float>(cct)));
    double i = 1 / cct;
    double x = cct <= 7000 ? ((-4.607e9 * i + 2.9678e6) * i + 0.09911e3) * i + 0.244063
                           : ((-2.0064e9 * i + 1.9018e6) * i + 0.24748e3) * i + 0.23704;
    double y = (-3 * x + 2.87) * x - 0.275;
    double m = 0.0241 + 0.2562 * x - 0.7341 * y;
    auto m1 = Float((-1.3515 - 1.7703 * x + 5.9114 * y) / m);
    auto m2 = Float((0.0300 - 31.4424 * x + 30.0717 * y) / m);
    const ThreeColumnTable &s = EmbeddedDaylight();
    std::vector<Float> sum(s.lambdas.size());
    for (size_t k = 0; k < sum.size(); ++k) sum[k] = s.columns[0][k] + m1 * s.columns[1][k] + m2 * s.columns[2][k];
    return normalized(PiecewiseLinearSpectrum(s.lambdas, sum));
}

}  // namespace pbrt
