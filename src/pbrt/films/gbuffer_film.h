#pragma once
#include <array>

#include "pbrt/films/rgb_film.h"

namespace pbrt {

struct GBufferParams : FilmParams {
    enum class Space { Camera, World };
    static constexpr NamedValue<Space> kSpaces[] = {{"camera", Space::Camera}, {"world", Space::World}};
    Space space = Space::Camera;
    void Describe(auto &&v) {
        FilmParams::Describe(v);
        v("coordinatesystem", space, kSpaces, "space of positions and normals");
    }
};

/// The `gbuffer` film: RGB, mean visible-surface data per pixel, and the variance of samples with a hit. Splats change
/// RGB only.
class GBufferFilm final : public RgbFilm {
  public:
    GBufferFilm(const GBufferParams &params, const ParamSet &set, const FilmRequest &request);

    bool WantsVisibleSurface() const override { return true; }
    void AddSample(const FilmSample &sample) override;
    /// The channels of pbrt-v4-format §14.
    Image ToImage() const override;

  private:
    std::vector<StateBlock> Blocks() const override;
    struct Surface {
        /// Indices in `sums`. kSensor and kSquares: of samples with a surface hit, unweighted.
        static constexpr size_t kP = 0, kN = 3, kNs = 6, kAlbedo = 9, kUv = 12, kDz = 14, kSensor = 18, kSquares = 21,
                                kEnd = 24;
        static constexpr size_t kWeight = 16;     ///< of samples with a surface hit
        static constexpr size_t kRayWeight = 17;  ///< of samples with a camera ray
        std::array<PreciseSum, kEnd> sums;
        uint64_t count = 0;  ///< samples with a surface hit

        /// Adds a vector.
        void Add(size_t first, double weight, const auto &v) {
            for (int c = 0; c < v.length(); ++c) sums[first + c].Add(weight * double(v[c]));
        }
        void operator+=(const Surface &other) {
            for (size_t i = 0; i < kEnd; ++i) sums[i] += other.sums[i];
            count += other.count;
        }
    };
    AnimatedTransform renderFromOutput_;  ///< output: camera or world space
    std::vector<Surface> surfaces_;
};

}  // namespace pbrt
