#pragma once
#include <optional>
#include <span>
#include <vector>

#include "pbrt/math/bounds.h"

namespace pbrt {

/// Density on any axis-aligned window of the unit square, proportional to a function that is constant on nx * ny equal
/// cells (row-major, x fastest, >= 0). Because of a summed-area table every call may use another window: a sample takes
/// two binary searches, a density only the entries at the window's corners (Bitterli, Wyman and Pharr 2015,
/// Portal-Masked Environment Map Sampling).
class WindowedPiecewiseConstant2D {
  public:
    WindowedPiecewiseConstant2D() = default;
    WindowedPiecewiseConstant2D(std::span<const Float> f, int nx, int ny);

    /// A point inside the window and its density by area of the unit square. Empty if the function is 0 in the window.
    std::optional<Point2> Sample(const Point2 &u, const Bounds2 &window, Float *pdf) const;
    /// 0 outside the window.
    Float Pdf(const Point2 &p, const Bounds2 &window) const;
    /// Integral of the function over the window.
    double Integral(const Bounds2 &window) const;
    size_t Bytes() const { return f_.capacity() * sizeof(Float) + sums_.capacity() * sizeof(double); }

  private:
    /// The window in units of cells.
    struct Cells {
        double x0, x1, y0, y1;
    };
    Cells InCells(const Bounds2 &window) const;
    double Corner(int i, int j) const {
        return sums_[static_cast<size_t>(j) * static_cast<size_t>(nx_ + 1) + static_cast<size_t>(i)];
    }
    /// Between two heights: the sum of the cells left of a column. Points into the table.
    struct Band {
        const double *low, *high;  ///< the rows below the heights
        size_t stride;
        double inLow, inHigh;  ///< how far the heights are above these rows
        double operator()(int i) const {
            const auto at = [&](const double *row, double in) {
                return row[i] + in * (row[stride + static_cast<size_t>(i)] - row[i]);
            };
            return at(high, inHigh) - at(low, inLow);
        }
    };
    Band BandOf(const Cells &w) const;
    /// Sum of the cells of column i below row j.
    double MassBelow(int i, int j) const { return Corner(i + 1, j) - Corner(i, j); }
    double Total(const Cells &w) const;
    Float Density(const Point2 &p, double integral) const;

    int nx_ = 0, ny_ = 0;
    std::vector<Float> f_;
    std::vector<double> sums_;  ///< (nx + 1) * (ny + 1) corners: sum of all cells left of and below
};

}  // namespace pbrt
