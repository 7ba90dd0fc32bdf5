#pragma once
#include "pbrt/lights/light.h"

namespace pbrt {

/// What all lights that shine from outside the scene have in common.
class LightBeyondScene : public Light {
  public:
    void Preprocess(const Point3 &, Float sceneRadius) final { sceneRadius_ = sceneRadius; }

  protected:
    using Light::Light;
    /// The end of a shadow segment that leaves the scene from p along wi (unit).
    Point3 Beyond(const Point3 &p, const Vector3 &wi) const { return p + wi * (2 * sceneRadius_); }

    Float sceneRadius_ = 0;
};

}  // namespace pbrt
