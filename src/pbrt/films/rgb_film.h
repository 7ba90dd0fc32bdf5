#pragma once
#include "pbrt/films/film.h"
#include "pbrt/films/sensor_sums.h"

namespace pbrt {

/// The `rgb` film: sensor values only.
class RgbFilm final : public Film {
  public:
    RgbFilm(const FilmParams &params, const ParamSet &set, const FilmRequest &request);
    /// Empty film in float precision with the sensor of `like`.
    RgbFilm(const FilmFrame &frame, const SensorSums &like);

    void AddSample(const FilmSample &sample) override;
    void ExpectSplats() override { sums_.ExpectSplats(); }
    void AddSplat(Point2i pixel, const SampledSpectrum &L, const SampledWavelengths &lambda, Float weight) override;
    void AddSplatPaths(uint64_t paths) override { sums_.AddSplatPaths(paths); }
    Image ToImage() const override { return sums_.MakeImage({}); }
    Image Colors() const override { return sums_.Colors(); }
    uint64_t RejectedSamples() const override { return sums_.Rejected(); }
    std::unique_ptr<Film> MakeRgbFilm() const override { return std::make_unique<RgbFilm>(Frame(), sums_); }

  private:
    std::vector<StateBlock> Blocks() const override;
    SensorSums sums_;
};

}  // namespace pbrt
