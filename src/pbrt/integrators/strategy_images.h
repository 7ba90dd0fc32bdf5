#pragma once
#include <fmt/format.h>
#include <array>
#include <memory>
#include <vector>

#include "pbrt/integrators/integrator.h"

namespace pbrt {

/// Images of the strategies of bidirectional path tracing: one per number of vertices s from the light and t from the
/// camera, up to kMaxDepth scattering events (s + t - 2). A light or an emitting medium point hit by a camera path is a
/// camera vertex (s = 0).
class StrategyImages {
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

    StrategyImages(std::vector<Kind> kinds, int maxDepth) : kinds_(std::move(kinds)) {
        for (int depth = 0; depth <= std::min(maxDepth, kMaxDepth); ++depth)
            for (int s = 0; s <= depth + 1; ++s) {
                if (s == 1 && depth == 0) continue;  // directly visible light is sampled by the camera only
                const int t = depth + 2 - s;
                indexOf_[s][t] = strategies_.size();
                strategies_.push_back({s, t});
            }
    }

    /// Allocates the images before the first pass, with the film's pixels and sensor.
    void Begin(const Film &film) {
        if (!films_.empty()) return;
        for (size_t kind = 0; kind < kinds_.size(); ++kind) {
            auto &films = films_.emplace_back();
            for (const Strategy &strategy : strategies_) {
                films.push_back(film.MakeRgbFilm());
                if (strategy.t == 1) films.back()->ExpectSplats();
            }
        }
    }
    /// Adds the contributions of one pair of subpaths, for a film sample of this weight. One thread at a time per
    /// pixel; a pixel's sample order does not depend on the threads.
    void Add(std::span<const Contribution> contributions, Point2i pixel, Float weight, const SampledWavelengths &lambda,
             const Filter &filter) {
        for (size_t kind = 0; kind < kinds_.size(); ++kind) {
            const auto light = [&](const Contribution &c) {
                return kinds_[kind] == Kind::Weighted ? c.weighted : c.unweighted;
            };
            std::array<SampledSpectrum, kTable * kTable> sums{};
            for (const Contribution &c : contributions) {
                const size_t i = indexOf_[c.s][c.t];
                if (c.t == 1) AddFilteredSplat(*films_[kind][i], filter, c.pFilm, light(c), lambda);
                else sums[i] += light(c);
            }
            for (size_t i = 0; i < strategies_.size(); ++i) {
                FilmSample sample;
                sample.pixel = pixel;
                sample.L = sums[i];
                sample.lambda = lambda;
                sample.weight = weight;
                films_[kind][i]->AddSample(sample);
            }
        }
    }
    void AddSplatPaths(uint64_t paths) {
        for (const auto &films : films_)
            for (size_t i = 0; i < strategies_.size(); ++i)
                if (strategies_[i].t == 1) films[i]->AddSplatPaths(paths);
    }
    std::vector<SideImage> Images() const {
        std::vector<SideImage> images;
        for (size_t kind = 0; kind < films_.size(); ++kind)
            for (size_t i = 0; i < strategies_.size(); ++i) {
                const auto [s, t] = strategies_[i];
                images.push_back(
                    {fmt::format("{}-depth{}-s{}-t{}", kinds_[kind] == Kind::Weighted ? "weighted" : "strategy",
                                 s + t - 2, s, t),
                     films_[kind][i].get()});
            }
        return images;
    }

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
