#pragma once
#include <array>
#include <memory>
#include <mutex>

#include "pbrt/lights/light_beyond_scene.h"
#include "pbrt/lights/sky_windows.h"

namespace pbrt {

/// What the infinite lights have in common that can be sampled through windows. Part 0 is the whole light, the others
/// are those of SkyPart.
class SkyLight : public LightBeyondScene {
  public:
    SkyLight() : LightBeyondScene(LightKind::Infinite) {}
    const SkyLight *AsSky() const final { return this; }

    /// Lets parts stand for what is seen through windows, as long as the returned number of the set lives, which may
    /// outlive the light. Null if there are too many sets. Any thread may call it and let go of the number at any time.
    std::shared_ptr<const uint32_t> AddWindows(std::shared_ptr<const SkyWindows> windows) const;
    /// The mean of R, G and B of the radiance from direction d (unit), which samples through windows follow; all that
    /// matters is how it differs between directions.
    virtual Float MeanRadiance(const Vector3 &d) const = 0;
    /// The number of pixels along a side of the image; 1 if there is none.
    virtual int Resolution() const = 0;

    std::optional<LightLiSample> SampleLi(const LightSampleContext &from, const Point2 &u,
                                          const SampledWavelengths &lambda, bool allowIncompletePdfs,
                                          uint32_t part) const final;
    Float PdfLi(const LightSampleContext &from, const Vector3 &wi, const Point3 &pHit, const Normal3 &nHit,
                bool allowIncompletePdfs, uint32_t part) const final;
    /// Of the whole light only.
    std::optional<LightLeSample> SampleLe(const Point2 &uPosition, const Point2 &uDirection,
                                          const SampledWavelengths &lambda, uint32_t) const final {
        return EvenlyAgainst(SampleWhole(uDirection, lambda, false), uPosition);
    }
    LightLePdf PdfLe(const Point3 &, const Normal3 &, const Vector3 &w, uint32_t) const final {
        return {PdfOfDisk(), PdfOfWhole(-w, false)};
    }

  protected:
    /// SampleLi and PdfLi of the whole light; the samples' pLight is not needed.
    virtual std::optional<LightLiSample> SampleWhole(const Point2 &u, const SampledWavelengths &lambda,
                                                     bool allowIncompletePdfs) const = 0;
    virtual Float PdfOfWhole(const Vector3 &wi, bool allowIncompletePdfs) const = 0;

  private:
    /// An entry is written only while no part of its set is asked for.
    struct Sets {
        std::array<std::shared_ptr<const SkyWindows>, SkyPart::kSets> windows;  ///< null: not used
        std::mutex mutex;
    };
    const SkyWindows &WindowsOf(uint32_t part) const { return *sets_->windows[SkyPart::SetOf(part)]; }

    std::shared_ptr<Sets> sets_ = std::make_shared<Sets>();
};

}  // namespace pbrt
