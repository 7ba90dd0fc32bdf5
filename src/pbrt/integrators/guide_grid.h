#pragma once
#include <algorithm>
#include <array>

#include "pbrt/math/warps.h"

namespace pbrt {

/// A function of direction: one number for each cell of a square grid that the equal-area map lays over the sphere.
struct GuideGrid {
    static constexpr int kSide = 16, kCells = kSide * kSide;
    static constexpr Float kCellSolidAngle = 4 * Pi / kCells;
    alignas(64) std::array<Float, kCells> cell{};

    static int CellOf(const Vector3 &w) {
        const Point2 p = EqualAreaSphereToSquare(w) * Float(kSide);
        const auto along = [](Float x) { return std::clamp(static_cast<int>(x), 0, kSide - 1); };
        return along(p.y) * kSide + along(p.x);
    }
};

/// The density of directions at a vertex: in each cell of a grid constant, and in proportion to the grid's number there
/// times a cosine with the shading normal. Cells below the surface have none.
class GuideDirections {
  public:
    /// `n`: the shading normal (unit) on the side that light is scattered to; `bothSides`: light is scattered to both.
    void Prepare(const GuideGrid &grid, const Vector3 &n, bool bothSides);
    /// False if no cell has a density.
    bool IsUsable() const { return perUnit_ > 0; }
    /// A direction and its density by solid angle.
    Vector3 Sample(const Point2 &u, Float *pdf) const;
    Float Pdf(const Vector3 &w) const { return weight_[static_cast<size_t>(GuideGrid::CellOf(w))] * perUnit_; }

  private:
    alignas(64) std::array<Float, GuideGrid::kCells> weight_;
    std::array<Float, GuideGrid::kSide> column_;  ///< sums of weights
    Float total_ = 0, perUnit_ = 0;               ///< perUnit_: density by solid angle of a cell of weight 1
};

}  // namespace pbrt
