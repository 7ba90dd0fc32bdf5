#pragma once
#include "pbrt/films/rgb_film.h"

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
        template <int N>
        struct Sums {
            PreciseSum of[N];
            void Add(double weight, const glm::vec<N, double> &v) {
                for (int i = 0; i < N; ++i) of[i].Add(weight * v[i]);
            }
            glm::vec<N, double> Value() const {
                glm::vec<N, double> v;
                for (int i = 0; i < N; ++i) v[i] = of[i].Value();
                return v;
            }
            void operator+=(const Sums &other) {
                for (int i = 0; i < N; ++i) of[i] += other.of[i];
            }
        };
        Sums<3> p, n, ns, albedo;
        Sums<2> uv, dz;
        PreciseSum weight;        ///< of samples with a surface hit
        PreciseSum rayWeight;     ///< of samples with a camera ray
        Sums<3> sensor, squares;  ///< of those samples, unweighted
        uint64_t count = 0;       ///< of those samples
        void operator+=(const Surface &other);
    };
    AnimatedTransform renderFromOutput_;  ///< output: camera or world space
    std::vector<Surface> surfaces_;
};

}  // namespace pbrt
