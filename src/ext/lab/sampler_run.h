#pragma once
#include "ext/lab/experiment_settings.h"
#include "ext/lab/run_record.h"
#include "pbrt/integrators/wave_renderer.h"

namespace ext::lab {

/// One sampler with one seed: integrator, film and a clock that runs only during preparation and rendering. Only one
/// run may be active at a time (the ray counters are per process).
class SamplerRun {
  public:
    /// Runs whose seeds differ by less than kSeeds share no film positions within the expected samples.
    /// `expectedSamples`: samples per pixel to be rendered, for samplers whose preparation depends on it. `maxDepth`:
    /// scattering events of a path; default the experiment's.
    SamplerRun(const LabScene &scene, const SamplerChoice &choice, int seed, int expectedSamples, Progress &cancel,
               std::optional<int> maxDepth = {});

    /// Prepares the light sampler; call once, before rendering. Returns false if cancelled.
    bool Prepare();
    /// Call before rendering. The run continues others of this many samples per pixel: RenderSettings::samplesBefore.
    void ContinueAfter(int samples) { settings_.samplesBefore = samples; }
    /// Call after Prepare. Resumes a run from its saved film; its clock continues from the recorded time.
    void Resume(const RunRecord &record, const std::string &filmFile);
    /// Renders in waves: at least one sample; then no wave starts that would end more than half a sample after the
    /// target time. Returns false if cancelled; the film is then unusable.
    bool RenderTo(const RenderTarget &target, const std::function<void()> &afterWave = {});
    void AddRound(int checkpoint, const Measures &measures);

    int Samples() const { return renderer_.Done(); }
    const TimeSpent &Spent() const { return now_.spent; }
    double SecondsPerSample() const { return secondsPerSample_; }
    const RunRecord &Record() const { return record_; }
    const Integrator &GetIntegrator() const { return *integrator_; }
    Image Picture() const { return film_->ToImage(); }
    ImageMetadata Metadata() const;
    void SaveFilm(const std::string &path) const;

    static constexpr int kSeeds = 10000;

  private:
    const LabScene &scene_;
    std::string label_;
    Progress &cancel_;
    std::unique_ptr<Integrator> integrator_;
    std::unique_ptr<Film> film_;
    std::unique_ptr<Sampler> sampler_;
    RenderSettings settings_;
    WaveRenderer renderer_;
    RunRecord record_;
    RoundRecord now_;  ///< times and rays so far
    double secondsPerSample_ = 0;
};

/// Loads the rounds of a run up to the last one that can be resumed. All records up to it must be complete and belong
/// to this experiment, and that round's film must exist (the finished image for the last of `checkpoints`). Removes
/// later files, with a warning if records are among them. `picture`: file of the finished image.
RunRecord LoadResumableRun(const RecordFolder &records, const LabScene &scene, const std::string &sampler, int seed,
                           size_t checkpoints, const std::string &picture);

bool IsFinite(const Image &picture);
/// True if the image is readable and has finite R, G and B at this resolution.
bool IsWholeImage(const std::string &file, Point2i resolution);

}  // namespace ext::lab
