#include "pbrt/math/windowed_distribution.h"

#include <algorithm>

#include "pbrt/core/error.h"

namespace pbrt {

namespace {

/// Piecewise linear interpolation of a function given at 0 ... n.
template <class F>
double Between(double x, int n, F atWhole) {
    int i = std::min(static_cast<int>(x), n - 1);
    double low = atWhole(i);
    return low + (x - i) * (atWhole(i + 1) - low);
}

/// Piece of a non-decreasing function, given at 0 ... n, in which it reaches a target.
struct Piece {
    int at;
    double low, high;  ///< values at both ends
};

/// The piece within [from, to] that contains the target; `start` and `rise`: value at `from` and increase up to `to`.
/// Interpolation finds it in a few steps where the function is nearly linear; every second step bisects.
template <class F>
Piece FindPiece(double target, double from, double to, double start, double rise, int n, F atWhole) {
    int low = std::min(static_cast<int>(from), n - 1), high = std::min(static_cast<int>(to), n - 1);
    const int last = high;
    double x0 = from, x1 = to, y0 = start, y1 = start + rise;
    for (bool bisects = false; low <= high; bisects = !bisects) {
        const double x = bisects || !(y1 > y0) ? (x0 + x1) / 2 : x0 + (target - y0) / (y1 - y0) * (x1 - x0);
        const int i = std::clamp(static_cast<int>(x), low, high);
        const Piece piece{i, atWhole(i), atWhole(i + 1)};
        if (!(piece.high > target)) {
            low = piece.at + 1, x0 = low, y0 = piece.high;
        } else if (piece.low > target && piece.at > low) {
            high = piece.at - 1, x1 = piece.at, y1 = piece.low;
        } else {
            return piece;
        }
    }
    return {last, atWhole(last), atWhole(last + 1)};
}

/// Inverts a non-decreasing function of that kind: x where it reaches the fraction u of its increase over [from, to].
/// *piece is an interval that contains x and where the function increases, *risen the total increase. Returns false if
/// that is 0.
template <class F>
bool Invert(double u, double from, double to, int n, F atWhole, double *x, int *piece, double *risen) {
    const double start = Between(from, n, atWhole), rise = Between(to, n, atWhole) - start;
    *risen = rise;
    if (!(rise > 0)) return false;
    const double target = start + u * rise;
    const auto [at, a, b] = FindPiece(target, from, to, start, rise, n, atWhole);
    if (!(b > a)) return false;
    *piece = at;
    *x = std::clamp(at + (target - a) / (b - a), std::max(from, static_cast<double>(at)),
                    std::min(to, static_cast<double>(at) + 1));
    return true;
}

}  // namespace

WindowedPiecewiseConstant2D::WindowedPiecewiseConstant2D(std::span<const Float> f, int nx, int ny) : nx_(nx), ny_(ny) {
    PBRT_CHECK(nx > 0 && ny > 0 && f.size() == static_cast<size_t>(nx) * static_cast<size_t>(ny));
    const size_t stride = static_cast<size_t>(nx) + 1;
    sums_.assign(stride * (static_cast<size_t>(ny) + 1), 0);
    for (size_t j = 0; j < static_cast<size_t>(ny); ++j) {
        double row = 0;
        for (size_t i = 0; i < static_cast<size_t>(nx); ++i) {
            row += std::max(static_cast<double>(f[j * static_cast<size_t>(nx) + i]), 0.0);
            sums_[(j + 1) * stride + i + 1] = sums_[j * stride + i + 1] + row;
        }
    }
    columns_.reserve(static_cast<size_t>(nx) * (static_cast<size_t>(ny) + 1));
    for (int i = 0; i < nx; ++i) {
        double column = 0;
        columns_.push_back(0);
        for (int j = 0; j < ny; ++j) columns_.push_back(column += std::max(static_cast<double>(f[j * nx + i]), 0.0));
    }
}

WindowedPiecewiseConstant2D::Cells WindowedPiecewiseConstant2D::InCells(const Bounds2 &w) const {
    auto scaled = [](Float v, int n) { return static_cast<double>(std::clamp(v, Float(0), Float(1))) * n; };
    return {scaled(w.low.x, nx_), scaled(w.high.x, nx_), scaled(w.low.y, ny_), scaled(w.high.y, ny_)};
}

WindowedPiecewiseConstant2D::Band WindowedPiecewiseConstant2D::BandOf(const Cells &w) const {
    const int low = std::min(static_cast<int>(w.y0), ny_ - 1), high = std::min(static_cast<int>(w.y1), ny_ - 1);
    const size_t stride = static_cast<size_t>(nx_) + 1;
    return {sums_.data() + static_cast<size_t>(low) * stride, sums_.data() + static_cast<size_t>(high) * stride, stride,
            w.y0 - low, w.y1 - high};
}

double WindowedPiecewiseConstant2D::Total(const Cells &w) const {
    const Band left = BandOf(w);
    return std::max(Between(w.x1, nx_, left) - Between(w.x0, nx_, left), 0.0);
}

double WindowedPiecewiseConstant2D::Integral(const Bounds2 &window) const {
    return Total(InCells(window)) / (static_cast<double>(nx_) * static_cast<double>(ny_));
}

std::optional<Point2> WindowedPiecewiseConstant2D::Sample(const Point2 &u, const Bounds2 &window, Float *pdf) const {
    const Cells w = InCells(window);
    double x = 0, y = 0, total = 0, ofColumn = 0;
    int column = 0, row = 0;
    const Band left = BandOf(w);
    if (!Invert(static_cast<double>(u.x), w.x0, w.x1, nx_, left, &x, &column, &total)) return {};
    const double *const sums = ColumnSums(column);
    const auto below = [&](int j) { return sums[j]; };
    if (!Invert(static_cast<double>(u.y), w.y0, w.y1, ny_, below, &y, &row, &ofColumn)) return {};
    // Rounding to Float may cross into the next cell; the density is that of the returned point.
    const Point2 p(std::clamp(static_cast<Float>(x / nx_), window.low.x, window.high.x),
                   std::clamp(static_cast<Float>(y / ny_), window.low.y, window.high.y));
    *pdf = Density(p, total / (static_cast<double>(nx_) * static_cast<double>(ny_)));
    if (!(*pdf > 0)) return {};
    return p;
}

Float WindowedPiecewiseConstant2D::Density(const Point2 &p, double integral) const {
    const int i = std::clamp(static_cast<int>(p.x * static_cast<Float>(nx_)), 0, nx_ - 1);
    const int j = std::clamp(static_cast<int>(p.y * static_cast<Float>(ny_)), 0, ny_ - 1);
    const double *const sums = ColumnSums(i);
    return static_cast<Float>((sums[j + 1] - sums[j]) / integral);
}

Float WindowedPiecewiseConstant2D::IntegralAround(const Bounds2 &window) const {
    const Cells w = InCells(window);
    const int x0 = static_cast<int>(w.x0), x1 = static_cast<int>(std::ceil(w.x1)), y0 = static_cast<int>(w.y0),
              y1 = static_cast<int>(std::ceil(w.y1));
    return static_cast<Float>((Corner(x1, y1) - Corner(x0, y1)) - (Corner(x1, y0) - Corner(x0, y0))) /
           static_cast<Float>(nx_ * ny_);
}

Float WindowedPiecewiseConstant2D::Pdf(const Point2 &p, const Bounds2 &window) const {
    if (!(p.x >= window.low.x && p.x <= window.high.x && p.y >= window.low.y && p.y <= window.high.y)) return 0;
    double integral = Integral(window);
    if (!(integral > 0)) return 0;
    return Density(p, integral);
}

}  // namespace pbrt
