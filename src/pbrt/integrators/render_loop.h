#pragma once
#include <chrono>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "pbrt/films/film.h"
#include "pbrt/integrators/integrator.h"

namespace pbrt {

/// How far a render has come. Together with the sums of the film and what the light sampler has learned it decides all
/// that follows.
struct RenderPosition {
    int done = 0;  ///< all pixels have their samples before this one
    /// More than 0: a pass over so many further samples was cancelled; `passDone` lists which samples of it are in the
    /// film (RenderPass::done).
    int passCount = 0;
    std::vector<uint32_t> passDone{};
    std::string file{};  ///< that it was read from
};

struct RenderSettings {
    int samplesPerPixel = 16;  ///< in a batch of the pixel sampler
    int firstSample = 0;       ///< of every pixel; those before are not rendered
    int endSample = 0;         ///< the sample behind the last one; 0: samplesPerPixel
    /// > 0: render waves until this many seconds have passed since `start`, regardless of endSample.
    double timeBudget = 0;
    std::chrono::steady_clock::time_point start = std::chrono::steady_clock::now();
    bool disablePixelJitter = false;  ///< sample pixel centres, lens centre, mid-shutter; full texture footprints
    bool disableWavelengthJitter = false;
    std::string mseReferenceImage, mseReferenceOut;  ///< both are set or none
    /// Called after every wave if set, to write partial images.
    std::function<void(int samplesTaken)> afterWave;

    /// If set, the film and the integrator are as they were at this position; the render resumes there.
    std::optional<RenderPosition> from;
    double secondsPerSample = 0;  ///< of every pixel, as far as it is known; for the size of the first wave
    /// Called between waves, not more often than every `checkpointInterval` seconds, and at the end, also when
    /// cancelled.
    std::function<void(const RenderPosition &)> checkpoint;
    double checkpointInterval = 60;
    /// > 0: waves are as long as that, or one sample, where they would be longer. May be changed by afterWave.
    double maxWaveSeconds = 0;
    int EndSample() const { return endSample > 0 ? endSample : samplesPerPixel; }
};

struct RenderResult {
    int samplesTaken = 0;       ///< of every pixel that the film holds; on cancel some pixels have more
    double seconds = 0;         ///< rendering only
    bool cancelled = false;     ///< before all samples were taken
    std::optional<double> mse;  ///< against the reference, of the last wave
    std::string mseFailure;     ///< why RenderSettings::mseReferenceOut is incomplete; empty if it is complete
};

/// What a render uses beside its settings.
struct RenderContext {
    Integrator &integrator;
    const Camera &camera;
    const Filter &filter;
    Film &film;
    const Sampler &sampler;  ///< for the first batch of RenderSettings::samplesPerPixel samples
    Progress &progress;
    /// The processes that render together: rank 0 by RenderWaves, the others by FollowWaves.
    Team &team = Team::Alone();
};

/// Samples per pixel of the largest wave, for each process that takes part.
constexpr int kMaxWave = 64;

/// Lets an integrator render one pass after another; samples are taken in batches, each with samplers made for it.
/// Between passes the integrator's OnlineModel is updated, after the numbers of samples that it names. Any split into
/// calls gives the same image.
class WaveRenderer {
  public:
    /// Refers to the settings.
    WaveRenderer(const RenderContext &context, const RenderSettings &settings);

    /// Renders up to `count` more samples per pixel, not beyond the end of the batch. Returns how many; 0 when
    /// cancelled.
    int Render(int count);
    /// Updates the model if that is due before the next sample. Render does so, too; this is for callers who time the
    /// two separately.
    void UpdateIfDue();
    int Done() const { return position_.done; }
    const RenderPosition &Position() const { return position_; }
    /// The film and the integrator are as they were at this position.
    void GoOnFrom(RenderPosition position) { position_ = std::move(position); }
    /// The next sample to be rendered is this one, because the film already holds those before (Film::Load) or need not
    /// hold them. Those that the integrator learns from are traced again.
    void ContinueFrom(int samples);

    /// On rank 0: brings the sums of all films to its film, and the records of all models to its model; must come
    /// before either is read.
    void Gather();
    /// On rank 0, after the last call of the above.
    void EndTogether();
    /// On the others: executes the commands of rank 0 until it ends.
    void Follow();

  private:
    enum class Command { Pass, Update, Gather, End };
    void Send(Command command);
    bool RenderPassOf(int size);
    void UpdateTogether();
    void GatherHere();
    const RenderContext context_;
    OnlineModel *const model_;
    const RenderSettings &settings_;
    std::vector<std::unique_ptr<Sampler>> samplers_;  ///< one per thread
    int round_ = -1;
    RenderPosition position_;
    bool isBrokenOff_ = false;  ///< not all processes have updated their model; rank 0 has all records
    bool isRepeating_ = false;  ///< the film already has the samples that are rendered
};

/// The part of ranks above 0 while rank 0 is in RenderWaves.
void FollowWaves(const RenderContext &context, const RenderSettings &settings);

/// Renders waves of 1, 1, 2, 4, ... up to kMaxWave samples per pixel until the end or the time budget is reached. Waves
/// are smaller where checkpoints would otherwise come late.
RenderResult RenderWaves(const RenderContext &context, const RenderSettings &settings);

/// Samples per pixel to prepare for (PrepareContext::samplesPerPixel) where a time budget ends the render: as many as
/// take `seconds`, rounded to the nearest 2^(k/4), so that small differences of speed have no effect; at least 1.
int FittingSamples(double seconds, double secondsPerSample);

/// Seconds that a sample of every pixel takes with a prepared integrator that learns nothing. Renders waves of 1, 1, 2,
/// 4 ... samples to the film, without the progress of `context`, for a fiftieth of `seconds`, and takes the fastest;
/// stops at a twentieth, and extrapolates from the pixels that are done if no wave is.
double MeasureSecondsPerSample(const RenderContext &context, RenderSettings settings, double seconds);

}  // namespace pbrt
