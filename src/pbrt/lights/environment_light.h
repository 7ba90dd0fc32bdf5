#pragma once
#include "pbrt/lights/light.h"
#include "pbrt/math/distributions.h"
#include "pbrt/math/frame.h"
#include "pbrt/math/warps.h"
#include "pbrt/spectra/color_space.h"

namespace pbrt {

/// Light from outside the scene's bounding sphere, which Preprocess sets. Emission is sampled over the disk of the
/// sphere across the direction (area measure), and in direction by solid angle.
class LightBeyondScene : public Light {
  public:
    void Preprocess(const Point3 &sceneCenter, Float sceneRadius) final {
        sceneCenter_ = sceneCenter;
        sceneRadius_ = sceneRadius;
    }
    /// End of a shadow segment that leaves the scene from p along wi (unit).
    Point3 PointOutside(const Point3 &p, const Vector3 &wi) const { return p + wi * (2 * sceneRadius_); }

  protected:
    using Light::Light;

    /// Ray into the scene against wi (unit, towards the light), uniform over the disk of the bounding sphere.
    Ray RayAgainst(const Vector3 &wi, const Point2 &u) const {
        const Point2 disk = SampleUniformDiskConcentric(u) * sceneRadius_;
        return {.o = sceneCenter_ + wi * sceneRadius_ + Frame::FromZ(wi).FromLocal({disk.x, disk.y, 0}), .d = -wi};
    }
    Float PdfOfDisk() const { return 1 / (Pi * Sqr(sceneRadius_)); }
    /// Emission sample along RayAgainst, from a SampleLi sample.
    std::optional<LightLeSample> EvenlyAgainst(const std::optional<LightLiSample> &li, const Point2 &u) const {
        if (!li) return {};
        return LightLeSample{
            .L = li->L, .ray = RayAgainst(li->wi, u), .pdfPosition = PdfOfDisk(), .pdfDirection = li->pdf};
    }

    Point3 sceneCenter_{};
    Float sceneRadius_ = 0;
};

/// Density of an environment map's pixels, with their colours.
using EnvironmentTable = PiecewiseConstantGrid<ScaledPolynomial>;

/// Directional radiance from outside the scene, from all sides or through one opening.
class EnvironmentLight : public LightBeyondScene {
  public:
    EnvironmentLight() : LightBeyondScene(LightKind::Infinite) {}
    const EnvironmentLight *AsEnvironment() const final { return this; }

    /// Mean of R, G and B of the radiance from direction d (unit), up to a constant factor.
    virtual Float MeanRadiance(const Vector3 &d) const = 0;
    /// Pixels per side of the image; 1 without image.
    virtual int Resolution() const = 0;
    /// Table that SampleLi(u) samples with u where pdfs may be incomplete; null if it samples no table.
    virtual const EnvironmentTable *Table() const { return nullptr; }
    /// Bounds of the opening through which the light enters, as an emitter; empty without opening. Stock light samplers
    /// treat lights with an opening like any other infinite light.
    virtual std::optional<LightBounds> Opening() const { return {}; }

    std::optional<LightLiSample> SampleLi(const LightSampleContext &from, const Point2 &u,
                                          const SampledWavelengths &lambda, bool allowIncompletePdfs,
                                          uint32_t) const final {
        std::optional<LightLiSample> s = SampleDirection(from.p, u, lambda, allowIncompletePdfs);
        if (s) s->pLight = PointOutside(from.p, s->wi);
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
