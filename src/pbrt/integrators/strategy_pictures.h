#pragma once
#include <array>
#include <memory>
#include <vector>

#include "pbrt/integrators/integrator.h"

namespace pbrt {

/// Pictures of the single strategies of bidirectional path tracing: one for every number s of vertices from the light
/// and t from the camera with which a path is made, up to kMaxDepth scattering events (s + t - 2). A light that a
/// camera path has hit, and a place in a medium that glows, are vertices from the camera (s = 0).
class StrategyPictures {
  public:
    static constexpr int kMaxDepth = 5;
    enum class Kind {
        Unweighted,  ///< each strategy alone: an estimate of the light of its number of scattering events that it can
                     ///< sample
        Weighted     ///< its MIS-weighted estimate: their sum is the picture
    };
    /// The contribution of a path that a strategy has sampled.
    struct Contribution {
        int s = 0, t = 0;
        SampledSpectrum unweighted, weighted;
        Point2 pFilm{};  ///< only of t = 1
        /// What this was divided by, as a mean over wavelengths (SpectralWeights).
        Float mean = 1;
    };

    StrategyPictures(std::vector<Kind> kinds, int maxDepth);

    /// Makes the pictures, before the first pass; they are of the same pixels and sensor as the film.
    void Begin(const Film &film);
    /// Adds the contributions of one pair of subpaths, for a sample of the film that has this weight. One thread at a
    /// time for each pixel; the order of samples of a pixel does not depend on the threads.
    void Add(std::span<const Contribution> contributions, Point2i pixel, Float weight, const SampledWavelengths &lambda,
             const Filter &filter);
    /// Light paths that Add was called for.
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
