#pragma once
#include <cstddef>
#include <functional>
#include <new>
#include <type_traits>
#include <vector>

#include "pbrt/bxdfs/henyey_greenstein.h"
#include "pbrt/math/bounds.h"
#include "pbrt/math/ray.h"
#include "pbrt/math/transform.h"
#include "pbrt/spectra/spectrum.h"

namespace pbrt {

/// Upper bounds of a density in a regular grid of cells. Cell (x, y, z) is the cube from (x, y, z) to (x + 1, y + 1, z
/// + 1) in grid coordinates, which range from 0 to Resolution().
class MajorantGrid {
  public:
    MajorantGrid() = default;
    /// `bound` returns a cell's upper bound, finite and >= 0; it must be thread-safe.
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

/// Affine map in double precision, so that boxes far from the rendering-space origin keep their cells.
struct AffineMap {
    glm::dmat3 linear{1};
    glm::dvec3 offset{0};

    AffineMap() = default;
    AffineMap(const glm::dmat3 &l, const glm::dvec3 &o) : linear(l), offset(o) {}
    explicit AffineMap(const glm::dmat4 &m) : linear(m), offset(m[3]) {}
    /// Maps the box from `low` to `high`, of non-zero extent, to that from 0 to `size`.
    static AffineMap ToBox(const glm::dvec3 &low, const glm::dvec3 &high, const glm::dvec3 &size) {
        const glm::dvec3 scale = size / (high - low);
        return {glm::dmat3(scale.x, 0, 0, 0, scale.y, 0, 0, 0, scale.z), -low * scale};
    }

    glm::dvec3 Point(const glm::dvec3 &p) const { return linear * p + offset; }
    glm::dvec3 Vector(const glm::dvec3 &v) const { return linear * v; }
    AffineMap operator*(const AffineMap &o) const { return {linear * o.linear, linear * o.offset + offset}; }
    AffineMap Inverse() const {
        const glm::dmat3 inverse = glm::inverse(linear);
        return {inverse, -(inverse * offset)};
    }
};

/// Traversal of a MajorantGrid, or of one unbounded cell, along a ray. A value of fixed size.
class GridWalk {
  public:
    /// One unbounded cell of value 1, from 0 to tMax.
    explicit GridWalk(Float tMax) : end_(tMax) {}
    /// Clips [0, tMax] to the box. `gridFromRender` maps to grid coordinates. The grid must outlive this object at a
    /// fixed address.
    GridWalk(const MajorantGrid &grid, const AffineMap &gridFromRender, const Ray &ray, Float tMax);

    /// Next segment in one cell of non-zero value; segments are in order and never empty. False if there are no more.
    bool Next(Float *begin, Float *end, Float *value);

    bool Contains(Float t) const { return t >= anchor_ && t <= end_; }
    /// Point on the ray in grid coordinates; only for walks through a grid, with t inside the box. Points of the
    /// current segment are in its cell regardless of rounding.
    Point3 At(Float t) const {
        const Point3 p = origin_ + direction_ * (t - anchor_);
        const bool isHere = t >= hereBegin_ && t <= hereEnd_;
        return isHere ? Min(Max(p, Point3(here_)), Point3(here_ + 1)) : Min(Max(p, Point3(0)), Point3(size_));
    }
    /// Distance at which the ray enters the grid; infinite if it misses.
    Float Anchor() const { return anchor_; }

  private:
    /// Distance from the anchor to the cell's next border along an axis.
    Float ExitOf(int axis) const {
        const int step = Component(step_, axis);
        if (step == 0) return Infinity;
        const int border = Component(cell_, axis) + (step > 0 ? 1 : 0);
        return (Float(border) - Component(origin_, axis)) / Component(direction_, axis);
    }

