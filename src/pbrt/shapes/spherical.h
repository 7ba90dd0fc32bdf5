#pragma once
#include "pbrt/math/vec.h"

namespace pbrt {

// Uniform sampling of solid angles, seen from the origin. Densities are 1 / area. The rectangle computes in double,
// because its slices are differences of angles that are nearly equal when it is small.

/// Spherical triangle with unit corners a, b, c.
Float SphericalTriangleArea(const Vector3 &a, const Vector3 &b, const Vector3 &c);

/// Direction uniform in the triangle (the two-step map of Arvo 1995): u.x moves a point along the arc a-c so that it
/// cuts off the share u.x of the area, u.y moves from b towards that point. `area` is SphericalTriangleArea(a, b, c) >
/// 0.
Vector3 SampleSphericalTriangle(const Vector3 &a, const Vector3 &b, const Vector3 &c, Float area, const Point2 &u);
/// The u that SampleSphericalTriangle maps to w.
Point2 InvertSphericalTriangle(const Vector3 &a, const Vector3 &b, const Vector3 &c, Float area, const Vector3 &w);

/// Rectangle corner + s * edgeX + t * edgeY, 0 <= s, t <= 1, seen from `eye`; edges orthogonal.
class SphericalRectangle {
  public:
    SphericalRectangle(const Point3 &eye, const Point3 &corner, const Vector3 &edgeX, const Vector3 &edgeY);

    Float SolidAngle() const { return static_cast<Float>(area_); }
    /// Position (s, t) on the rectangle; uniform by solid angle for uniform u.
    Point2 Sample(const Point2 &u) const;
    /// The u that Sample maps to the direction of p (a point of the rectangle).
    Point2 Invert(const Point3 &p) const;

  private:
    double AreaLeftOf(double x) const;
    Point3 eye_;
    Vector3 axisX_, axisY_;
    double x0_, x1_, y0_, y1_, z_;  ///< in the rectangle's axes, eye at the origin
    double b0_, b1_;                ///< sines of the elevations of the sides y0 and y1
    double left_, area_;
};

}  // namespace pbrt
