#include "pbrt/cameras/camera.h"
#include "pbrt/math/frame.h"

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

void Camera::FindFootprint() {
    constexpr int kSteps = 512;  // along the film's diagonal
    bool isFirst = true;
    auto keepShorter = [&](Vector3 &shortest, const Vector3 &v) {
        if (isFirst || LengthSquared(v) < LengthSquared(shortest)) shortest = v;
    };
    for (int i = 0; i < kSteps; ++i) {
        const Float t = Float(i) / (kSteps - 1);
        CameraRay c;
        c.differential.valid = true;
        const CameraSample sample{t * Point2(frame_.resolution), {0.5f, 0.5f}, 0.5f, 1};
        if (!GenerateInCameraSpace(sample, &c) || !c.differential.valid) continue;
        keepShorter(smallest_.positionX, c.differential.rxOrigin - c.ray.o);
        keepShorter(smallest_.positionY, c.differential.ryOrigin - c.ray.o);
        const Frame frame = Frame::FromZ(c.ray.d);
        const Vector3 along = frame.ToLocal(c.ray.d);
        keepShorter(smallest_.directionX, Normalize(frame.ToLocal(c.differential.rxDirection)) - along);
        keepShorter(smallest_.directionY, Normalize(frame.ToLocal(c.differential.ryDirection)) - along);
        isFirst = false;
    }
}

void Camera::ApproximateFootprint(const Point3 &p, const Normal3 &n, Float time, int samplesPerPixel, Vector3 *dpdx,
                                  Vector3 *dpdy) const {
    const Transform t = frame_.renderFromCamera.At(time);
    const Point3 inCamera = t.InversePoint(p);
    const Float distance = Length(inCamera);
    *dpdx = *dpdy = Vector3(0);
    if (!(distance > 0)) return;
    RotationToZ rotation(inCamera / distance);
    const Normal3 nz = rotation(t.InverseNormal(n));
    const Float scale = std::max(Float(0.125), 1 / std::sqrt(Float(samplesPerPixel)));
    // To the neighbouring ray's hit with the tangent plane.
    auto step = [&](const Vector3 &origin, const Vector3 &bend) {
        const Vector3 d = Vector3(0, 0, 1) + bend;
        const Float along = (nz.z * distance - Dot(nz, origin)) / Dot(nz, d);
        const bool isHit = std::isfinite(along);
        return t.Vector((isHit ? rotation.Inverse(origin + along * d - Vector3(0, 0, distance)) : Vector3(0)) * scale);
    };
    *dpdx = step(smallest_.positionX, smallest_.directionX);
    *dpdy = step(smallest_.positionY, smallest_.directionY);
}

}  // namespace pbrt
