#include "pbrt/cameras/footprint.h"

namespace pbrt {

namespace {

class RotationToZ {
  public:
    explicit RotationToZ(const Vector3 &from) : flip_(from.z < -0.99f) {
        Vector3 f = Flip(from);
        axis_ = {f.y, -f.x, 0};  // f x z: sine of the angle times the axis
        cosine_ = f.z;
    }
    Vector3 operator()(const Vector3 &v) const { return Turn(Flip(v), axis_); }
    Vector3 Inverse(const Vector3 &v) const { return Flip(Turn(v, -axis_)); }

  private:
    /// Half turn about x, to avoid -z, where the smallest rotation is not unique.
    Vector3 Flip(const Vector3 &v) const { return flip_ ? Vector3(v.x, -v.y, -v.z) : v; }
    Vector3 Turn(const Vector3 &v, const Vector3 &axis) const {
        Vector3 c = Cross(axis, v);
        return v + c + Cross(axis, c) / (1 + cosine_);
    }
    bool flip_;
    Vector3 axis_;
    Float cosine_;
};

}  // namespace

void FootprintOnTangentPlane(const SmallestDifferentials &smallest, const Point3 &p, const Normal3 &n, Vector3 *dpdx,
                             Vector3 *dpdy) {
    *dpdx = *dpdy = Vector3(0);
    Float distance = Length(p);
    if (!(distance > 0)) return;
    RotationToZ rotation(p / distance);
    Normal3 nz = rotation(n);
    auto step = [&](const Vector3 &origin, const Vector3 &bend) {
        Vector3 d = Vector3(0, 0, 1) + bend;
        Float t = (nz.z * distance - Dot(nz, origin)) / Dot(nz, d);
        if (!std::isfinite(t)) return Vector3(0);
        return rotation.Inverse(origin + t * d - Vector3(0, 0, distance));
    };
    *dpdx = step(smallest.positionX, smallest.directionX);
    *dpdy = step(smallest.positionY, smallest.directionY);
}

}  // namespace pbrt
