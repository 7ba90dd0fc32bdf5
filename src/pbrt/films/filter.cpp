#include "pbrt/films/filter.h"

#include <array>

#include "pbrt/math/distributions.h"
#include "pbrt/math/warps.h"

namespace pbrt {
namespace {

class BoxFilter final : public Filter {
  public:
    explicit BoxFilter(const Vector2 &radius) : Filter(radius) {}
    Float Evaluate(const Point2 &p) const override {
        return std::abs(p.x) <= radius_.x && std::abs(p.y) <= radius_.y ? 1 : 0;
    }
    Float Integral() const override { return 4 * radius_.x * radius_.y; }
    FilterSample Sample(const Point2 &u) const override { return {(u * Float(2) - Point2(1, 1)) * radius_, 1}; }
};

class TriangleFilter final : public Filter {
  public:
    explicit TriangleFilter(const Vector2 &radius) : Filter(radius) {}
    Float Evaluate(const Point2 &p) const override {
        return std::max(Float(0), radius_.x - std::abs(p.x)) * std::max(Float(0), radius_.y - std::abs(p.y));
    }
    Float Integral() const override { return Sqr(radius_.x * radius_.y); }
    FilterSample Sample(const Point2 &u) const override { return {{Tent(u.x, radius_.x), Tent(u.y, radius_.y)}, 1}; }

  private:
    /// Either half with probability 1/2; each half is linear.
    static Float Tent(Float u, Float radius) {
        if (u < Float(0.5)) return -radius + radius * SampleLinear(2 * u, 0, 1);
        return radius * SampleLinear(2 * u - 1, 1, 0);
    }
};

/// Product of two 1D profiles, each sampled from a table, as stock pbrt-v4 does from their product: kCells equal cells
/// per unit radius with the value at the cell centre.
template <class Profile>
class TabulatedFilter final : public Filter {
  public:
    TabulatedFilter(const Vector2 &radius, const Profile &x, const Profile &y)
        : Filter(radius), axes_{Axis(x, radius.x), Axis(y, radius.y)} {}
    Float Evaluate(const Point2 &p) const override {
        if (std::abs(p.x) > radius_.x || std::abs(p.y) > radius_.y) return 0;
        return axes_[0].profile(p.x) * axes_[1].profile(p.y);
    }
    Float Integral() const override { return axes_[0].signedIntegral * axes_[1].signedIntegral; }
    FilterSample Sample(const Point2 &u) const override {
        FilterSample s;
        for (int a = 0; a < 2; ++a) {
            const Axis &axis = axes_[a];
            PiecewiseConstant1D::Sampled sampled = axis.distribution.Sample(u[a]);
            s.offset[a] = sampled.x;
            s.weight *= axis.weights[sampled.index];
        }
        return s;
    }
    Float Pdf(const Point2 &p) const override {
        return axes_[0].distribution.Pdf(p.x) * axes_[1].distribution.Pdf(p.y);
    }
    bool HasPositiveIntegral() const { return axes_[0].signedIntegral > 0 && axes_[1].signedIntegral > 0; }

  private:
    static constexpr Float kCells = 32;

