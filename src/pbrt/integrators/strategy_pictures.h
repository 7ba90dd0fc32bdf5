#pragma once
#include <array>
#include <memory>
#include <vector>

#include "pbrt/integrators/integrator.h"

namespace pbrt {

/// Images of the strategies of bidirectional path tracing: one per number of vertices s from the light and t from the
/// camera, up to kMaxDepth scattering events (s + t - 2). A light or an emitting medium point hit by a camera path is a
/// camera vertex (s = 0).
class StrategyPictures {
  public:
    static constexpr int kMaxDepth = 5;
    enum class Kind {
        Unweighted,  ///< each strategy's own estimate of the light of its depth that it can sample
        Weighted     ///< its MIS-weighted estimate: they sum to the image
    };
    struct Contribution {
        int s = 0, t = 0;
        SampledSpectrum unweighted, weighted;
        Point2 pFilm{};  ///< for t = 1 only
        /// Divisor already applied: a mean over wavelengths (SpectralWeights).
        Float mean = 1;
    };

    StrategyPictures(std::vector<Kind> kinds, int maxDepth);

    /// Allocates the images before the first pass, with the film's pixels and sensor.
    void Begin(const Film &film);
    /// Adds the contributions of one pair of subpaths, for a film sample of this weight. One thread at a time per
    /// pixel; a pixel's sample order does not depend on the threads.
    void Add(std::span<const Contribution> contributions, Point2i pixel, Float weight, const SampledWavelengths &lambda,
             const Filter &filter);
    void AddSplatPaths(uint64_t paths);
    std::vector<SidePicture> Pictures() const;

  private:
    static constexpr size_t kTable = kMaxDepth + 3;
    struct Strategy {
        int s, t;
    };
    std::vector<Kind> kinds_;
    std::vector<Strategy> strategies_;
    std::array<std::array<size_t, kTable>, kTable> indexOf_{};  ///< by s and t
    std::vector<std::vector<std::unique_ptr<Film>>> films_;     ///< by kind and strategy
};

}  // namespace pbrt
