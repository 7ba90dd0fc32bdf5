#pragma once
#include <functional>
#include <vector>

#include "pbrt/math/bounds.h"
#include "pbrt/math/transform.h"

namespace pbrt {

/// Upper bounds of a density in the cells of a box that is divided evenly. Cell (x, y, z) covers the cube from (x, y,
/// z) to (x + 1, y + 1, z + 1) in the grid's own coordinates, in which the box reaches from 0 to Resolution().
class MajorantGrid {
  public:
    MajorantGrid() = default;
    /// `bound` gives the upper bound in a cell, at least 0 and finite; it is called from any thread.
    MajorantGrid(const glm::ivec3 &resolution, const std::function<Float(const glm::ivec3 &)> &bound);

    const glm::ivec3 &Resolution() const { return resolution_; }
    Float operator()(const glm::ivec3 &cell) const {
        return values_[(cell.z * resolution_.y + cell.y) * resolution_.x + cell.x];
    }
    size_t Bytes() const { return values_.size() * sizeof(Float); }

  private:
    glm::ivec3 resolution_{0};
    std::vector<Float> values_;
};

/// An affine map in double precision, so that boxes far from the origin of rendering space keep their cells.
struct AffineMap {
    glm::dmat3 linear{1};
    glm::dvec3 offset{0};

    AffineMap() = default;
    AffineMap(const glm::dmat3 &l, const glm::dvec3 &o) : linear(l), offset(o) {}
    explicit AffineMap(const glm::dmat4 &m) : linear(m), offset(m[3]) {}
    /// Moves `low` to 0 and the box from `low` to `high` to the box from 0 to `size`. A box without thickness along an
    /// axis must not occur.
    static AffineMap ToBox(const glm::dvec3 &low, const glm::dvec3 &high, const glm::dvec3 &size);

    glm::dvec3 Point(const glm::dvec3 &p) const { return linear * p + offset; }
    glm::dvec3 Vector(const glm::dvec3 &v) const { return linear * v; }
    AffineMap operator*(const AffineMap &o) const { return {linear * o.linear, linear * o.offset + offset}; }
    AffineMap Inverse() const;
};

/// The way of a ray through the cells of a MajorantGrid, or through one cell without bounds. A value of fixed size.
class GridWalk {
  public:
    /// One cell that is everywhere, whose value is 1, from 0 to tMax.
    explicit GridWalk(Float tMax) : end_(tMax) {}
    /// The ray's part in [0, tMax] that lies in the box. `gridFromRender` leads to the grid's own coordinates. The grid
    /// must stay where it is.
    GridWalk(const MajorantGrid &grid, const AffineMap &gridFromRender, const Ray &ray, Float tMax);

    /// The next stretch of the ray in one cell whose value is not 0; stretches come in order of distance and are never
    /// empty. False if there are no more.
    bool Next(Float *begin, Float *end, Float *value);

    /// True if t is in the part of the ray that lies in the box.
    bool Contains(Float t) const { return t >= anchor_ && t <= end_; }
    /// The place on the ray in the grid's coordinates; only for walks through a grid, and t of the part that lies in
    /// the box. Places of the current stretch are in its cell, whatever rounding does to them.
    Point3 At(Float t) const {
        const Point3 p = origin_ + direction_ * (t - anchor_);
        const bool isHere = t >= hereBegin_ && t <= hereEnd_;
        return isHere ? Min(Max(p, Point3(here_)), Point3(here_ + 1)) : Min(Max(p, Point3(0)), Point3(size_));
    }
    /// The ray in the grid's coordinates: its origin + Direction() * (t - Anchor()).
    const Vector3 &Direction() const { return direction_; }
    Float Anchor() const { return anchor_; }

  private:
    /// Where the ray leaves the cell through the next border of an axis, as a distance from the anchor.
    Float ExitOf(int axis) const {
        if (step_[axis] == 0) return Infinity;
        const int border = cell_[axis] + (step_[axis] > 0 ? 1 : 0);
        return (static_cast<Float>(border) - origin_[axis]) / direction_[axis];
    }

    const MajorantGrid *grid_ = nullptr;
    Float anchor_ = 0, end_ = 0;  ///< the ray's part in the box, by distance along the ray
    Float now_ = 0;               ///< distance from the anchor at which the current cell begins
    bool isDone_ = false;
    Point3 origin_{};  ///< where the ray is at the anchor, in the grid's coordinates
    Vector3 direction_{};
    glm::ivec3 cell_{0}, step_{0}, size_{0};
    Vector3 exit_{};  ///< distance from the anchor at which each axis leaves the cell
    // The stretch that Next returned last.
    glm::ivec3 here_{0};
    Float hereBegin_ = Infinity, hereEnd_ = -Infinity;
};

}  // namespace pbrt
