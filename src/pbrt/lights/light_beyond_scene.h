#pragma once
#include "pbrt/lights/light.h"
#include "pbrt/math/frame.h"
#include "pbrt/math/warps.h"

namespace pbrt {

class LightBeyondScene : public Light {
  public:
    void Preprocess(const Point3 &sceneCenter, Float sceneRadius) final {
        sceneCenter_ = sceneCenter;
        sceneRadius_ = sceneRadius;
    }
    /// End of a shadow segment that leaves the scene from p along wi (unit).
    Point3 Beyond(const Point3 &p, const Vector3 &wi) const { return p + wi * (2 * sceneRadius_); }

  protected:
    using Light::Light;

    /// Ray into the scene against wi (unit, towards the light), uniform over the disk of the bounding sphere.
    Ray RayAgainst(const Vector3 &wi, const Point2 &u) const {
        const Point2 disk = SampleUniformDiskConcentric(u) * sceneRadius_;
        Ray ray;
        ray.o = sceneCenter_ + wi * sceneRadius_ + Frame::FromZ(wi).FromLocal({disk.x, disk.y, 0});
        ray.d = -wi;
        return ray;
    }
    Float PdfOfDisk() const { return 1 / (Pi * Sqr(sceneRadius_)); }
    /// Emission sample along RayAgainst, from a SampleLi sample.
    std::optional<LightLeSample> EvenlyAgainst(const std::optional<LightLiSample> &li, const Point2 &u) const {
        if (!li) return {};
        LightLeSample s;
        s.L = li->L;
        s.ray = RayAgainst(li->wi, u);
        s.pdfPosition = PdfOfDisk();
        s.pdfDirection = li->pdf;
        return s;
    }

    Point3 sceneCenter_{};
    Float sceneRadius_ = 0;
};

}  // namespace pbrt