    const MajorantGrid *grid_ = nullptr;
    Float anchor_ = 0, end_ = 0;  ///< the ray's part in the box, by distance
    Float now_ = 0;               ///< distance from the anchor to the start of the current cell
    bool isDone_ = false;
    Point3 origin_{};  ///< position at the anchor, in grid coordinates
    Vector3 direction_{};
    glm::ivec3 cell_{0}, step_{0}, size_{0};
    Vector3 exit_{};  ///< distance from the anchor to each axis's border
    // Last segment of Next.
    glm::ivec3 here_{0};
    Float hereBegin_ = Infinity, hereEnd_ = -Infinity;
};

/// Medium properties at a point, at one path's wavelengths. Absorption and scattering per unit length in rendering
/// space (= world space units).
struct MediumCoefficients {
    SampledSpectrum absorption, scattering;
    SampledSpectrum emission;  ///< radiance; absorption * emission is emitted per unit length
};

/// Ray segment in which absorption plus scattering is at most `majorant`.
struct MajorantSegment {
    Float begin = 0, end = 0;  ///< distances along the ray; `end` may be infinite
    SampledSpectrum majorant;  ///< per unit length; not 0 at all wavelengths
};

class MediumOnRay;

/// Participating medium. Immutable and thread-safe.
class Medium {
  public:
    virtual ~Medium() = default;
    const HenyeyGreenstein &Phase() const { return phase_; }
    bool IsEmissive() const { return isEmissive_; }
    virtual size_t Bytes() const = 0;

    /// The medium along a ray of unit direction up to distance tMax, which may be infinite. Refers to this medium.
    virtual MediumOnRay On(const Ray &ray, Float tMax, const SampledWavelengths &lambda) const = 0;
    /// Coefficients at a point in rendering space. Slower than MediumOnRay::At.
    MediumCoefficients At(const Point3 &p, const SampledWavelengths &lambda) const;

  protected:
    Medium(Float g, bool isEmissive) : phase_(g), isEmissive_(isEmissive) {}

  private:
    friend class MediumOnRay;
    virtual MediumCoefficients Evaluate(MediumOnRay &onRay, Float t) const = 0;

    HenyeyGreenstein phase_;
    bool isEmissive_;
};

/// Medium along one ray: majorant segments, then coefficients at sampled distances. Created per ray without allocation;
/// not thread-safe.
class MediumOnRay {
  public:
    /// Next segment within [0, tMax], in order and not empty; vacuum lies between segments. False: there are no more.
    bool Next(MajorantSegment *segment) {
        Float value = 0;
        if (!majorant_ || !walk_.Next(&segment->begin, &segment->end, &value)) return false;
        segment->majorant = majorant_ * value;
        return true;
    }
    /// Coefficients at a distance. In the last segment of Next they do not exceed its majorant.
    MediumCoefficients At(Float t) {
        if (!walk_.Contains(t)) return {};
        return medium_->Evaluate(*this, t);
    }

    /// `unit`: coefficients at density 1, if constant. The walk's values multiply `majorant`.
    MediumOnRay(const Medium &medium, const GridWalk &walk, const SampledWavelengths &lambda,
                const MediumCoefficients &unit, const SampledSpectrum &majorant)
        : medium_(&medium), walk_(walk), lambda_(lambda), unit_(unit), majorant_(majorant) {}

    /// With the majorant of density 1.
    MediumOnRay(const Medium &medium, const GridWalk &walk, const SampledWavelengths &lambda,
                const MediumCoefficients &unit)
        : MediumOnRay(medium, walk, lambda, unit, unit.absorption + unit.scattering) {}
    const GridWalk &Walk() const { return walk_; }
    const SampledWavelengths &Lambda() const { return lambda_; }
    const MediumCoefficients &Unit() const { return unit_; }
    /// Storage for per-ray state of derived media. Must be constructed before use.
    template <class T>
    T &MakeMemory(const T &value) {
        static_assert(sizeof(T) <= sizeof(memory_) && alignof(T) <= 16 && std::is_trivially_copyable_v<T>);
        return *new (memory_) T(value);
    }
    template <class T>
    T &Memory() {
        return *std::launder(reinterpret_cast<T *>(memory_));
    }

  private:
    const Medium *medium_;
    GridWalk walk_;
    SampledWavelengths lambda_;
    MediumCoefficients unit_;
    SampledSpectrum majorant_;
    alignas(16) std::byte memory_[192];
};

inline MediumCoefficients Medium::At(const Point3 &p, const SampledWavelengths &lambda) const {
    return On({.o = p}, 0, lambda).At(0);
}

}  // namespace pbrt
