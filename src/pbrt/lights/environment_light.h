#pragma once
#include "pbrt/lights/light_beyond_scene.h"

namespace pbrt {

/// Directional radiance from outside the scene, from all sides or through one opening.
class EnvironmentLight : public LightBeyondScene {
  public:
    EnvironmentLight() : LightBeyondScene(LightKind::Infinite) {}
    const EnvironmentLight *AsEnvironment() const final { return this; }

    /// Mean of R, G and B of the radiance from direction d (unit), up to a constant factor.
    virtual Float MeanRadiance(const Vector3 &d) const = 0;
    /// Pixels per side of the image; 1 without image.
    virtual int Resolution() const = 0;
    /// Bounds of the opening through which the light enters, as an emitter; empty without opening. Stock light samplers
    /// treat lights with an opening like any other infinite light.
    virtual std::optional<LightBounds> Opening() const { return {}; }

    std::optional<LightLiSample> SampleLi(const LightSampleContext &from, const Point2 &u,
                                          const SampledWavelengths &lambda, bool allowIncompletePdfs,
                                          uint32_t) const final {
        std::optional<LightLiSample> s = SampleDirection(from.p, u, lambda, allowIncompletePdfs);
        if (s) s->pLight = Beyond(from.p, s->wi);
        return s;
    }
    Float PdfLi(const LightSampleContext &from, const Vector3 &wi, const Point3 &, const Normal3 &,
                bool allowIncompletePdfs, uint32_t) const final {
        return DirectionPdf(from.p, wi, allowIncompletePdfs);
    }
    std::optional<LightLeSample> SampleLe(const Point2 &uPosition, const Point2 &uDirection,
                                          const SampledWavelengths &lambda, uint32_t) const override {
        return EvenlyAgainst(SampleDirection(sceneCenter_, uDirection, lambda, false), uPosition);
    }
    LightLePdf PdfLe(const Point3 &, const Normal3 &, const Vector3 &w, uint32_t) const override {
        return {PdfOfDisk(), DirectionPdf(sceneCenter_, -w, false)};
    }

  protected:
    /// SampleLi from p without pLight; density by solid angle.
    virtual std::optional<LightLiSample> SampleDirection(const Point3 &p, const Point2 &u,
                                                         const SampledWavelengths &lambda,
                                                         bool allowIncompletePdfs) const = 0;
    virtual Float DirectionPdf(const Point3 &p, const Vector3 &wi, bool allowIncompletePdfs) const = 0;
};

}  // namespace pbrt
