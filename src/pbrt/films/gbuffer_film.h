#pragma once
#include "pbrt/films/film.h"
#include "pbrt/films/sensor_sums.h"
#include "pbrt/math/statistics.h"

namespace pbrt {

struct GBufferParams : FilmParams {
    enum class Space { Camera, World };
    static constexpr NamedValue<Space> kSpaces[] = {{"camera", Space::Camera}, {"world", Space::World}};
    Space space = Space::Camera;
    template <class V>
    void Describe(V &&v) {
        FilmParams::Describe(v);
        v("coordinatesystem", space, kSpaces, "space of positions and normals");
    }
};

/// The `gbuffer` film: besides RGB, what the camera sees in every pixel (means over its samples) and the variance of
/// the samples that see something. Splats change RGB only.
class GBufferFilm final : public Film {
  public:
    GBufferFilm(const GBufferParams &params, const ParamSet &set, const FilmRequest &request);

    bool WantsVisibleSurface() const override { return true; }
    void AddSample(const FilmSample &sample) override;
    void ExpectSplats() override { sums_.ExpectSplats(); }
    void AddSplat(Point2i pixel, const SampledSpectrum &L, const SampledWavelengths &lambda, Float weight) override;
    void AddSplatSamples(uint64_t perPixel) override { sums_.AddSplatSamples(perPixel); }

    /// The channels of pbrt-v4-format §14.
    Image ToImage() const override;
    uint64_t RejectedSamples() const override { return sums_.Rejected(); }
    std::unique_ptr<Film> MakeRgbFilm() const override;

  private:
    std::vector<StateBlock> Blocks() override;
    struct Pixel {
        glm::dvec3 p{0}, n{0}, ns{0}, albedo{0};
        glm::dvec2 uv{0}, dz{0};
        double weight = 0;  ///< of samples that see a surface
        RunningMoments moments[3];
        void operator+=(const Pixel &other);
    };
    AnimatedTransform renderFromOutput_;  ///< output: camera or world space
    SensorSums sums_;
    std::vector<Pixel> pixels_;
};

}  // namespace pbrt
