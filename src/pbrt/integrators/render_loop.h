#pragma once
#include <chrono>
#include <functional>
#include <optional>
#include <string>

#include "pbrt/films/film.h"
#include "pbrt/integrators/integrator.h"

namespace pbrt {

struct RenderSettings {
    int samplesPerPixel = 16;
    /// > 0: render waves until this many seconds have passed since `start`, whatever samplesPerPixel says.
    double timeBudget = 0;
    std::chrono::steady_clock::time_point start = std::chrono::steady_clock::now();
    bool disablePixelJitter = false;  ///< sample pixel centres, lens centre, mid-shutter; full texture footprints
    bool disableWavelengthJitter = false;
    std::string mseReferenceImage, mseReferenceOut;  ///< both are set or none
    /// Called after every wave if set, to write partial images.
    std::function<void(int samplesTaken)> afterWave;
};

struct RenderResult {
    int samplesTaken = 0;       ///< of every pixel; on cancel some pixels have more
    double seconds = 0;         ///< rendering only
    bool cancelled = false;     ///< before all samples were taken
    std::optional<double> mse;  ///< against the reference, of the last wave
    std::string mseFailure;     ///< why RenderSettings::mseReferenceOut is incomplete; empty if it is complete
};

/// Samples per pixel of the largest wave.
constexpr int kMaxWave = 64;

/// Lets an integrator render one pass after another; samples are taken in batches, each with samplers made for it.
/// Between passes the integrator's LightLearner learns, after the numbers of samples that it names. Any split into
/// calls gives the same image.
class WaveRenderer {
  public:
    /// `sampler`: for the first batch of RenderSettings::samplesPerPixel samples.
    WaveRenderer(Integrator &integrator, const Camera &camera, const Filter &filter, Film &film, const Sampler &sampler,
                 const RenderSettings &settings, Progress &progress);

    /// Renders up to `count` more samples per pixel, not beyond the end of the batch. Returns how many; 0 when
    /// cancelled.
    int Render(int count);
    /// Calls the learner if it is due before the next sample. Render does so, too; this is for callers who time the two
    /// separately.
    void LearnIfDue();
    int Done() const { return done_; }
    /// The film already holds the first `samples` samples (Film::Load): go on after them. Those that the integrator
    /// learns from are traced again.
    void ContinueFrom(int samples);

  private:
    Integrator &integrator_;
    LightLearner *const learner_;
    const Camera &camera_;
    const Filter &filter_;
    Film &film_;
    const Sampler &sampler_;
    const RenderSettings &settings_;
    Progress &progress_;
    std::vector<std::unique_ptr<Sampler>> samplers_;  ///< one per thread
    int round_ = -1, done_ = 0;
    bool isRepeating_ = false;  ///< the film already has the samples that are rendered
};

/// Renders waves of 1, 1, 2, 4, ... up to kMaxWave samples per pixel until samplesPerPixel or the time budget is
/// reached.
RenderResult RenderWaves(Integrator &integrator, const Camera &camera, const Filter &filter, Film &film,
                         const Sampler &sampler, const RenderSettings &settings, Progress &progress);

}  // namespace pbrt
