#pragma once
#include "pbrt/math/vec.h"

namespace pbrt {

/// Axis-aligned box; empty (low > high) by default.
struct Bounds3 {
    Point3 low{Infinity, Infinity, Infinity};
    Point3 high{-Infinity, -Infinity, -Infinity};

    Bounds3() = default;
    explicit Bounds3(const Point3 &p) : low(p), high(p) {}
    Bounds3(const Point3 &a, const Point3 &b) : low(Min(a, b)), high(Max(a, b)) {}

    bool IsEmpty() const { return !(low.x <= high.x && low.y <= high.y && low.z <= high.z); }
    Vector3 Diagonal() const { return high - low; }
    Point3 Center() const { return low * Float(0.5) + high * Float(0.5); }
    Float SurfaceArea() const {
        if (IsEmpty()) return 0;
        Vector3 d = Diagonal();
        return 2 * (d.x * d.y + d.y * d.z + d.z * d.x);
    }
    int LongestAxis() const {
        Vector3 d = Diagonal();
        return d.x > d.y && d.x > d.z ? 0 : d.y > d.z ? 1 : 2;
    }
    bool Contains(const Point3 &p) const {
        return p.x >= low.x && p.y >= low.y && p.z >= low.z && p.x <= high.x && p.y <= high.y && p.z <= high.z;
    }
    Point3 Corner(int i) const { return {i & 1 ? high.x : low.x, i & 2 ? high.y : low.y, i & 4 ? high.z : low.z}; }
    /// Sphere through the corners; radius 0 if empty.
    void BoundingSphere(Point3 *center, Float *radius) const {
        *center = Center();
        *radius = IsEmpty() ? 0 : Distance(*center, high);
    }
};

inline Bounds3 Union(const Bounds3 &a, const Bounds3 &b) {
    Bounds3 r;
    r.low = Min(a.low, b.low);
    r.high = Max(a.high, b.high);
    return r;
}
inline Bounds3 Union(const Bounds3 &a, const Point3 &p) { return Union(a, Bounds3(p)); }

/// Half-open pixel rectangle [low, high).
struct Bounds2i {
    Point2i low{0, 0}, high{0, 0};
    bool operator==(const Bounds2i &) const = default;
    int Width() const { return high.x - low.x; }
    int Height() const { return high.y - low.y; }
    bool IsEmpty() const { return Width() <= 0 || Height() <= 0; }
    int64_t Area() const { return IsEmpty() ? 0 : int64_t(Width()) * Height(); }
    bool Contains(const Point2i &p) const { return p.x >= low.x && p.y >= low.y && p.x < high.x && p.y < high.y; }
};
inline Bounds2i Intersect(const Bounds2i &a, const Bounds2i &b) {
    return {glm::max(a.low, b.low), glm::min(a.high, b.high)};
}

struct Bounds2 {
    Point2 low{0, 0}, high{0, 0};
    Float Area() const { return (high.x - low.x) * (high.y - low.y); }
    Point2 Lerp(const Point2 &t) const { return low + (high - low) * t; }
};

/// Directions within an angle of an axis; empty if cosTheta > 1.
struct DirectionCone {
    Vector3 w{0, 0, 1};
    Float cosTheta = Infinity;
    static DirectionCone EntireSphere() { return {Vector3(0, 0, 1), -1}; }
    bool IsEmpty() const { return cosTheta == Infinity; }
};

/// Smallest cone that contains both (Conty and Kulla 2018, section 4.1). In the plane of the axes, with angles from a's
/// axis towards b's, the cones are the arcs [-alpha, alpha] and [apart - beta, apart + beta]. Unless one contains the
/// other, their union spans the arc [-alpha, apart + beta].
inline DirectionCone Union(const DirectionCone &a, const DirectionCone &b) {
    if (a.IsEmpty() || b.IsEmpty()) return a.IsEmpty() ? b : a;
    const Float alpha = SafeACos(a.cosTheta), beta = SafeACos(b.cosTheta), apart = AngleBetween(a.w, b.w);
    auto holds = [apart](Float outer, Float inner) { return outer >= std::min(apart + inner, Pi); };
    if (holds(alpha, beta)) return a;
    if (holds(beta, alpha)) return b;
    const Float halfArc = (alpha + apart + beta) / 2, middle = halfArc - alpha;
    const Vector3 across = Cross(a.w, b.w);
    const bool hasPlane = LengthSquared(across) > 0;  // not for opposite axes
    if (!hasPlane || halfArc >= Pi) return DirectionCone::EntireSphere();
    const Vector3 &x = a.w, y = Cross(Normalize(across), a.w);
    return {Normalize(x * std::cos(middle) + y * std::sin(middle)), std::cos(halfArc)};
}

}  // namespace pbrt
