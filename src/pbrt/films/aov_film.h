#pragma once
#include <string>
#include <vector>

#include "pbrt/films/film.h"
#include "pbrt/math/statistics.h"

namespace pbrt {

/// Auxiliary output, mostly of the first visible surface, available for any film.
struct Aov {
    const char *name;                    ///< in --aov
    std::vector<const char *> channels;  ///< as in the gbuffer film, where it has them
    const char *help;
};
/// All AOVs in channel order.
const std::vector<Aov> &Aovs();
std::vector<std::string> AovNames();

/// Film with additional channels: means over a pixel's samples of visible-surface data, in camera space, and the number
/// of samples. All else is the wrapped film's, bit for bit. Existing channels are not added.
class AovFilm final : public Film {
  public:
    /// `context.overrides.aovs` names the quantities. Throws UserError if the file format cannot hold them.
    AovFilm(std::unique_ptr<Film> film, const FilmContext &context);

    SampledWavelengths SampleWavelengths(Float u) const override { return film_->SampleWavelengths(u); }
    bool WantsVisibleSurface() const override { return true; }
    void AddSample(const FilmSample &sample) override;
    void ExpectSplats() override { film_->ExpectSplats(); }
    void AddSplat(Point2i pixel, const SampledSpectrum &L, const SampledWavelengths &lambda, Float weight) override {
        film_->AddSplat(pixel, L, lambda, weight);
    }
    void AddSplatPaths(uint64_t paths) override { film_->AddSplatPaths(paths); }
    Image ToImage() const override;
    Image Colors() const override { return film_->Colors(); }
    ImageMetadata Metadata() const override { return film_->Metadata(); }
    uint64_t RejectedSamples() const override { return film_->RejectedSamples(); }
    std::unique_ptr<Film> MakeRgbFilm() const override { return film_->MakeRgbFilm(); }

  private:
    std::vector<StateBlock> Blocks() const override;
    std::unique_ptr<Film> film_;
    AnimatedTransform renderFromCamera_;
    std::vector<size_t> chosen_;  ///< indices into Aovs(), ascending
    size_t stride_ = 0;           ///< per pixel: weights of samples with a ray, of those that hit a surface, channels
    std::vector<PreciseSum> sums_;
};

}  // namespace pbrt
