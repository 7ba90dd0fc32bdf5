#pragma once
#include <chrono>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "pbrt/films/film.h"
#include "pbrt/integrators/adaptive_sampling.h"
#include "pbrt/integrators/integrator.h"

namespace pbrt {

/// Position in a render. With the film's sums and the light sampler's model it determines everything that follows.
struct RenderPosition {
    int done = 0;  ///< samples completed for all pixels; on average in adaptive renders
    /// Positive: a pass of this many further samples was cancelled; `passDone` lists its samples in the film
    /// (RenderPass::done).
    int passCount = 0;
    std::vector<uint32_t> passDone{};
    std::string file{};  ///< source file
    SamplePlan plan{};   ///< of adaptive renders
};

struct RenderResult {
    int samplesTaken = 0;       ///< per pixel in the film; on cancel some pixels have more
    double seconds = 0;         ///< rendering only, with RenderSettings::secondsBefore
    bool cancelled = false;     ///< before all samples were taken
    std::optional<double> mse;  ///< against the reference, after the last wave
    std::string mseFailure;     ///< why RenderSettings::mseReferenceOut is incomplete; empty if complete
    std::optional<AdaptiveResult> adaptive;
};

struct RenderSettings {
    int samplesPerPixel = 16;  ///< per batch of the pixel sampler
    int firstSample = 0;       ///< per pixel; earlier ones are not rendered
    int endSample = 0;         ///< exclusive; 0: samplesPerPixel
    int samplesBefore = 0;     ///< per pixel, of other renders that this one continues; moves the radius of "sppm"
    /// Positive: render waves until this many seconds have passed since `start`, ignoring endSample.
    double timeBudget = 0;
    double noise = 0;  ///< positive: an adaptive render ends at the first decision that estimates at most this
    std::chrono::steady_clock::time_point start = std::chrono::steady_clock::now();
    bool disablePixelJitter = false;  ///< sample pixel centres, lens centre, mid-shutter; full texture footprints
    bool disableWavelengthJitter = false;
    std::string mseReferenceImage, mseReferenceOut;  ///< both set or both empty
    /// Called after every wave if set, to write partial images.
    std::function<void(const RenderResult &)> afterWave;

    /// If set, film and integrator are in this state, and the render resumes there.
    std::optional<RenderPosition> from;
    double secondsBefore = 0;     ///< of rendering up to there
    double secondsPerSample = 0;  ///< for one sample of every pixel, if known; sets the size of the first wave
    /// Called between waves, at most every `checkpointInterval` seconds, and at the end, including cancellation.
    std::function<void(const RenderPosition &, const RenderResult &)> checkpoint;
    double checkpointInterval = 60;
    /// Positive: maximum wave length, but at least one sample. afterWave may change it.
    double maxWaveSeconds = 0;
    bool HasKnownEnd() const { return timeBudget <= 0 && noise <= 0; }
    int EndSample() const { return endSample > 0 ? endSample : samplesPerPixel; }
    int SampleCount() const { return EndSample() - firstSample; }
};

struct RenderContext {
    Integrator &integrator;
    const Camera &camera;
    const Filter &filter;
    Film &film;
    const Sampler &sampler;  ///< for the first batch of RenderSettings::samplesPerPixel samples
    Progress &progress;
    /// Processes that render together: rank 0 by RenderWaves, the others by FollowWaves.
    Team &team = Team::Alone();
    Film *half = nullptr;  ///< AdaptivePass::half; null: the render is not adaptive
};

/// Maximum samples per pixel of a wave, per process.
constexpr int kMaxWave = 64;

/// Counterpart of RenderWaves on ranks above 0.
void FollowWaves(const RenderContext &context, const RenderSettings &settings);

/// Renders waves of 1, 1, 2, 4, ... up to kMaxWave samples per pixel until the end or the time budget. Waves shrink if
/// checkpoints would be late.
RenderResult RenderWaves(const RenderContext &context, const RenderSettings &settings);

/// Samples per pixel to prepare for (PrepareContext::samplesPerPixel) with a time budget: those that fit into
/// `seconds`, rounded to the nearest 2^(k/4), so that small speed differences have no effect; at least 1.
int FittingSamples(double seconds, double secondsPerSample);

/// Measures the seconds per sample of every pixel, with a prepared integrator that does not learn. Renders waves of 1,
/// 1, 2, 4 ... samples to the film, without the progress of `context`, for a fiftieth of `seconds`, and uses the
/// fastest. Stops at a twentieth, and extrapolates from the completed pixels if no wave is complete.
double MeasureSecondsPerSample(const RenderContext &context, RenderSettings settings, double seconds);

}  // namespace pbrt