    struct Axis {
        Axis(const Profile &p, Float radius) : profile(p) {
            auto n = size_t(std::max(Float(1), kCells * radius));
            std::vector<Float> values(n);
            double sum = 0, absolute = 0;
            for (size_t i = 0; i < n; ++i) {
                Float t = (Float(i) + Float(0.5)) / Float(n);
                values[i] = profile(Lerp(t, -radius, radius));
                sum += double(values[i]);
                absolute += std::abs(double(values[i]));
            }
            distribution = PiecewiseConstant1D(values, -radius, radius);
            if (sum > 0) signedIntegral = Float(Integral(radius, n, sum));
            auto magnitude = Float(absolute / sum);
            for (Float v : values) weights.push_back(v < 0 ? -magnitude : magnitude);
        }
        /// Of the profile: by the sum over the n cells, unless it varies within a cell.
        double Integral(Float radius, size_t n, double sum) const {
            const size_t steps = n * std::max<size_t>(1, 65536 / n);
            double fine = 0;
            for (size_t i = 0; i < steps; ++i)
                fine += double(profile(Lerp((Float(i) + Float(0.5)) / Float(steps), -radius, radius)));
            const double width = 2 * double(radius), byCells = sum * width / double(n);
            fine *= width / double(steps);
            return std::abs(byCells - fine) < 1e-3 * fine ? byCells : fine;
        }
        Profile profile;
        PiecewiseConstant1D distribution;
        std::vector<Float> weights;  ///< per cell: +-(integral of |f|) / (integral of f)
        Float signedIntegral = 0;    ///< 0 if that of the table is not above 0
    };
    std::array<Axis, 2> axes_;
};

/// Gaussian offset to reach 0 at the radius.
struct GaussianProfile {
    Float radius, sigma;
    Float operator()(Float x) const { return std::max(Float(0), Density(x) - Density(radius)); }
    Float Density(Float x) const { return std::exp(-x * x / (2 * sigma * sigma)) / (sigma * std::sqrt(2 * Pi)); }
};

/// Mitchell and Netravali 1988, scaled to the radius (2 in their units).
struct MitchellProfile {
    Float radius, b, c;
    Float operator()(Float p) const {
        Float x = std::abs(2 * p / radius);
        if (x < 1) return (((12 - 9 * b - 6 * c) * x + (-18 + 12 * b + 6 * c)) * x * x + (6 - 2 * b)) / 6;
        if (x < 2)
            return (((-b - 6 * c) * x + (6 * b + 30 * c)) * x * x + (-12 * b - 48 * c) * x + (8 * b + 24 * c)) / 6;
        return 0;
    }
};

/// Lanczos: sinc windowed by a sinc that is tau times as wide.
struct WindowedSincProfile {
    Float radius, tau;
    Float operator()(Float x) const { return std::abs(x) > radius ? 0 : Sinc(x) * Sinc(x / tau); }
    static Float Sinc(Float x) {
        Float y = Pi * x;
        return 1 - y * y == 1 ? 1 : std::sin(y) / y;
    }
};

constexpr Range<Float> kWidthRange = Positive(1e6f), kSharpnessRange{-1000, 1000};

/// kDefault: of both radii.
template <Float kDefault>
struct RadiusParams {
    Float x = kDefault, y = kDefault;
    void Describe(auto &&v) {
        const Range<Float> range = Positive(1000, "pixels");  // tables have 32 cells per pixel
        v("xradius", x, range, "half width");
        v("yradius", y, range, "half height");
    }
    Vector2 Radius() const { return {x, y}; }
};

struct GaussianParams : RadiusParams<Float(1.5)> {
    Float sigma = Float(0.5);
    void Describe(auto &&v) {
        RadiusParams::Describe(v);
        v("sigma", sigma, kWidthRange, "standard deviation");
    }
    GaussianProfile Profile(Float radius) const { return {radius, sigma}; }
};

struct MitchellParams : RadiusParams<Float(2)> {
    Float b = Float(1) / 3, c = Float(1) / 3;
    void Describe(auto &&v) {
        RadiusParams::Describe(v);
        v("B", b, kSharpnessRange, "strength of blurring");
        v("C", c, kSharpnessRange, "strength of ringing");
    }
    MitchellProfile Profile(Float radius) const { return {radius, b, c}; }
};

struct SincParams : RadiusParams<Float(4)> {
    Float tau = 3;
    void Describe(auto &&v) {
        RadiusParams::Describe(v);
        v("tau", tau, kWidthRange, "half width of the window's main lobe, in pixels");
    }
    WindowedSincProfile Profile(Float radius) const { return {radius, tau}; }
};

template <class P>
void AddTabulated(FilterTable &table, const char *name) {
    table.Add<P>(name, "", [](const P &p, const ParamSet &set, const FilterContext &) {
        using Tabulated = TabulatedFilter<decltype(p.Profile(0))>;
        auto filter = std::make_unique<Tabulated>(p.Radius(), p.Profile(p.x), p.Profile(p.y));
        if (!filter->HasPositiveIntegral())
            throw set.Error("", "these parameters make a filter whose integral is not above 0.");
        return filter;
    });
}

}  // namespace

const FilterTable &Filters() {
    static const FilterTable table("PixelFilter", [](FilterTable &t) {
        t.Add<RadiusParams<Float(0.5)>>("box", "", [](const auto &p, const ParamSet &, const FilterContext &) {
            return std::make_unique<BoxFilter>(p.Radius());
        });
        t.Add<RadiusParams<Float(2)>>("triangle", "", [](const auto &p, const ParamSet &, const FilterContext &) {
            return std::make_unique<TriangleFilter>(p.Radius());
        });
        AddTabulated<GaussianParams>(t, "gaussian");
        AddTabulated<MitchellParams>(t, "mitchell");
        AddTabulated<SincParams>(t, "sinc");
    });
    return table;
}

}  // namespace pbrt
