#include "pbrt/bxdfs/bilinear_warp.h"

#include "pbrt/math/warps.h"

namespace pbrt {
namespace {

struct Cell {
    int index;
    Float t;
};

/// Cell that contains x, for n knots over [0, 1]; the first cell if x is NaN.
Cell CellOf(Float x, int n) {
    Float at = (x > 0 ? std::min(x, Float(1)) : Float(0)) * Float(n - 1);
    int i = std::min(int(at), n - 2);
    return {i, at - Float(i)};
}

/// Last i in [0, n - 2] with sum(i) <= u; sum must not decrease.
int LastNotAbove(int n, Float u, auto sum) {
    int low = 0, high = n - 1;
    while (high - low > 1) {
        int middle = (low + high) / 2;
        (sum(middle) <= u ? low : high) = middle;
    }
    return low;
}

/// Integral from 0 to t of a linear density from a at 0 to b at 1, and its inverse.
Float MassBelow(Float t, Float a, Float b) { return t * (a + (b - a) * t / 2); }

Float WhereMassIs(Float mass, Float a, Float b) {
    Float total = (a + b) / 2;
    return total > 0 ? SampleLinear(std::clamp(mass / total, Float(0), OneMinusEpsilon), a, b) : 0;
}

}  // namespace

Float GridSlices::Evaluate(const Point2 &p, size_t slice) const {
    const Cell x = CellOf(p.x, nx_), y = CellOf(p.y, ny_);
    return Lerp(y.t, Lerp(x.t, At(slice, x.index, y.index), At(slice, x.index + 1, y.index)),
                Lerp(x.t, At(slice, x.index, y.index + 1), At(slice, x.index + 1, y.index + 1)));
}

BilinearWarp::BilinearWarp(const GridSlices &values) : nx_(values.Nx()), ny_(values.Ny()) {
    const size_t perSlice = nx_ * ny_;
    density_.resize(values.Count() * perSlice);
    left_.resize(density_.size());
    below_.resize(values.Count() * ny_);
    std::vector<double> left(perSlice), below(ny_);
    for (size_t s = 0; s < values.Count(); ++s) {
        for (int y = 0; y < ny_; ++y) {
            for (int x = 0; x < nx_; ++x)
                left[Index(x, y)] =
                    x == 0 ? 0
                           : left[Index(x - 1, y)] + (double(values.At(s, x - 1, y)) + double(values.At(s, x, y))) / 2;
            below[y] = y == 0 ? 0 : below[y - 1] + (left[Index(nx_ - 1, y - 1)] + left[Index(nx_ - 1, y)]) / 2;
        }
        const double total = below.back();
        for (int y = 0; y < ny_; ++y) {
            for (int x = 0; x < nx_; ++x) {
                density_[s * perSlice + Index(x, y)] = Float(double(values.At(s, x, y)) / total);
                left_[s * perSlice + Index(x, y)] = Float(left[Index(x, y)] / total);
            }
            below_[s * ny_ + y] = Float(below[y] / total);
        }
    }
}

BilinearWarp::Mapped BilinearWarp::Sample(const Point2 &u, const SliceBlend &blend) const {
    const int y = LastNotAbove(ny_, u.y, [&](int i) { return MassBelowRow(blend, i); });
    const Float row0 = Left(blend, nx_ - 1, y), row1 = Left(blend, nx_ - 1, y + 1);
    const Float ty = WhereMassIs(u.y - MassBelowRow(blend, y), row0, row1);

    auto left = [&](int i) { return Lerp(ty, Left(blend, i, y), Left(blend, i, y + 1)); };
    const Float mass = u.x * Lerp(ty, row0, row1);
    const int x = LastNotAbove(nx_, mass, left);
    const Float d0 = Lerp(ty, Density(blend, x, y), Density(blend, x, y + 1));
    const Float d1 = Lerp(ty, Density(blend, x + 1, y), Density(blend, x + 1, y + 1));
    const Float tx = WhereMassIs(mass - left(x), d0, d1);
    return {{(Float(x) + tx) / Float(nx_ - 1), (Float(y) + ty) / Float(ny_ - 1)}, Lerp(tx, d0, d1) / CellArea()};
}

BilinearWarp::Mapped BilinearWarp::Invert(const Point2 &p, const SliceBlend &blend) const {
    const Cell x = CellOf(p.x, nx_), y = CellOf(p.y, ny_);
    const Float row0 = Left(blend, nx_ - 1, y.index), row1 = Left(blend, nx_ - 1, y.index + 1);
    const Float d0 = Lerp(y.t, Density(blend, x.index, y.index), Density(blend, x.index, y.index + 1));
    const Float d1 = Lerp(y.t, Density(blend, x.index + 1, y.index), Density(blend, x.index + 1, y.index + 1));
    const Float row = Lerp(y.t, row0, row1);
    const Float left =
        Lerp(y.t, Left(blend, x.index, y.index), Left(blend, x.index, y.index + 1)) + MassBelow(x.t, d0, d1);
    return {{row > 0 ? std::clamp(left / row, Float(0), Float(1)) : 0,
             std::clamp(MassBelowRow(blend, y.index) + MassBelow(y.t, row0, row1), Float(0), Float(1))},
            Lerp(x.t, d0, d1) / CellArea()};
}

}  // namespace pbrt
