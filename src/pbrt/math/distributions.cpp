#include "pbrt/math/distributions.h"

namespace pbrt {
namespace {

/// Piecewise linear interpolation of a function given at 0 ... n.
double Between(double x, int n, auto atWhole) {
    int i = std::min(int(x), n - 1);
    double low = atWhole(i);
    return low + (x - i) * (atWhole(i + 1) - low);
}

/// Piece of a non-decreasing function, given at 0 ... n, in which it reaches a target.
struct Piece {
    int at;
    double low, high;  ///< values at both ends
};

/// The first piece within [from, to] whose upper end exceeds the target, else the last. Branchless, as the target is
/// random.
Piece FindPiece(double target, double from, double to, int n, auto atWhole) {
    int at = std::min(int(from), n - 1);
    for (int left = std::min(int(to), n - 1) - at; left > 0;) {
        const int half = (left + 1) / 2;
        at = atWhole(at + half) <= target ? at + half : at;
        left -= half;
    }
    return {at, atWhole(at), atWhole(at + 1)};
}

/// Inverts a non-decreasing function of that kind: x where it reaches the fraction u of its increase over [from, to].
/// *piece is an interval that contains x and where the function increases, *risen the total increase. Returns false if
/// that is 0.
bool Invert(double u, double from, double to, int n, auto atWhole, double *x, int *piece, double *risen) {
    const double start = Between(from, n, atWhole), rise = Between(to, n, atWhole) - start;
    *risen = rise;
    if (!(rise > 0)) return false;
    const double target = start + u * rise;
    const auto [at, a, b] = FindPiece(target, from, to, n, atWhole);
    if (!(b > a)) return false;
    *piece = at;
    *x = std::clamp(at + (target - a) / (b - a), std::max(from, double(at)), std::min(to, double(at) + 1));
    return true;
}

}  // namespace

PiecewiseConstant1D::PiecewiseConstant1D(std::span<const Float> f, Float low, Float high)
    : row_(1, f.size()), low_(low), high_(high), last_(std::nextafter(high, low)) {
    PBRT_CHECK(!f.empty() && high > low);
    integral_ = row_.Set(0, f, double(high) - double(low));
}

PiecewiseConstant1D::Sampled PiecewiseConstant1D::Sample(Float u) const {
    const auto s = row_.Sample(0, u);
    return {std::min(Lerp(s.place, low_, high_), last_), s.piece.pdf, int(s.index)};
}

Float PiecewiseConstant1D::Pdf(Float x) const {
    if (x < low_ || x > high_) return 0;
    const size_t n = row_.PieceCount();
    return row_.At(0, std::min(size_t((x - low_) / (high_ - low_) * Float(n)), n - 1)).pdf;
}

WindowedPiecewiseConstant2D::WindowedPiecewiseConstant2D(std::span<const Float> f, int nx, int ny) : nx_(nx), ny_(ny) {
    PBRT_CHECK(nx > 0 && ny > 0 && f.size() == size_t(nx) * size_t(ny));
    const size_t stride = size_t(nx) + 1;
    sums_.assign(stride * (size_t(ny) + 1), 0);
    for (size_t j = 0; j < size_t(ny); ++j) {
        double row = 0;
        for (size_t i = 0; i < size_t(nx); ++i) {
            row += std::max(double(f[j * size_t(nx) + i]), 0.0);
            sums_[(j + 1) * stride + i + 1] = sums_[j * stride + i + 1] + row;
        }
    }
    columns_.reserve(size_t(nx) * (size_t(ny) + 1));
    for (int i = 0; i < nx; ++i) {
        double column = 0;
        columns_.push_back(0);
        for (int j = 0; j < ny; ++j) columns_.push_back(column += std::max(double(f[j * nx + i]), 0.0));
    }
}

WindowedPiecewiseConstant2D::Cells WindowedPiecewiseConstant2D::InCells(const Bounds2 &w) const {
    auto scaled = [](Float v, int n) { return double(std::clamp(v, Float(0), Float(1))) * n; };
    return {scaled(w.low.x, nx_), scaled(w.high.x, nx_), scaled(w.low.y, ny_), scaled(w.high.y, ny_)};
}

WindowedPiecewiseConstant2D::Band WindowedPiecewiseConstant2D::BandOf(const Cells &w) const {
    const int low = std::min(int(w.y0), ny_ - 1), high = std::min(int(w.y1), ny_ - 1);
    const size_t stride = size_t(nx_) + 1;
    return {sums_.data() + size_t(low) * stride, sums_.data() + size_t(high) * stride, stride, w.y0 - low, w.y1 - high};
}

double WindowedPiecewiseConstant2D::Total(const Cells &w) const {
    const Band left = BandOf(w);
    return std::max(Between(w.x1, nx_, left) - Between(w.x0, nx_, left), 0.0);
}

double WindowedPiecewiseConstant2D::Integral(const Bounds2 &window) const {
    return Total(InCells(window)) / (double(nx_) * double(ny_));
}

std::optional<Point2> WindowedPiecewiseConstant2D::Sample(const Point2 &u, const Bounds2 &window, Float *pdf) const {
    const Cells w = InCells(window);
    double x = 0, y = 0, total = 0, ofColumn = 0;
    int column = 0, row = 0;
    const Band left = BandOf(w);
    if (!Invert(double(u.x), w.x0, w.x1, nx_, left, &x, &column, &total)) return {};
    const double *const sums = ColumnSums(column);
    const auto below = [&](int j) { return sums[j]; };
    if (!Invert(double(u.y), w.y0, w.y1, ny_, below, &y, &row, &ofColumn)) return {};
    // Rounding to Float may cross into the next cell; the density is that of the returned point.
    const Point2 p(std::clamp(Float(x / nx_), window.low.x, window.high.x),
                   std::clamp(Float(y / ny_), window.low.y, window.high.y));
    *pdf = Density(p, total / (double(nx_) * double(ny_)));
    if (!(*pdf > 0)) return {};
    return p;
}

Float WindowedPiecewiseConstant2D::Density(const Point2 &p, double integral) const {
    const int i = std::clamp(int(p.x * Float(nx_)), 0, nx_ - 1);
    const int j = std::clamp(int(p.y * Float(ny_)), 0, ny_ - 1);
    const double *const sums = ColumnSums(i);
    return Float((sums[j + 1] - sums[j]) / integral);
}

Float WindowedPiecewiseConstant2D::IntegralAround(const Bounds2 &window) const {
    const Cells w = InCells(window);
    const int x0 = int(w.x0), x1 = int(std::ceil(w.x1)), y0 = int(w.y0), y1 = int(std::ceil(w.y1));
    const double sum = (Corner(x1, y1) - Corner(x0, y1)) - (Corner(x1, y0) - Corner(x0, y0));
    return Float(std::max(sum, 0.0) / (double(nx_) * double(ny_)));
}

Float WindowedPiecewiseConstant2D::Pdf(const Point2 &p, const Bounds2 &window) const {
    if (!(p.x >= window.low.x && p.x <= window.high.x && p.y >= window.low.y && p.y <= window.high.y)) return 0;
    double integral = Integral(window);
    if (!(integral > 0)) return 0;
    return Density(p, integral);
}

AliasTable::AliasTable(std::span<const Float> weights) : bins_(weights.size()) {
    double sum = 0;
    for (Float w : weights) sum += double(w);
    size_t n = weights.size();
    std::vector<double> scaled(n);
    std::vector<int> under, over;
    for (size_t i = 0; i < n; ++i) {
        double p = sum > 0 ? double(weights[i]) / sum : 1.0 / double(n);
        bins_[i].p = Float(p);
        scaled[i] = p * double(n);
        (scaled[i] < 1 ? under : over).push_back(int(i));
    }
    while (!under.empty() && !over.empty()) {
        const int u = under.back(), o = over.back();
        under.pop_back();
        bins_[u].q = Float(scaled[u]);
        bins_[u].alias = o;
        scaled[o] -= 1 - scaled[u];
        if (scaled[o] < 1) {
            over.pop_back();
            under.push_back(o);
        }
    }
    // Entries left over by rounding own their whole column; those of weight 0 pass it to the heaviest entry.
    const auto heaviest = int(std::ranges::max_element(bins_, {}, &Bin::p) - bins_.begin());
    for (const std::vector<int> *rest : {&under, &over})
        for (int i : *rest) bins_[i] = {bins_[i].p > 0 ? Float(1) : Float(0), bins_[i].p, heaviest};
}

AliasTable::Sampled AliasTable::Sample(Float u) const {
    auto n = Float(bins_.size());
    auto column = std::min(size_t(u * n), bins_.size() - 1);
    Float up = std::min(u * n - Float(column), OneMinusEpsilon);
    const Bin &bin = bins_[column];
    if (up < bin.q) return {int(column), bin.p};
    return {bin.alias, bins_[bin.alias].p};
}

}  // namespace pbrt
