#pragma once
#include "ext/lab/lab_scene.h"
#include "ext/lab/run_record.h"
#include "pbrt/integrators/render_loop.h"

namespace ext::lab {

/// One sampler with one seed over the experiment's scene: integrator, film and a clock that only runs while it prepares
/// or renders. Only one run may work at a time (the ray counters are those of the process).
class SamplerRun {
  public:
    /// `expectedSamples`: samples per pixel that will be rendered, for light samplers whose preparation depends on it.
    /// `maxDepth`: scattering events of a path; the experiment's if left out.
    SamplerRun(const LabScene &scene, const SamplerChoice &choice, int seed, int expectedSamples, Progress &cancel,
               std::optional<int> maxDepth = {});

    /// Prepares the light sampler; to be called once, before rendering. Returns false if cancelled.
    bool Prepare();
    /// To be called after Prepare. Continues a run whose film was saved; its clock continues from the recorded time.
    void Resume(const RunRecord &record, const std::string &filmFile);
    /// Renders in waves. At least one sample; then no wave is begun that would end more than half a sample after the
    /// target time. Returns false if cancelled; the film is then unusable.
    bool RenderTo(const RenderTarget &target, const std::function<void()> &afterWave = {});
    /// Appends the present state to the record.
    void AddRound(int checkpoint, const Measures &measures);

    int Samples() const { return renderer_.Done(); }
    const TimeSpent &Spent() const { return spent_; }
    double SecondsPerSample() const { return secondsPerSample_; }
    const RunRecord &Record() const { return record_; }
    const Integrator &GetIntegrator() const { return *integrator_; }
    const LightSampler *Lights() const { return integrator_->Lights(); }
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

/// Loads the rounds of one run from disk, up to the last one from which the run can resume: every record up to it is
/// complete and belongs to this experiment, and so does the film of that round, or the finished picture if it is the
/// last of `checkpoints`. Removes later files, with a warning if a record is among them. `picture`: file of the
/// finished picture.
RunRecord TakeUpRun(const RecordFolder &records, const LabScene &scene, const std::string &sampler, int seed,
                    size_t checkpoints, const std::string &picture);

/// Returns true if all pixels of R, G and B are finite.
bool IsFinite(const Image &picture);

/// Returns true if the picture is readable and has finite R, G and B at this resolution.
bool IsWholePicture(const std::string &file, Point2i resolution);

}  // namespace ext::lab
