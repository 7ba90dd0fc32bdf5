#pragma once
#include "pbrt/integrators/render_loop.h"
#include "pbrt/lab/lab_scene.h"
#include "pbrt/lab/run_record.h"

namespace pbrt::lab {

/// Up to where a run goes on: a number of samples, or a time of its own clock (0: the samples).
struct RenderTarget {
    int samples = 0;
    double seconds = 0;
};

/// One sampler with one seed over the campaign's scene: integrator, film and a clock that only runs while it prepares
/// or renders. Only one run may work at a time (the ray counters are those of the process).
class SamplerRun {
  public:
    /// `expectedSamples`: that will be rendered, for samplers whose preparation depends on it.
    SamplerRun(const LabScene &scene, const SamplerChoice &choice, int seed, int expectedSamples, Progress &cancel);

    /// Once, before rendering. False: cancelled.
    bool Prepare();
    /// After Prepare: takes up a run whose film was saved. Its clock goes on where it was.
    void Resume(const RunRecord &record, const std::string &filmFile);
    /// Renders in waves. At least one sample; then no wave is begun that would end more than half a sample after the
    /// target time. False: cancelled, and the film is of no use.
    bool RenderTo(const RenderTarget &target, const std::function<void()> &afterWave = {});
    /// Puts the present state at the end of the record.
    void AddRound(int checkpoint, const Measures &measures);

    int Samples() const { return renderer_.Done(); }
    const TimeSpent &Spent() const { return spent_; }
    double SecondsPerSample() const { return secondsPerSample_; }
    const RunRecord &Record() const { return record_; }
    const LightSampler *Lights() const { return integrator_->Lights(); }
    const ShadowRayGate *Gate() const { return integrator_->Gate(); }
    Image Picture() const { return film_->ToImage(); }
    ImageMetadata Metadata() const;
    void SaveFilm(const std::string &path) const;

  private:
    const LabScene &scene_;
    SamplerChoice choice_;
    Progress &cancel_;
    std::unique_ptr<Integrator> integrator_;
    std::unique_ptr<Film> film_;
    std::unique_ptr<Sampler> sampler_;
    RenderSettings settings_;
    WaveRenderer renderer_;
    RunRecord record_;
    TimeSpent spent_;
    uint64_t shadowRays_ = 0, shadowRaysBlocked_ = 0;
    double secondsPerSample_ = 0;
};

}  // namespace pbrt::lab
