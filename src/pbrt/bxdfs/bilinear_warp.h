#pragma once
#include <array>
#include <span>
#include <vector>

#include "pbrt/math/vec.h"

namespace pbrt {

/// Values at the knots of an even grid over the unit square (row-major, x fastest, both ends included), several slices
/// of it.
class GridSlices {
  public:
    GridSlices() = default;
    /// `values` holds a whole number of slices; nx, ny >= 2.
    GridSlices(std::vector<Float> values, int nx, int ny) : values_(std::move(values)), nx_(nx), ny_(ny) {}

    /// Bilinear; p outside the square counts as its edge.
    Float Evaluate(const Point2 &p, size_t slice) const;
    int Nx() const { return nx_; }
    int Ny() const { return ny_; }
    size_t Count() const { return values_.size() / (static_cast<size_t>(nx_) * static_cast<size_t>(ny_)); }
    Float At(size_t slice, int x, int y) const {
        return values_[(slice * static_cast<size_t>(ny_) + static_cast<size_t>(y)) * static_cast<size_t>(nx_) +
                       static_cast<size_t>(x)];
    }

  private:
    std::vector<Float> values_;
    int nx_ = 0, ny_ = 0;
};

/// A weighted mean of four slices (weights add up to 1).
struct SliceBlend {
    std::array<size_t, 4> slice;
    std::array<Float, 4> weight;
};

/// Densities over the unit square, each slice the bilinear interpolation of its values made to integrate to 1, and the
/// map from the square to itself that draws from a blend of slices.
class BilinearWarp {
  public:
    struct Mapped {
        Point2 p;
        Float pdf;  ///< of the warp where it leads to, by area
    };
    BilinearWarp() = default;
    /// Values >= 0, in every slice at least one > 0.
    BilinearWarp(const GridSlices &values);

    Mapped Sample(const Point2 &u, const SliceBlend &blend) const;
    /// The u that Sample would take to p.
    Mapped Invert(const Point2 &p, const SliceBlend &blend) const;

  private:
    /// Integral of the density over rows below row y; of the line y from 0 to knot x; density at a knot (all in grid
    /// cells).
    Float MassBelowRow(const SliceBlend &blend, int y) const {
        return Blend(blend, below_, static_cast<size_t>(y), ny_);
    }
    Float Left(const SliceBlend &blend, int x, int y) const { return Blend(blend, left_, Index(x, y), ny_ * nx_); }
    Float Density(const SliceBlend &blend, int x, int y) const {
        return Blend(blend, density_, Index(x, y), ny_ * nx_);
    }
    size_t Index(int x, int y) const { return static_cast<size_t>(y * nx_ + x); }
    static Float Blend(const SliceBlend &blend, const std::vector<Float> &table, size_t at, int perSlice) {
        Float sum = 0;
        for (size_t k = 0; k < 4; ++k)
            if (blend.weight[k] != 0)
                sum += blend.weight[k] * table[blend.slice[k] * static_cast<size_t>(perSlice) + at];
        return sum;
    }
    Float CellArea() const { return Float(1) / static_cast<Float>((nx_ - 1) * (ny_ - 1)); }

    std::vector<Float> density_, left_, below_;
    int nx_ = 0, ny_ = 0;
};

}  // namespace pbrt
