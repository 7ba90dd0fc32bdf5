#pragma once
#include <array>
#include <memory>
#include <mutex>

#include "pbrt/lights/light_beyond_scene.h"
#include "pbrt/lights/sky_windows.h"

namespace pbrt {

/// What the infinite lights have in common that can be sampled tile by tile and through windows.
class SkyLight : public LightBeyondScene {
  public:
    SkyLight() : LightBeyondScene(LightKind::Infinite) {}
    bool HasTiles() const final { return true; }
    std::shared_ptr<const uint32_t> AddWindows(std::shared_ptr<const SkyWindows> windows) const final;

    std::optional<LightLiSample> SampleLi(const LightSampleContext &from, const Point2 &u,
                                          const SampledWavelengths &lambda, bool allowIncompletePdfs,
                                          uint32_t part) const final;
    Float PdfLi(const LightSampleContext &from, const Vector3 &wi, const Point3 &pHit, const Normal3 &nHit,
                bool allowIncompletePdfs, uint32_t part) const final;
    std::optional<LightLeSample> SampleLe(const Point2 &uPosition, const Point2 &uDirection,
                                          const SampledWavelengths &lambda, uint32_t part) const final {
        return EvenlyAgainst(SampleLi({}, uDirection, lambda, false, part), uPosition);
    }
    LightLePdf PdfLe(const Point3 &, const Normal3 &, const Vector3 &w, uint32_t part) const final {
        return {PdfOfDisk(), PdfLi({}, -w, Point3(0), Normal3(0), false, part)};
    }

  protected:
    /// SampleLi and PdfLi of the whole light and of tiles; the samples' pLight is not needed.
    virtual std::optional<LightLiSample> SampleSky(const Point2 &u, const SampledWavelengths &lambda,
                                                   bool allowIncompletePdfs, uint32_t part) const = 0;
    virtual Float PdfOfSky(const Vector3 &wi, bool allowIncompletePdfs, uint32_t part) const = 0;

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
